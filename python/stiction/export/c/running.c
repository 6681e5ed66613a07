
/* What happens within a step that was attempted. */
enum { NOTHING, STOPS, BREAKS };

static int happens(const stiction_machine *a, const stiction_machine *end)
{
#ifdef RIGID
    const int slid = a->mode != 0 || (real)end->mode * a->velocity > R(0);
    return slid && (real)end->mode * end->velocity <= R(0) ? STOPS : NOTHING;
#else
#ifdef HAS_BREAKS
    if (law_breaks(&a->contact.law, &end->contact.law)) {
#ifdef DRAGGED_ALONG
        const int mode = a->contact.law.mode;
        return mode != 0 && (real)mode * end->velocity <= R(0) ? STOPS : BREAKS;
#else
        return BREAKS;
#endif
    }
#ifdef DRAGGED_ALONG
    if (a->contact.law.mode != 0
        && (real)a->contact.law.mode * end->velocity <= R(0)) {
        return STOPS;
    }
#endif
#else
    (void)a;
    (void)end;
#endif
    return NOTHING;
#endif
}

/* A step with every event within it; where friction falls with speed, what is left of it goes in
 * pieces of this length. */
static void step_through(stiction_machine *a, const acting *by, real span, real piece)
{
    real left = span;
    int events;
    (void)piece;
    for (events = 0;; ++events) {
        stiction_machine end, before = *a, beyond;
        real low = R(0), high = left;
        int what, k;
#ifdef FALLS_IN_SLIDES
        if (a->contact.law.mode != 0 && left > piece) {
            high = left / r_ceil(left / piece * (R(1) - R(8) * EPSILON));
        }
#endif
#ifdef RIGID
        if ((real)a->mode * a->velocity < R(0)) {
            a->mode = 0;
        }
        if (a->velocity == R(0) && a->mode == 0 && hold(a, by, left)) {
            return;
        }
        before = *a;
#endif
        end = attempt(a, by, high);
        what = events < 16 ? happens(a, &end) : NOTHING;
        if (what == NOTHING) {
            *a = end;
            left -= high;
            if (left <= EPSILON * span) {
                return;
            }
            --events;
            continue;
        }
        beyond = end;
        for (k = 0; k < 60 && high - low > R(1e-14) * span; ++k) {
            const real middle = R(0.5) * (low + high);
            const stiction_machine there = attempt(a, by, middle);
            const int then = happens(a, &there);
            if (then == NOTHING) {
                low = middle;
                before = there;
            } else {
                high = middle;
                beyond = there;
                what = then;
            }
        }
        *a = before;
        left -= high;
        if (what == STOPS) {
            if (low > R(0)) {
                a->velocity = R(0);
            }
            a->mode = 0;
#ifdef DRAGGED_ALONG
            {
                motion still = {0};
                motion *const m = &still;
                reach(&a->contact, m, R(0), by);
                law_step(&a->contact, m);
            }
#endif
        }
#ifdef HAS_BREAKS
        if (what == BREAKS) {
            a->contact.law = beyond.contact.law;
        }
#else
        (void)beyond;
#endif
        if (left < EPSILON * span) {
            left = R(0);
        }
    }
}

/* Into how many steps a sample is divided, of what does not change; 0 where it is too long. */
static long parts_of(real dt)
{
    const real phase = dt * FASTEST / R(0.065), calming = dt * CALMING / R(0.25);
#ifdef FALLS_IN_SLIDES
    const real some = R(0);
#else
    const real falling = dt * FALLING / R(0.25), some = falling < R(16) ? falling : R(16);
#endif
    real parts = phase > calming ? phase : calming;
    parts = r_ceil(parts > some ? parts : some);
    return parts > R(1e4) ? 0 : parts < R(1) ? 1 : (long)parts;
}
#ifdef FALLS_IN_SLIDES

/* In how many pieces a step goes while friction falls with speed. */
static long pieces_of(real dt, long parts)
{
    const real falling = dt * FALLING / R(0.25);
    const real pieces = r_ceil((falling < R(16) ? falling : R(16)) / (real)parts);
    return pieces < R(1) ? 1 : (long)pieces;
}
#endif
#ifdef STRAINS

