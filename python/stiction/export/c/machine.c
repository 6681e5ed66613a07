
/* The machine about the contact. Velocity Verlet with trapezoidal damping, a sample divided as the
 * library divides it; where the contact sticks, breaks away or turns round, a step ends there:
 *
 *     x1 = x0 + h*v0 + h*h/2*a0,  v1 = v0 + h/2*(a0 + a1)
 */
typedef struct {
    stiction_state contact;
    real velocity;
    real ambient; /* gravity and added efforts where it is */
    real wound; /* what a servo's distance from its goal has summed up to */
    int mode; /* of a rigid contact: 0 sticks, +1 and -1 slide in that direction */
    int enabled;
} stiction_machine;

/* What acts on the machine during a sample. */
typedef struct {
    real input, load, temperature;
} acting;

static real gravity(real position)
{
#if GRAVITY != 0
    return -WEIGHT_FORCE - GRAVITY * r_sin(position - GRAVITY_ZERO);
#else
    (void)position;
    return -WEIGHT_FORCE;
#endif
}

#if SERVO or INPUT_LIMIT < inf
static real limited(real value, real most)
{
    return value > most ? most : value < -most ? -most : value;
}
#endif
#if SERVO

static real voltage(const stiction_machine *a, const stiction_state *s, real goal, real velocity)
{
    const real duty = SERVO_PROPORTIONAL * (goal - s->position.value) + SERVO_INTEGRAL * a->wound
        - SERVO_DERIVATIVE * velocity;
    return SERVO_SUPPLY * limited(duty, SERVO_DUTY_LIMIT);
}
#endif

/* Effort of the drive. */
static real driven(const stiction_machine *a, const stiction_state *s, real input, real velocity)
{
#if SERVO
    real command = voltage(a, s, input, velocity);
#else
    real command = input;
#endif
    if (!a->enabled) {
        return R(0);
    }
#each input
    command = EFFECT_input(s, command, velocity);
#end
#if SERVO
    return GAIN * limited((command - GAIN * velocity) / SERVO_RESISTANCE, SERVO_CURRENT_LIMIT);
#else
    (void)s;
    (void)velocity;
#if INPUT_LIMIT < inf
    return GAIN * limited(command, INPUT_LIMIT);
#else
    return GAIN * command;
#endif
#endif
}

/* Gravity and added efforts. */
static real ambient(const stiction_state *s, real velocity)
{
    real effort = gravity(s->position.value);
#ifdef EFFORTS
    motion it = {0};
    const motion *const m = &it;
    it.velocity = velocity;
#each effort
    effort += EFFECT_effort(s, m);
#end
#else
    (void)velocity;
#endif
    return effort;
}

/* What reaches the contact where it is, under all effort but friction. */
static void reach(const stiction_state *s, motion *m, real effort, const acting *by)
{
    m->effort = effort;
    m->load = by->load + gravity(s->position.value);
#ifdef TEMPERATURE
    m->temperature = by->temperature;
#endif
#ifdef LEVELS
    m->level = R(1);
    m->viscous_level = R(1);
#each level
    m->level += EFFECT_level(s, m);
#end
#each viscous_level
    m->viscous_level += EFFECT_viscous_level(s, m);
#end
    m->level = m->level < R(0) ? R(0) : m->level;
    m->viscous_level = m->viscous_level < R(0) ? R(0) : m->viscous_level;
#endif
    (void)s;
}

/* Friction without its viscous part; a rigid contact slides in the direction of the mode whatever
 * velocity is predicted. */
static real dry(stiction_state *s, motion m, int mode)
{
#ifdef RIGID
    const real speed = r_fabs(m.velocity);
    m.velocity = (real)mode * (speed != R(0) ? speed : R(1e-300));
#else
    (void)mode;
#endif
    return law_step(s, &m);
}

/* What a contact resists with where it is; the state is for nobody. */
static real dry_now(const stiction_state *s, motion m, int mode)
{
    stiction_state probe = *s;
    m.dt = R(0);
    m.displacement = R(0);
    m.start = m.velocity;
    return dry(&probe, m, mode);
}
static real viscous(const motion *m)
{
    (void)m;
#ifdef DRAGS
    return VISCOUS * VISCOUS_LEVEL;
#else
    return R(0);
#endif
}

#ifdef STEEP
/* The machine after a step, whose velocity the law solves for together with its friction: twice,
 * with its contact after an unbraked step, and where that takes the body. */
