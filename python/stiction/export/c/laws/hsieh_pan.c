/* Plastic module, spring with memory and damper, on a hook that breaks away and slides: Hsieh, Pan,
 * Wear 242 (2000), with the reconstructions of docs/theory/hsieh-pan.md. */
#let FADING = INITIAL_STIFFNESS - FINAL_STIFFNESS
#let TWICE = 2.0 if VIRGIN_CURVE == 'masing' else 1.0
#let SLIPS = BREAKAWAY < inf
#let RATED = SLIPS and LOADING_RATE < inf
#let CREEPS = HARDENING_COEFFICIENT > 0 and CREEP_RATE > 0
#let ON_SPRING = DAMPER == 'spring'
#let SLIDING = BREAKAWAY
#if not SLIPS and not CREEPS and not ON_SPRING
#define EXCHANGES
#endif
#let STIFFEST = INITIAL_STIFFNESS
#let CALMS = max(DAMPING, VISCOUS)
#let FALLS_BY = (BREAKAWAY - COULOMB if SLIPS else 0)
#if SLIPS
#define FALLS_IN_SLIDES
#endif
#define OWN_VISCOUS

/* Force of a branch at a distance from its reverse point. */
static real branch_force(real way)
{
    return FINAL_STIFFNESS * way - FADING * DECAY_DISTANCE * r_expm1(-way / DECAY_DISTANCE);
}
#if VIRGIN_CURVE == 'masing'
#define CLOSES_AT_MIRROR
#endif
#define branch(spring, direction, way) branch_force(way)
#define virgin(spring, way) (branch_force(TWICE * (way)) / TWICE)
#include "walk.c"
typedef struct {
    stiction_spring spring; /* while it slides, its force alone counts */
#if CREEPS
    STICTION_REAL hardening;
#endif
#if ON_SPRING
    STICTION_REAL series; /* force of spring and damper */
#endif
#if RATED
    STICTION_REAL filtered, latched; /* force, and level at which the slide began */
#endif
#if SLIPS
    int mode; /* 0 sticks, +1 and -1 slide in that direction */
#endif
} stiction_law;

/* A step, not taken yet. */
typedef struct {
    walked walk;
    real series, friction;
#if CREEPS
    real hardening;
#endif
#if RATED
    real filtered;
#endif
#if SLIPS
    real breakaway, pull;
#endif
} tried;
#if ON_SPRING
#define SERIES series
#else
#define SERIES spring.force
#endif
#if SLIPS or CREEPS

static real virgin_slope(real way)
{
    return FINAL_STIFFNESS + FADING * r_exp(-way * TWICE / DECAY_DISTANCE);
}
#endif
#if CREEPS
#include "creep.c"
#if ON_SPRING
#include "series.c"
#else
#include "logarithmic_mean.c"

/* Hardening over a step of a spring that is linear over it, solved exactly: how it grows, begins
 * (where the limit overtakes it) or ends (where it falls below it) within the step. */
static real hardened(const stiction_law *law, real displacement, real span)
{
    const real force = law->spring.force, side = force > R(0) ? R(1) : R(-1);
    const real margin = limit(force) - law->hardening;
    const real held = margin > R(0) ? CREEP_RATE * span * margin : R(0);
    real net = displacement - side * held, stiffness = INITIAL_STIFFNESS, gain, rise, z, left;
    if (force == R(0) || span <= R(0)) {
        return R(0);
    }
    net = net == R(0) ? -side : net;
    if ((net > R(0) ? 1 : -1) == law->spring.direction) {
        const int first = law->spring.points == 0;
        stiffness = virgin_slope(first ? law->spring.way : law->spring.way / TWICE);
    }
    gain = limit_slope(force) * stiffness;
    z = CREEP_RATE * span * (R(1) + gain);
    rise = gain * displacement * side;
    if (margin <= R(0)) {
        if (rise <= R(0) || margin + rise <= R(0)) {
            return R(0);
        }
        left = span + margin * span / rise;
        return CREEP_RATE * (rise / span) * left * left * second_mean(z / span * left);
    }
    if (rise < R(0) && margin * (R(1) - z * first_mean(z)) + rise * first_mean(z) < R(0)) {
        rise /= span;
        z /= span;
        left = -(margin / rise) * logarithmic_mean(z * margin / rise);
        z *= left;
        return CREEP_RATE * left * (margin * first_mean(z) + rise * left * second_mean(z));
    }
    return held * first_mean(z) + CREEP_RATE * span * rise * second_mean(z);
}
#endif
#endif
#if RATED
#include "short_ways.c"
#endif
#if SLIPS
#ifdef MACHINE
#include "lagging.c"
#endif

