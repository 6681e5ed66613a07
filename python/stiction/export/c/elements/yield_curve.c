#let EDGE = [0, 0.25, 0.5, 1, 2, 3]
#let YIELDED = [-expm1(-y * logarithmic_mean(SHAPE * y)) if SHAPE * y < 1 else 1.0 for y in EDGE]
#let STICKING = [(1 - v) / (1 - SHAPE * y) if SHAPE * y < 1 else 0.0 for y, v in zip(EDGE, YIELDED)]
#let UP_TO = YIELDED[1:] + [1.0]
#let BEYOND = STICKING[1:] + [0.0]
#let WIDTH = [EDGE[k + 1] - EDGE[k] if k < 5 else 0.0 for k in range(6)]
#let LATER = [sum(WEIGHT[j] * (STICKING[j] - BEYOND[j]) for j in range(k, 6)) for k in range(7)]
#let SLOPE = [LATER[k + 1] - WEIGHT[k] * BEYOND[k] for k in range(6)]
#let RISE = [WEIGHT[k] * (UP_TO[k] - YIELDED[k]) + SLOPE[k] * WIDTH[k] for k in range(6)]
#let OFFSET = [sum(RISE[:k]) - WEIGHT[k] * YIELDED[k] for k in range(6)]
#let SCALE = TOP / sum(RISE)
#let PER_WAY = STEEPEST / (SCALE * LATER[0])
#let EVEN = all(weight == 1 for weight in WEIGHT)
#if SHAPE != 0
#include "logarithmic_mean.c"
#endif
/* First loading of elasto-slide elements without number (Iwan, J. Appl. Mech. 33 (1966)), that
 * slide at F_c and begin with k_0. */
static real loading(real x)
{
    const real y = x * PER_WAY;
#if SHAPE != 0
    const real left = R(1) - SHAPE * y;
    const real yielded = left <= R(0) ? R(1) : -r_expm1(-y * logarithmic_mean(SHAPE * y));
#else
    const real yielded = -r_expm1(-y);
#endif
#if EVEN
    return TOP * yielded;
#else
    int k = 5;
#if SHAPE != 0
    if (left <= R(0)) {
        return TOP;
    }
#endif
    while (k > 0 && y < EDGE[k]) {
        k -= 1;
    }
    return SCALE * (WEIGHT[k] * yielded + SLOPE[k] * (y - EDGE[k]) + OFFSET[k]);
#endif
}
