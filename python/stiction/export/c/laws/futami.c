/* A spring that is linear up to x_1, gives way up to x_2 and rolls beyond: Futami, Furutani,
 * Yoshida, Nanotechnology 1 (1990). */
#let LINEAR = LINEAR_SHARE * COULOMB / INITIAL_STIFFNESS
#let BEND = (1 - LINEAR_SHARE) * CURVE_EXPONENT * COULOMB / INITIAL_STIFFNESS
#let SLIDING = COULOMB
#define EXCHANGES
#let STIFFEST = INITIAL_STIFFNESS
#let CALMS = VISCOUS

static real loading(real x)
{
    const real left = R(1) - (x - LINEAR) / BEND;
    if (x <= LINEAR) {
        return INITIAL_STIFFNESS * x;
    }
    if (left <= R(0)) {
        return COULOMB;
    }
    return COULOMB * (R(1) - (R(1) - LINEAR_SHARE) * r_pow(left, CURVE_EXPONENT));
}
#include "iwan_spring.c"