/* How many times as many they are to be because of what effects make of the contact here. */
static long finer(const stiction_machine *a, const acting *by, real h)
{
    const stiction_state *const s = &a->contact;
    real level = R(1), viscous_level = R(1), calming = R(0), parts, raised;
    motion it = {0};
    motion *const m = &it;
    it.velocity = a->velocity;
    reach(s, m, driven(a, s, by->input, a->velocity) + by->load + a->ambient, by);
#ifdef LEVELS
    level = m->level;
    viscous_level = m->viscous_level;
#endif
    raised = level > viscous_level ? level : viscous_level;
    if (raised > R(4)) {
        calming = CALMS * raised;
    }
#if QUADRATIC_DRAG > 0
    {
        const real speed = r_fabs(a->velocity);
        const real effort = driven(a, s, by->input, a->velocity) + by->load + a->ambient;
        const real gained = r_fabs(effort) * h / INERTIA;
        real most = effort * a->velocity < R(0) ? gained - speed : gained + speed;
        const real borne = QUADRATIC_DRAG * r_fabs(most) * most;
        if (borne > r_fabs(effort)) {
            most *= r_sqrt(r_fabs(effort) / borne);
        }
        calming += R(2) * QUADRATIC_DRAG * (most > speed ? most : speed);
    }
#endif
    calming *= h / INERTIA;
    parts = r_sqrt(level / R(4));
    parts = r_ceil(parts > calming ? parts : calming);
    return parts < R(1) ? 1 : (long)parts;
}
#endif

static void machine_begin(stiction_machine *a, real position, real velocity)
{
    const int enabled = a->enabled;
    *a = (stiction_machine){0};
    a->enabled = enabled;
    stiction_init(&a->contact);
    a->contact.position.value = position;
    a->velocity = velocity;
    a->ambient = ambient(&a->contact, velocity);
}

/* Takes a sample into the memory of effects, from where the contact was before. */
static void remember(stiction_machine *a, const stiction_state *before, real dt)
{
    stiction_state *const s = &a->contact;
#ifdef REMEMBERS
    const real friction = s->friction;
    motion it = {0};
    const motion *const m = &it;
    it.displacement = s->position.value - before->position.value;
    it.dt = dt;
    it.velocity = it.displacement / dt;
    s->friction = before->friction;
#each remember
    EFFECT_remember(s, m);
#end
    s->friction = friction;
#else
    (void)before;
    (void)dt;
#endif
    s->moved = R(0);
}

/* A sample under what has arrived at the drive; 0 where it is too long for the machine. */
static int machine_step(stiction_machine *a, const acting *by, real dt)
{
    const stiction_state before = a->contact;
    long parts = parts_of(dt), pieces = 1, k;
    if (parts == 0) {
        return 0;
    }
#ifdef FALLS_IN_SLIDES
    pieces = pieces_of(dt, parts);
#endif
#ifdef STRAINS
    parts *= finer(a, by, dt / (real)parts);
    if (parts > 10000) {
        return 0;
    }
#endif
    for (k = 0; k < parts; ++k) {
        const real piece = dt / ((real)parts * (real)pieces);
#ifdef FALLS_IN_SLIDES
        if (pieces > 1 && a->contact.law.mode != 0) {
            long j;
            for (j = 0; j < pieces; ++j) {
                step_through(a, by, piece, piece);
            }
            continue;
        }
#endif
        step_through(a, by, dt / (real)parts, piece);
    }
#if SERVO
#if SERVO_INTEGRAL != 0
    if (a->enabled && r_fabs(voltage(a, &a->contact, by->input, a->velocity))
        < SERVO_DUTY_LIMIT * SERVO_SUPPLY) {
        a->wound += (by->input - a->contact.position.value) * dt;
    }
#endif
#endif
    remember(a, &before, dt);
    return 1;
}

/* Leads the contact to a position that was measured a sample later. */
static void machine_follow(stiction_machine *a, const acting *by, real position, real dt)
{
    stiction_state *const s = &a->contact;
    const stiction_state before = *s;
    const real displacement = position - s->position.value, velocity = displacement / dt;
    motion it = {0};
    motion *const m = &it;
    it.velocity = it.start = velocity;
    it.dt = dt;
    it.displacement = displacement;
    s->position.value = position;
    s->time.value += dt;
    s->path.value += r_fabs(displacement);
    s->moved += displacement;
    a->ambient = ambient(s, velocity);
    reach(s, m, driven(a, s, by->input, velocity) + by->load + a->ambient, by);
#each creep
    it.displacement -= EFFECT_creep(s, m);
#end
    s->friction = dry(s, it, velocity < R(0) ? -1 : 1) + viscous(m) * velocity;
    remember(a, &before, dt);
    a->velocity = velocity;
    a->mode = 0;
}
