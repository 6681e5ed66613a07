/* One trajectory of a body on a `hsieh_pan` contact, as fast as plain C gets: the parameters are
 * compile-time constants, divisions are hoisted to reciprocals, n = 2 is a product, output goes into
 * the caller's buffers and nothing is allocated.
 *
 * It is the work of the core to the letter: the same velocity Verlet step with trapezoidal damping,
 * the same creep, the same reverse points, break-away and sticking located inside the step.
 * HSIEH_PAN_DIRECT evaluates every exponential by the library; without it the spring goes on from the
 * step before, and a slide has exponentials of its own, as the core does.
 */
#include <float.h>
#include <math.h>
#include <stddef.h>

#include "exponential.h"
#include "reference.h"

#define K_0 3000.0
#define K_INF (0.27 * K_0)
#define D_0 2.908882086657216e-4
#define HARDENING 1.6e-3
#define CREEP_RATE 2.0
#define C_S 0.45
#define F_S 0.5
#define F_C (0.7 * F_S)
#define V_S 0.1
#define REACH 2e-5

#define FADING (K_0 - K_INF)
#define PER_D_0 (1.0 / D_0)
#define PER_INERTIA (1.0 / INERTIA)
#define SERIES 0.02
#define SHORTER 0.01
#define SYNCHRONISED 256
#define POINTS 4096
#define MOST_EVENTS 16

#define LIKELY(c) __builtin_expect(!!(c), 1)
#define UNLIKELY(c) __builtin_expect(!!(c), 0)
#define INLINE static inline __attribute__((always_inline))
#define COLD static __attribute__((noinline))

typedef struct {
    double position, force;
} Point;

typedef struct {
    double x, v;                    /* body */
    double mode;                    /* 0 sticks, +-1 slides */
    double at, force, slope, way;   /* spring: elongation, force, slope, direction */
    double hardening, latched;
    double per_distance;            /* 1/d_0 on a branch, 2/d_0 on the first loading */
    double target;                  /* where the branch closes its loop, times the direction */
    int since;                      /* steps since the spring was evaluated from its anchor */
    int points;
    Point point[POINTS];
    long breakaways, sticks, reversals, closings;
} State;

/* What a step would change. */
typedef struct {
    double x, v, velocity; /* velocity: predicted */
    double at, force, slope, hardening;
    double ds;
    double pull;           /* sliding: T - s*force */
    int plain;             /* the spring went on along its branch */
} Step;

typedef struct {
    double force, slope;
} Response;

/* (1 - (1 - e^-z)/z)/z for 0 <= z < SHORTER, interpolated at the nodes of Chebyshev: to 3e-13. */
INLINE double second_share(double z)
{
    return (0.49999999999989186 - z * 0.16666666632048885)
        + (z * z) * (0.04166649351978712 - z * 0.008305611273979163);
}

/* A short way along a branch, z < SERIES: F + d*(k - E*z*phi) and k - E*z*(1 - z*phi) with phi = (1 - (1 -
 * e^-z)/z)/z to 1.8e-12, summed so that little waits for the displacement. */
INLINE void short_way(double force, double slope, double displacement, double z, double *force_then,
    double *slope_then)
{
    double near = 0.499999999998275 - z * 0.16666666390556875;
    double far = 0.0416659759297064 - z * 0.008278000311740141;
    double excess = slope - K_INF, square = z * z;
    double bent = (excess * displacement) * z, fallen = excess * z, eased = fallen * z;
    *force_then = ((force + displacement * slope) - bent * near) - (bent * square) * far;
    *slope_then = ((slope - fallen) + eased * near) + (eased * square) * far;
}

INLINE double sign(double x)
{
    return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0;
}

/* G and its slope at a distance from a reverse point. */
INLINE Response branch(double d)
{
    double gone = -expm1(-d * PER_D_0);
    return (Response){K_INF * d + FADING * D_0 * gone, K_0 - FADING * gone};
}

INLINE Response virgin(double x)
{
    double s = x < 0.0 ? -1.0 : 1.0;
    Response r = branch(x * (2.0 * s));
    return (Response){r.force * (0.5 * s), r.slope};
}