/* Where the virgin curve has a force of this size: Halley's iteration. */
static real virgin_inverse(real target)
{
    const real rest = FINAL_STIFFNESS / FADING;
    const real share = TWICE * target / (FADING * DECAY_DISTANCE);
    const real linear = rest + R(1) - R(0.5) * share;
    const real root = r_sqrt(linear * linear + R(2) * rest * share);
    real x, low = R(0), high = target / FINAL_STIFFNESS;
    int k;
    x = (linear > R(0) ? R(2) * share / (linear + root) : (root - linear) / rest)
        * DECAY_DISTANCE / TWICE;
    for (k = 0; k < 20; ++k) {
        const real slope = virgin_slope(x);
        const real bend = (FINAL_STIFFNESS - slope) * TWICE / DECAY_DISTANCE;
        const real step = (target - virgin(0, x)) / slope;
        const real moved = step / (R(1) + R(0.5) * step * bend / slope);
        x += moved;
        if (r_fabs(moved) <= R(1e-3) * x) {
            return x + (target - virgin(0, x)) / virgin_slope(x);
        }
    }
    for (k = 0; k < 200; ++k) {
        x = R(0.5) * (low + high);
        if (x <= low || x >= high) {
            break;
        }
        if (virgin(0, x) >= target) {
            high = x;
        } else {
            low = x;
        }
    }
    return high + (target - virgin(0, high)) / virgin_slope(high);
}

/* What the force through the series makes of the level of break-away. */
static void loaded(const stiction_law *law, real span, tried *end)
{
#if RATED
    const real from = law->SERIES, z = span / LOADING_TIME;
    const real mean = first_mean(z);
    end->filtered = from + (end->series - from) * (R(1) - mean)
        + (law->filtered - from) * (R(1) - z * mean);
    end->breakaway = COULOMB + (BREAKAWAY - COULOMB)
        * r_exp(-r_fabs(end->series - end->filtered) / (LOADING_TIME * LOADING_RATE));
#else
    (void)law;
    (void)span;
    end->breakaway = BREAKAWAY;
#endif
}

/* A sliding hook: the force follows the sliding level over a distance, no faster than the spring
 * gains where the hook stands still. */
static void slip(const stiction_law *law, const motion *m, real span, tried *end)
{
    const real distance = r_fabs(WAY(span)), share = r_fabs(m->velocity / STRIBECK_VELOCITY);
#if RATED
    const real top = law->latched;
#else
    const real top = BREAKAWAY;
#endif
#if STRIBECK_EXPONENT == 2
    const real left = r_exp(-share * share);
#else
    const real left = r_exp(-r_pow(share, STRIBECK_EXPONENT));
#endif
    const real from = (real)law->mode * law->SERIES;
    real level = COULOMB + (top - COULOMB) * left, now;
#ifdef MACHINE
    const real share_before = r_fabs(m->start / STRIBECK_VELOCITY);
    real before = COULOMB + (top - COULOMB)
        * r_exp(-r_pow(share_before, STRIBECK_EXPONENT));
#endif
#if VISCOUS != 0
    if (LEVEL != R(0)) {
        level += VISCOUS * VISCOUS_LEVEL / LEVEL * r_fabs(m->velocity);
#ifdef MACHINE
        before += VISCOUS * VISCOUS_LEVEL / LEVEL * r_fabs(m->start);
#endif
    }
#endif
#ifdef MACHINE
    now = lagging(from, before, level, distance / SLIP_DISTANCE);
#else
    now = from + (level - from) * -r_expm1(-distance / SLIP_DISTANCE);
#endif
    if (now > from + FINAL_STIFFNESS * distance) {
        const real at = virgin_inverse(r_fabs(from));
        const real x = (from < R(0) ? -at : at) + distance;
        const real most = x < R(0) ? -virgin(0, -x) : virgin(0, x);
        now = now < most ? now : most;
    }
    end->series = (real)law->mode * now;
    end->friction = end->series * LEVEL;
    end->pull = level - now;
    loaded(law, span, end);
}
#endif

