
/* The machine as differential equations with events, for a solver of somebody else's. Friction
 * follows from where the solver asks and from the last step that it completed: of a contact whose
 * force does not go by the time that is exact over any motion one way, and where motion turns round
 * is an event. States are position and velocity and, of bristles, their force. */
#ifdef BENDS
#define STATES 3
#else
#define STATES 2
#endif
#if WATCHED > 0
#define INDICATORS 2
#else
#define INDICATORS 1
#endif
/* Share of what a contact holds that an effort has to come beyond before its break-away is an
 * event. A solver finds the root of the indicator to rounding: on either side of it the effort is
 * then beyond what is held, and the contact slides. At the root itself it would stay, and nothing
 * would come to it again. */
#define BREAKAWAY_MARGIN R(1e-9)
typedef struct {
    real rate[STATES], friction, indicator[INDICATORS];
} evaluation;

static void placed(stiction_state *s, const real *y, real passed)
{
    const real way = y[0] - s->position.value;
    s->position.value = y[0];
    s->path.value += r_fabs(way);
    s->time.value += passed;
#ifdef BENDS
    s->law.force = y[2];
#endif
}

/* Leads a contact to where the solver is, and gives what it resists with there. */
static real resistance(stiction_machine *now, const real *y, real passed, const acting *by,
                       real *effort)
{
    stiction_state *const s = &now->contact;
    motion it = {0};
    motion *const m = &it;
    it.velocity = it.start = y[1];
    it.displacement = y[0] - s->position.value;
    it.dt = passed;
    placed(s, y, passed);
    now->velocity = y[1];
    now->ambient = ambient(s, y[1]);
    *effort = driven(now, s, by->input, y[1]) + by->load + now->ambient;
    reach(s, m, *effort, by);
#ifdef BENDS
    s->friction = dry_now(s, it, 0) + viscous(m) * y[1];
#else
#ifdef RIGID
    if (now->mode == 0) {
        s->friction = *effort;
        return r_fabs(dry_now(s, it, *effort < R(0) ? -1 : 1));
    }
#endif
    s->friction = dry(s, it, now->mode) + viscous(m) * y[1];
#endif
    return s->friction;
}

/* Whether a contact at rest holds this effort: what it bears at most is known. */
static evaluation evaluate(const stiction_machine *at, const real *y, real passed,
                           const acting *by)
{
    stiction_machine now = *at;
    evaluation found;
    real effort, resisted = resistance(&now, y, passed, by, &effort);
    found.friction = now.contact.friction;
    found.indicator[0] = y[1];
#if WATCHED > 0
    /* Where friction falls: a solver that runs straight ahead would step over it. */
    found.indicator[1] = r_fabs(y[1]) - WATCHED;
#endif
#ifdef RIGID
    if (at->mode == 0) {
        found.rate[0] = R(0);
        found.rate[1] = R(0);
        /* The last is for a contact that holds nothing. */
        found.indicator[0] = resisted - r_fabs(effort) + resisted * BREAKAWAY_MARGIN + R(1e-300);
        return found;
    }
    found.indicator[0] = (real)at->mode * y[1];
#endif
    found.rate[0] = y[1];
    found.rate[1] = (effort - resisted) / INERTIA;
#ifdef BENDS
    found.rate[2] = law_rate(y[2], y[1]);
#endif
    return found;
}

/* Takes over where the solver has come to. */
static void complete(stiction_machine *at, const real *y, real passed, const acting *by)
{
    real effort;
    resistance(at, y, passed, by, &effort);
}

/* At an event: a slide that has come to rest sticks where it can; whether states were changed. */
static int settle(stiction_machine *at, real *y, const acting *by)
{
    int changed = 0;
#ifdef RIGID
    if (at->mode == 0 && y[1] != R(0)) {
        at->mode = y[1] > R(0) ? 1 : -1;
        return 0;
    }
    if ((real)at->mode * y[1] <= R(0)) {
        evaluation found;
        changed = y[1] != R(0);
        y[1] = R(0);
        at->velocity = R(0);
        at->mode = 0;
        found = evaluate(at, y, R(0), by);
        if (found.indicator[0] <= R(0.5) * BREAKAWAY_MARGIN * r_fabs(found.friction)) {
            at->mode = found.friction > R(0) ? 1 : -1;
        }
    }
#else
    (void)at;
    (void)y;
    (void)by;
#endif
    return changed;
}