COLD double virgin_inverse(double force)
{
    double target = fabs(force), s = force < 0.0 ? -1.0 : 1.0;
    double x = target * (1.0 / K_0);
    for (int k = 0; k < 60; k++) {
        Response r = virgin(x);
        double next = fmax(x + (target - r.force) / r.slope, 0.0);
        double moved = fabs(next - x);
        x = next;
        if (moved <= 8.881784197001252e-16 * next) break;
    }
    Response r = virgin(x);
    return (x + (target - r.force) / r.slope) * s;
}

/* Creep over a span in which hardening begins or ends: rare. */
COLD double partial_creep(double s, double margin, double gain, double displacement, double span)
{
    double rate = CREEP_RATE * (gain + 1.0), rise = gain * displacement * s / span;
    double start = margin, left = span;
    if (margin > 0.0) {
        double u = rate * start / rise;
        left = -(start / rise) * (fabs(u) < 1e-3
            ? 1.0 + u * (0.5 + u * (1.0 / 3.0 + u * (0.25 + u * (0.2 + u / 6.0))))
            : -log1p(-u) / u);
    } else {
        start = 0.0;
        left = span + margin / rise;
    }
    double z = rate * left, mean, second;
    if (z < SHORTER) {
        second = second_share(z);
        mean = 1.0 - z * second;
    } else {
        mean = -expm1(-z) / z;
        second = (1.0 - mean) / z;
    }
    return (start * left * mean + rise * (left * left * second)) * CREEP_RATE;
}

INLINE double slope_towards(double slope, double way, double direction)
{
    if (LIKELY(direction == way)) return slope;
    return K_0;
}

/* Hardening gained while the series is displaced; at held force it would be f - h. */
INLINE double creep(double force, double slope, double way, double hardening, double displacement,
    double span, double *ds)
{
    double size = fabs(force), s = copysign(1.0, force);
    double margin = HARDENING * size * size - hardening;
    if (UNLIKELY(size == 0.0 || span <= 0.0)) {
        *ds = displacement;
        return 0.0;
    }
    if (margin > 0.0) {
        double held = CREEP_RATE * span * margin;
        double direction;
        if (displacement > s * held) direction = 1.0;
        else if (displacement < s * held) direction = -1.0;
        else direction = -s;
        double stiffness = slope_towards(slope, way, direction);
        double gain = 2.0 * HARDENING * size * stiffness;
        double pace = (CREEP_RATE * span * 2.0 * HARDENING) * size * stiffness;
        double z = CREEP_RATE * span + pace;
        double risen = gain * (displacement * s);
        if (LIKELY(z < SHORTER)) {
            double second = second_share(z);
            if (LIKELY(risen >= 0.0 || margin * (1.0 - z) + risen >= 0.0
                    || margin * (1.0 - z * (1.0 - z * second)) + risen * (1.0 - z * second) >= 0.0)) {
                double lagged = second * (held * s * z - pace * displacement);
                *ds = (displacement - s * held) + lagged;
                return held - lagged * s;
            }
        } else {
            double mean = -expm1(-z) / z;
            if (risen >= 0.0 || margin * (1.0 - z * mean) + risen * mean >= 0.0) {
                double gained = held * mean + CREEP_RATE * span * risen * ((1.0 - mean) / z);
                *ds = displacement - s * gained;
                return gained;
            }
        }
        double gained = partial_creep(s, margin, gain, displacement, span);
        *ds = displacement - s * gained;
        return gained;
    }
    double direction = displacement > 0.0 ? 1.0 : displacement < 0.0 ? -1.0 : -s;
    double gain = 2.0 * HARDENING * size * slope_towards(slope, way, direction);
    double risen = gain * (displacement * s);
    if (LIKELY(risen <= 0.0 || margin + risen <= 0.0)) {
        *ds = displacement;
        return 0.0;
    }
    double gained = partial_creep(s, margin, gain, displacement, span);
    *ds = displacement - s * gained;
    return gained;
}

typedef struct {
    Response end;
    double way;
    int kept, closings, reversed, added;
} Walk;

