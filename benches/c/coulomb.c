/* One trajectory of a body on dry friction with true stick and a Stribeck fall, as fast as plain C gets:
 * see hsieh_pan.c. The same step as the core's, one to a sample; where the body comes to rest is located
 * inside the step.
 */
#include <math.h>
#include <stddef.h>

#include "exponential.h"
#include "reference.h"

#define F_S 0.5
#define F_C (0.7 * F_S)
#define V_S 0.1

#define PER_INERTIA (1.0 / INERTIA)
#define MOST_EVENTS 16
#define UNLIKELY(c) __builtin_expect(!!(c), 0)
#define INLINE static inline __attribute__((always_inline))
#define COLD static __attribute__((noinline))

typedef struct {
    double x, v, mode;
    long breakaways, sticks;
} State;

INLINE double sign(double x)
{
    return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0;
}

INLINE double fall(double v)
{
    double share = v * (1.0 / V_S);
    return fading(-(share * share));
}

/* Velocity after a slide of this duration; the falling flank is implicit where it damps: behind a
 * velocity that has turned round. */
INLINE double slide(double v, double mode, double effort, double span, double *displacement)
{
    double half = 0.5 * span, net = effort - (F_C + (F_S - F_C) * fall(v)) * mode;
    double predicted = v + (span * PER_INERTIA) * net, left = fall(predicted);
    double force = (F_C + (F_S - F_C) * left) * mode;
    *displacement = span * v + (span * half * PER_INERTIA) * net;
    double unbraked = v + (half * PER_INERTIA) * (net + effort);
    if (UNLIKELY(mode * predicted < 0.0)) {
        double damping = (F_S - F_C) * left * 2.0 * fabs(predicted) * (1.0 / (V_S * V_S));
        return (INERTIA * unbraked - half * (force - damping * predicted)) / (INERTIA + half * damping);
    }
    return unbraked - (half * PER_INERTIA) * force;
}

COLD double after(const State *st, double effort, double span, double *displacement)
{
    return slide(st->v, st->mode, effort, span, displacement);
}

/* When a slide comes to rest, by the Illinois rule and two Newton steps. */
COLD double locate(const State *st, double effort, double span)
{
    double unused, low = 0.0, high = span, at_low = st->mode * st->v;
    double at_high = st->mode * after(st, effort, span, &unused), tolerance = 1e-15 * span;
    if (at_low <= 0.0) return 0.0;
    if (at_high >= 0.0) return span;
    int side = 0;
    for (int k = 0; k < 100 && high - low > tolerance; k++) {
        double secant = (low * at_high - high * at_low) / (at_high - at_low);
        double middle = secant > low && secant < high ? secant : 0.5 * (low + high);
        double there = st->mode * after(st, effort, middle, &unused);
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
    double slope = st->mode * (after(st, effort, root + width, &unused)
        - after(st, effort, root - width, &unused)) / (2.0 * width);
    if (slope < 0.0) {
        for (int k = 0; k < 2; k++) at -= st->mode * after(st, effort, at, &unused) / slope;
    }
    return fmin(fmax(at, 0.0), span);
}

/* A step with all that may happen in it. */
COLD void through_events(State *st, double effort)
{
    double left = DT;
    for (int passed = 0; passed < MOST_EVENTS; passed++) {
        if (st->mode == 0.0) {
            if (fabs(effort) <= F_S) return;
            st->mode = sign(effort);
            st->breakaways++;
        }
        double displacement, at = left, v = after(st, effort, left, &displacement);
        int stops = st->mode * v <= 0.0;
        if (stops) {
            at = locate(st, effort, left);
            v = after(st, effort, at, &displacement);
        }
        st->x += displacement;
        st->v = stops && at > 0.0 ? 0.0 : v;
        if (!stops) return;
        st->mode = 0.0;
        st->sticks++;
        left -= at;
        if (left <= 2.220446049250313e-16 * DT) left = 0.0;
    }
}

void coulomb(const double *restrict effort, size_t samples, double *restrict position,
    double *restrict velocity, long counted[2])
{
    State st = {0};
    for (size_t k = 0; k < samples; k++) {
        if (st.mode == 0.0) {
            for (; k < samples && fabs(effort[k]) <= F_S; k++) {
                position[k] = st.x;
                velocity[k] = 0.0;
            }
        } else {
            double x = st.x, v = st.v, mode = st.mode;
            for (; k < samples; k++) {
                double displacement, next = slide(v, mode, effort[k], DT, &displacement);
                if (UNLIKELY(mode * next <= 0.0)) break;
                position[k] = x += displacement;
                velocity[k] = v = next;
            }
            st.x = x;
            st.v = v;
        }
        if (k == samples) break;
        through_events(&st, effort[k]);
        position[k] = st.x;
        velocity[k] = st.v;
    }
    counted[0] = st.breakaways;
    counted[1] = st.sticks;
}