/* A sticking hook: creep, spring and damper. */
static void stick(const stiction_law *law, const motion *m, real span, tried *end)
{
#if ON_SPRING and CREEPS
    creep_in_series(law, m, span, end);
#else
    real displacement = WAY(span);
#if CREEPS
    const real grown = hardened(law, displacement, span);
    end->hardening = law->hardening + grown;
    displacement -= law->spring.force > R(0) ? grown : -grown;
#endif
    end->walk = walk(&law->spring, displacement);
    end->series = end->walk.force;
#if ON_SPRING
    end->series += DAMPING * m->velocity;
#endif
#endif
    end->friction = end->series * LEVEL;
#if DAMPING != 0 and not ON_SPRING
    end->friction += DAMPING * m->velocity;
#endif
#if SLIPS
    loaded(law, span, end);
#endif
}

static void take(stiction_law *law, const tried *end)
{
#if RATED
    law->filtered = end->filtered;
#endif
#if ON_SPRING
    law->series = end->series;
#endif
#if SLIPS
    if (law->mode != 0) {
        law->spring.force = end->series;
        return;
    }
#endif
    accept(&law->spring, &end->walk);
#if CREEPS
    law->hardening = end->hardening;
#endif
}
#if SLIPS

/* On the first loading curve at a force, with nothing remembered. */
static void place(stiction_law *law, real force)
{
    law->spring.points = 0;
    law->spring.force = force;
    law->spring.way = virgin_inverse(r_fabs(force));
    law->spring.direction = force > R(0) ? 1 : force < R(0) ? -1 : 0;
}

static void stop(stiction_law *law)
{
    law->mode = 0;
    place(law, law->SERIES);
#if CREEPS and AFTER_SLIP == 'reset'
    law->hardening = R(0);
#endif
}

static real until_breakaway(const stiction_law *law, const motion *m, real span)
{
    tried end;
    stick(law, m, span, &end);
#if RATED
    /* A force that its level fell below stays where it is until motion loads it further. */
    return end.breakaway - (m->velocity > R(0) ? end.series : -end.series);
#else
    return end.breakaway - r_fabs(end.series);
#endif
}

/* By how much the spring at the force of a slide is stiffer than the hook needs to go on. */
static real drag_left(const tried *end)
{
    const real least = SLIP_DISTANCE * FINAL_STIFFNESS - end->pull;
#if not ON_SPRING
    if (least <= R(0) && end->breakaway > r_fabs(end->series)) {
        return SLIP_DISTANCE * virgin_slope(virgin_inverse(r_fabs(end->series))) - end->pull;
    }
#endif
    return least != R(0) ? r_fabs(least) : R(1e-30);
}

static real until_caught(const stiction_law *law, const motion *m, real span)
{
    tried end;
    slip(law, m, span, &end);
    return drag_left(&end);
}
#include "events.c"
#endif

static real law_step(stiction_state *s, const motion *m)
{
    stiction_law *law = &s->law;
    tried end;
#if SLIPS
    real left = m->dt;
    int events;
    for (events = 0;; ++events) {
        const int sticks = law->mode == 0;
        real at;
        if (events < 16 && !sticks && (real)law->mode * m->velocity <= R(0)) {
            stop(law);
            continue;
        }
        if (sticks) {
            stick(law, m, left, &end);
            at = end.breakaway - r_fabs(end.series);
            /* Only motion that loads it further breaks it away. */
            at = m->velocity * end.series > R(0) ? at : R(1);
        } else {
            slip(law, m, left, &end);
            at = drag_left(&end);
        }
        /* Not for ever, as in the core: at odd parameters a hook may chatter. */
        if (at > R(0) || events == 16) {
            break;
        }
        at = locate(sticks ? until_breakaway : until_caught, law, m, left, at);
        if (sticks) {
            stick(law, m, at, &end);
            take(law, &end);
            law->mode = end.series > R(0) ? 1 : -1;
#if RATED
            law->latched = end.breakaway;
#endif
#if ON_SPRING
            law->series = law->spring.force;
#endif
            place(law, law->SERIES);
        } else {
            slip(law, m, at, &end);
            take(law, &end);
            stop(law);
        }
        left -= at;
        left = left <= EPSILON * m->dt ? R(0) : left;
    }
#else
    stick(law, m, m->dt, &end);
#endif
    take(law, &end);
    return end.friction;
}
#ifdef MACHINE

/* Whether the hook broke away or caught. */
static int law_breaks(const stiction_law *before, const stiction_law *after)
{
#if SLIPS
#define DRAGGED_ALONG
    return before->mode != after->mode;
#else
    (void)before;
    (void)after;
    return 0;
#endif
}
#endif