/* Walk through reverse points. */
COLD Walk walk(const State *st, double position, double ds)
{
    double moving = sign(ds), way = moving == 0.0 ? st->way : moving;
    int reversed = way != st->way && st->way != 0.0, added = reversed, kept = st->points, closings = 0;
    for (;;) {
        double target;
        int wiped;
        if (added) {
            target = kept == 0 ? -st->at : st->point[kept - 1].position;
            wiped = kept == 0 ? 0 : 1;
        } else if (kept == 0) {
            break;
        } else {
            target = kept == 1 ? -st->point[0].position : st->point[kept - 2].position;
            wiped = kept == 1 ? 1 : 2;
        }
        if (way * (position - target) < 0.0) break;
        kept -= wiped;
        added = 0;
        closings++;
    }
    Walk w = {.way = way, .kept = kept, .closings = closings, .reversed = reversed, .added = added};
    if (added || kept > 0) {
        Point anchor = added ? (Point){st->at, st->force} : st->point[kept - 1];
        Response r = branch((position - anchor.position) * way);
        w.end = (Response){anchor.force + r.force * way, r.slope};
    } else {
        w.end = virgin(position);
    }
    return w;
}

COLD void accept_walk(State *st, Walk w, double position)
{
    if (w.added) st->point[w.kept] = (Point){st->at, st->force};
    st->points = w.kept + w.added;
    st->at = position;
    st->force = w.end.force;
    st->slope = w.end.slope;
    st->way = w.way;
    st->reversals += w.reversed;
    st->closings += w.closings;
    st->since = 0;
    st->per_distance = st->points ? PER_D_0 : 2.0 * PER_D_0;
    st->target = st->points == 0 ? INFINITY
        : st->points == 1        ? -st->point[0].position * w.way
                                 : st->point[st->points - 2].position * w.way;
}

/* A step of a sticking hook. */
INLINE Step stick(const State *st, double x, double v, double at, double force, double slope,
    double hardening, double way, double per_distance, double target, int since, double effort,
    double span)
{
    Step step;
    double half = 0.5 * span, lever = span * half * PER_INERTIA, push = effort - force;
    double displacement = (span - lever * C_S) * v + lever * push;
    step.velocity = v + (span * PER_INERTIA) * (push - C_S * v);
    step.x = x + displacement;
    double gained = creep(force, slope, way, hardening, displacement, span, &step.ds);
    step.hardening = hardening + gained;
    step.at = at + step.ds;
    double forward = step.ds * way, z = forward * per_distance;
    step.plain = z > 0.0 && z < SERIES && step.at * way < target && since < SYNCHRONISED - 1;
#ifdef HSIEH_PAN_DIRECT
    step.plain = z > 0.0 && step.at * way < target;
    if (LIKELY(step.plain)) {
        if (st->points) {
            Point anchor = st->point[st->points - 1];
            Response r = branch((step.at - anchor.position) * way);
            step.force = anchor.force + r.force * way;
            step.slope = r.slope;
        } else {
            Response r = virgin(step.at);
            step.force = r.force;
            step.slope = r.slope;
        }
    }
#else
    if (LIKELY(step.plain)) {
        short_way(force, slope, step.ds, z, &step.force, &step.slope);
    }
#endif
    else {
        Walk w = walk(st, step.at, step.ds);
        step.force = w.end.force;
        step.slope = w.end.slope;
    }
    /* J*v + h/2*(E - F + E - sigma), the damping at the end solved for and sigma last. */
    double per_inertia = 1.0 / (INERTIA + half * C_S);
    step.v = ((INERTIA - half * C_S) * per_inertia * v + (half * per_inertia) * (push + effort))
        - (half * per_inertia) * step.force;
    return step;
}

INLINE double power(double v)
{
    double share = v * (1.0 / V_S);
    return share * share;
}

/* Damping of a step whose predicted velocity has turned round, where the level falls with speed. */
COLD double turned(double latched, double v, double share)
{
    return (latched - F_C) * exp(-power(v)) * 2.0 * (fabs(v) * (1.0 / (V_S * V_S))) * share;
}