static stiction_machine attempt(const stiction_machine *a, const acting *by, real h)
{
    stiction_machine end = *a;
    stiction_state *const s = &end.contact;
    const real v = a->velocity;
    real effort, friction, mean, velocity = v, displacement = h * v;
    motion it = {0};
    motion *const m = &it;
    int k;
    it.velocity = it.start = v;
    effort = mean = driven(a, s, by->input, v) + by->load + a->ambient;
    reach(s, m, effort, by);
    friction = v == R(0) ? s->friction : dry_now(s, it, 0) + viscous(m) * v;
    for (k = 0;; ++k) {
        stiction_state probe = a->contact;
        real crept = R(0);
        it.dt = h;
        probe.friction = friction;
        it.velocity = velocity;
        it.displacement = displacement;
#each creep
        crept += EFFECT_creep(&probe, m);
#end
        it.displacement -= crept;
        dry(&probe, it, 0);
        if (k == 2) {
            *s = probe;
            break;
        }
        law_arrive(probe.law.log_age, LEVEL, viscous(m), v, friction, mean, h, &velocity,
                   &displacement);
        if (k == 0) {
            s->position.value = a->contact.position.value + displacement;
            s->time.value = a->contact.time.value + h;
            s->path.value = a->contact.path.value + r_fabs(displacement);
            s->moved = a->contact.moved + displacement;
            end.ambient = ambient(s, velocity);
            {
                const real then = driven(a, s, by->input, velocity) + by->load + end.ambient;
                it.velocity = velocity;
                reach(s, m, then, by);
                mean = R(0.5) * (effort + then);
            }
        }
    }
    {
        motion last = it;
        stiction_state probe = *s;
        s->friction = dry_now(&probe, last, 0) + viscous(m) * velocity;
    }
    s->position.value += displacement;
    s->time.value += h;
    s->path.value += r_fabs(displacement);
    s->moved += displacement;
    end.velocity = velocity;
    return end;
}
#else
/* The machine after a step in the present mode. */
static stiction_machine attempt(const stiction_machine *a, const acting *by, real h)
{
    stiction_machine end = *a;
    stiction_state *const s = &end.contact;
    const real v = a->velocity, pace = h / INERTIA;
    real effort, effort_then, friction, push, displacement, damping, undamped, shown;
    motion it = {0};
    motion *const m = &it;
#ifdef USES_VELOCITY
    stiction_state before;
    real nudge;
#endif
    it.velocity = it.start = v;
    effort = driven(a, s, by->input, v) + by->load + a->ambient;
    reach(s, m, effort, by);
#ifdef RIGID
    if (end.mode == 0) {
        end.mode = v > R(0) ? 1 : v < R(0) ? -1 : effort > R(0) ? 1 : -1;
    }
#endif
    friction = dry_now(s, it, end.mode) + viscous(m) * v;
    push = effort - friction;
    displacement = h * v + R(0.5) * h * pace * push;
    it.dt = h;
    it.velocity = v + pace * push;
    it.displacement = displacement;
    s->position.value += displacement;
    s->time.value += h;
    s->path.value += r_fabs(displacement);
    s->moved += displacement;
    /* A rigid contact stops the body where its velocity would turn round: nothing acts beyond. */
#ifdef RIGID
    shown = v * it.velocity < R(0) ? R(0) : it.velocity;
#else
    shown = it.velocity;
#endif
    end.ambient = ambient(s, shown);
    s->friction = friction;
#each creep
    it.displacement -= EFFECT_creep(s, m);
#end
    effort_then = driven(a, s, by->input, shown) + by->load + end.ambient;
    {
        const real predicted = it.velocity;
        it.velocity = shown;
        reach(s, m, effort_then, by);
        it.velocity = predicted;
    }
#ifdef USES_VELOCITY
    before = *s;
#endif
    undamped = dry(s, it, end.mode);
    damping = viscous(m);
#ifdef USES_VELOCITY
    /* Friction that rises with the velocity is taken where the step ends, to first order. */
    nudge = R(1e-3) * (r_fabs(it.velocity) + r_fabs(pace * push));
    if (nudge > R(0)) {
        motion faster = it;
        const real side = it.velocity < R(0) ? R(-1) : R(1);
        real rise;
        faster.velocity += side * nudge;
        rise = (dry(&before, faster, end.mode) - undamped) / (side * nudge);
        if (rise + damping > R(0)) {
            damping += rise;
            undamped -= rise * it.velocity;
        } else {
            undamped += damping * it.velocity;
            damping = R(0);
        }
    }
#endif
    end.velocity = (INERTIA * v + R(0.5) * h * (push + effort_then - undamped))
        / (INERTIA + R(0.5) * h * damping);
    s->friction = undamped + damping * end.velocity;
    return end;
}
#endif
#ifdef RIGID

/* Holds a body at rest where the contact can: nothing moves but slow creep. */
static int hold(stiction_machine *a, const acting *by, real h)
{
    stiction_state *const s = &a->contact;
    const real effort = driven(a, s, by->input, R(0)) + by->load + a->ambient;
    motion it = {0};
    motion *const m = &it;
    stiction_state probe = *s;
    it.dt = h;
    reach(s, m, effort, by);
    if (law_step(&probe, m) != effort) {
        a->mode = effort > R(0) ? 1 : -1;
        return 0;
    }
    s->friction = effort;
    s->time.value += h;
#ifdef CREEPS_BESIDE
    {
        real crept = R(0);
#each creep
        crept += EFFECT_creep(s, m);
#end
        s->position.value += crept;
        s->moved += crept;
        s->path.value += r_fabs(crept);
        a->ambient = ambient(s, R(0));
    }
#endif
    return 1;
}
#endif
