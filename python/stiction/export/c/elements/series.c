#include "lagging.c"
/* Rate of creep under the force through the series. */
static real creeping(real hardening, real force)
{
    const real margin = limit(force) - hardening;
    return margin > R(0) ? CREEP_RATE * margin : R(0);
}

/* Force through spring and damper at an instant, T = S + C*(v - side*h'(T)): Newton falls to it. */
static real instant(real spring, real hardening, real velocity)
{
    const real uncrept = spring + DAMPING * velocity, side = uncrept > R(0) ? R(1) : R(-1);
    real force = uncrept;
    int k;
    if (creeping(hardening, force) == R(0)) {
        return force;
    }
    for (k = 0; k < 60; ++k) {
        const real rate = creeping(hardening, force);
        const real rise = rate > R(0) ? limit_slope(force) * CREEP_RATE : R(0);
        const real move = (force - uncrept + DAMPING * rate * side) / (rise * DAMPING + R(1));
        force -= move;
        if (r_fabs(move) <= R(4) * EPSILON * r_fabs(uncrept)) {
            break;
        }
    }
    return force;
}

/* Spring and damper side by side, in series with the plastic module: the force at the end of a step
 * by Newton within a bracket, the limit of hardening being linear over the step. */
static void creep_in_series(const stiction_law *law, const motion *m, real span, tried *end)
{
    const real way = WAY(span), z = CREEP_RATE * span, start = law->hardening;
    const real from = limit(instant(law->spring.force, start, m->velocity));
    const real uncrept = walk(&law->spring, way).force + DAMPING * m->velocity;
    const real side = uncrept > R(0) ? R(1) : uncrept < R(0) ? R(-1) : R(0);
    const real eased = lagging(start, from, R(0), z) - start;
    const int past_zero = eased > R(0) && side
        * (walk(&law->spring, way - eased * side).force + DAMPING * m->velocity) < R(0);
    real force = uncrept, low = R(0), high = r_fabs(uncrept), gain;
    const real rounding = R(4) * EPSILON * high; /* of the terms of the miss */
    int k, settled = 0;
    for (k = 0;; ++k) {
        const real most = limit(force), mean = first_mean(z);
        real gain_slope, rate, value, rise, miss, next;
        gain = lagging(start, past_zero ? most : from, most, z) - start;
        gain_slope = limit_slope(force) * (past_zero ? z * mean : R(1) - mean);
        if (gain <= R(0)) {
            gain = R(0);
            gain_slope = R(0);
        }
        end->walk = walk(&law->spring, way - gain * side);
        if (settled || k == 60) {
            break;
        }
        rate = creeping(start + gain, force);
        value = end->walk.force + DAMPING * (m->velocity - rate * side);
        rise = R(1) + gain_slope * virgin_slope(end->walk.kept + end->walk.turned == 0
                                                ? end->walk.way : end->walk.way / TWICE);
        if (rate > R(0)) {
            rise += DAMPING * CREEP_RATE * (limit_slope(force) - gain_slope);
        }
        miss = force - value;
        if (miss * side > R(0)) {
            high = r_fabs(force) < high ? r_fabs(force) : high;
        } else {
            low = r_fabs(force) > low ? r_fabs(force) : low;
        }
        next = side * (force - miss / rise);
        settled = r_fabs(miss) <= rounding || side == R(0);
        force = side * (next >= low && next <= high ? next : R(0.5) * (low + high));
    }
    end->series = force;
    end->hardening = start + gain;
}