/* A step of a sliding hook. */
INLINE Step slip(double x, double v, double force, double mode, double latched,
    double effort, double span)
{
    Step step;
    double half = 0.5 * span;
    double lever = span * half * PER_INERTIA, net = effort - force;
    double displacement = span * v + lever * net;
    step.velocity = v + (span * PER_INERTIA) * net;
    step.x = x + displacement;
    double distance = fabs(displacement), z = distance * (1.0 / REACH), y = force * mode;
#ifdef HSIEH_PAN_DIRECT
    double gone = z < 0.5 ? -expm1(-z) : 1.0 - exp(-z);
    double left_before = exp(-power(v)), left = exp(-power(step.velocity));
#else
    Pair both = fading_and_faded(-power(v), -z);
    double left_before = both[0], gone = both[1], left = fading(-power(step.velocity));
#endif
    double from = F_C + (latched - F_C) * left_before, to = F_C + (latched - F_C) * left;
    double share = z < 1e-5 ? 0.5 * z : 1.0 - gone * (1.0 / z);
    double sigma = from + (to - from) * share + (y - from) * (1.0 - gone);
    double damping = 0.0;
    if (UNLIKELY(mode * step.velocity < 0.0)) damping = turned(latched, step.velocity, share);
    if (UNLIKELY(sigma > y + K_INF * distance)) {
        double limit = virgin(virgin_inverse(y) + distance).force;
        if (sigma > limit) {
            sigma = limit;
            damping = 0.0;
        }
    }
    step.pull = to - sigma;
    step.force = sigma * mode;
    step.v = (v + (half * PER_INERTIA) * (net + effort)) - (half * PER_INERTIA) * step.force;
    if (UNLIKELY(damping > 0.0)) {
        step.v = (INERTIA * v + half * (net + (effort - step.force)) + half * damping * step.velocity)
            / (INERTIA + half * damping);
    }
    return step;
}

enum Event { NONE, BREAK_AWAY, REVERSAL, HOOK_RETURN };

INLINE double hook_margin(const Step *step)
{
    double least = REACH * K_INF - step->pull;
    if (LIKELY(least > 0.0 || F_S - fabs(step->force) <= 0.0)) return fmax(fabs(least), DBL_MIN);
    return REACH * virgin(virgin_inverse(step->force)).slope - step->pull;
}

/* Any step of any duration, from memory. */
COLD Step attempt(const State *st, double effort, double span)
{
    if (st->mode == 0.0) {
        return stick(st, st->x, st->v, st->at, st->force, st->slope, st->hardening, st->way,
            st->per_distance, st->target, st->since, effort, span);
    }
    return slip(st->x, st->v, st->force, st->mode, st->latched, effort, span);
}

INLINE enum Event event(double mode, const Step *step)
{
    if (mode == 0.0) {
        return UNLIKELY(fabs(step->force) >= F_S && step->v * step->force > 0.0) ? BREAK_AWAY : NONE;
    }
    if (UNLIKELY(hook_margin(step) <= 0.0)) return HOOK_RETURN;
    return UNLIKELY(mode * step->v <= 0.0) ? REVERSAL : NONE;
}

COLD double margin(const State *st, double effort, double span, enum Event which)
{
    Step step = attempt(st, effort, span);
    if (which == REVERSAL) return step.v * st->mode;
    if (which == HOOK_RETURN) return hook_margin(&step);
    return F_S - fabs(step.force);
}

/* Zero of the margin by the Illinois rule, then two Newton steps with a central slope. */
COLD double locate(const State *st, double effort, double span, enum Event which)
{
    double low = 0.0, high = span, at_low = margin(st, effort, 0.0, which);
    if (at_low <= 0.0 || high <= 0.0) return 0.0;
    double at_high = margin(st, effort, span, which), tolerance = 1e-15 * high;
    if (at_high >= 0.0) return span;
    int side = 0;
    for (int k = 0; k < 100 && high - low > tolerance; k++) {
        double secant = (low * at_high - high * at_low) / (at_high - at_low);
        double middle = secant > low && secant < high ? secant : 0.5 * (low + high);
        double there = margin(st, effort, middle, which);
        if (there == 0.0) {
            low = high = middle;
        } else if (there > 0.0) {
            low = middle;
            at_low = there;
            if (side == -1) at_high *= 0.5;
            side = -1;
        } else {
            high = middle;
            at_high = there;
            if (side == 1) at_low *= 0.5;
            side = 1;
        }
    }
    double root = 0.5 * (low + high), at = root;
    double width = fmin(1e-5 * span, fmax(root, 1e-9 * span));
    double slope = (margin(st, effort, root + width, which) - margin(st, effort, root - width, which))
        / (2.0 * width);
    if (slope < 0.0) {
        for (int k = 0; k < 2; k++) at -= margin(st, effort, at, which) / slope;
    }
    return fmin(fmax(at, 0.0), span);
}

COLD void commit(State *st, const Step *step, int stopped)
{
    if (st->mode == 0.0) {
        if (step->plain) {
            st->at = step->at;
            st->force = step->force;
            st->slope = step->slope;
            st->since++;
        } else {
            accept_walk(st, walk(st, step->at, step->ds), step->at);
        }
        st->hardening = step->hardening;
    } else {
        st->force = step->force;
    }
    st->x = step->x;
    st->v = stopped ? 0.0 : step->v;
}

COLD void change(State *st, enum Event which)
{
    if (which == BREAK_AWAY) {
        st->mode = sign(st->force);
        st->latched = F_S;
        st->breakaways++;
    } else {
        st->mode = 0.0;
        st->hardening = 0.0;
        st->sticks++;
    }
    st->at = virgin_inverse(st->force);
    st->slope = virgin(st->at).slope;
    st->way = sign(st->force);
    st->points = 0;
    st->since = 0;
    st->per_distance = 2.0 * PER_D_0;
    st->target = INFINITY;
}

/* A step with all that may happen in it. */
COLD void through_events(State *st, double effort)
{
    double left = DT;
    int passed = 0;
    for (;;) {
        if (passed < MOST_EVENTS && st->mode * st->v < 0.0) {
            change(st, REVERSAL);
            passed++;
            continue;
        }
        Step step = attempt(st, effort, left);
        enum Event found = passed < MOST_EVENTS ? event(st->mode, &step) : NONE;
        if (found == NONE) {
            commit(st, &step, 0);
            return;
        }
        passed++;
        double at = left;
        for (int k = 0; k < 4; k++) {
            at = locate(st, effort, at, found);
            if (at <= 0.0) break;
            step = attempt(st, effort, at);
            enum Event other = event(st->mode, &step);
            if (other == NONE || other == found) break;
            found = other;
        }
        step = attempt(st, effort, at);
        commit(st, &step, found == REVERSAL && at > 0.0);
        left -= at;
        if (left <= 2.220446049250313e-16 * DT) left = 0.0;
        change(st, found);
    }
}

/* What runs from step to step stays in registers until something happens. */
static __attribute__((noinline)) size_t sticking(State *st, const double *restrict effort, size_t k,
    size_t samples, double *restrict position, double *restrict velocity)
{
    double x = st->x, v = st->v, force = st->force;
    double at = st->at, slope = st->slope, hardening = st->hardening;
    double way = st->way, per_distance = st->per_distance, target = st->target;
    int since = st->since;
    for (; k < samples; k++) {
        Step step = stick(st, x, v, at, force, slope, hardening, way, per_distance, target, since,
            effort[k], DT);
        if (UNLIKELY(!step.plain) || event(0.0, &step) != NONE) break;
        position[k] = x = step.x;
        velocity[k] = v = step.v;
        at = step.at;
        force = step.force;
        slope = step.slope;
        hardening = step.hardening;
        since++;
    }
    st->x = x;
    st->v = v;
    st->force = force;
    st->at = at;
    st->slope = slope;
    st->hardening = hardening;
    st->since = since;
    return k;
}

static __attribute__((noinline)) size_t sliding(State *st, const double *restrict effort, size_t k,
    size_t samples, double *restrict position, double *restrict velocity)
{
    double x = st->x, v = st->v, force = st->force, mode = st->mode, latched = st->latched;
    for (; k < samples; k++) {
        Step step = slip(x, v, force, mode, latched, effort[k], DT);
        if (event(mode, &step) != NONE) break;
        position[k] = x = step.x;
        velocity[k] = v = step.v;
        force = step.force;
    }
    st->x = x;
    st->v = v;
    st->force = force;
    return k;
}

#ifdef HSIEH_PAN_DIRECT
void hsieh_pan_direct
#else
void hsieh_pan
#endif
(const double *restrict effort, size_t samples, double *restrict position,
    double *restrict velocity, long counted[2])
{
    static State states[1];
    State *st = states;
    *st = (State){0};
    st->slope = K_0;
    st->per_distance = 2.0 * PER_D_0;
    st->target = INFINITY;
    for (size_t k = 0; k < samples; k++) {
        k = (st->mode == 0.0 ? sticking : sliding)(st, effort, k, samples, position, velocity);
        if (k == samples) break;
        through_events(st, effort[k]);
        position[k] = st->x;
        velocity[k] = st->v;
    }
    counted[0] = st->breakaways;
    counted[1] = st->sticks;
}
