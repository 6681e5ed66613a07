/* dF/dx = k*|1 - F/F_c*sgn v|^i*sgn(1 - F/F_c*sgn v), solved over any displacement one way: Dahl,
 * AIAA J. 14 (1976). */
#if EXPONENT != 2 and EXPONENT != 1
#include "logarithmic_mean.c"
#endif
#let SLIDING = COULOMB
#define EXCHANGES
#let STIFFEST = INITIAL_STIFFNESS * 2**EXPONENT
#let CALMS = VISCOUS
typedef struct {
    STICTION_REAL force;
} stiction_law;

static real law_step(stiction_state *s, const motion *m)
{
    const real side = m->displacement > R(0) ? R(1) : R(-1);
    const real left = R(1) - side * s->law.force / COULOMB;
    real pace = INITIAL_STIFFNESS / COULOMB * r_fabs(m->displacement);
    real gone;
    if (left == R(0) || pace == R(0)) {
        return s->law.force * LEVEL;
    }
#if EXPONENT == 2
    pace *= r_fabs(left);
    gone = pace / (R(1) + pace);
#else
#if EXPONENT == 1
    gone = -r_expm1(-pace);
#else
    pace *= r_pow(r_fabs(left), EXPONENT - R(1));
    gone = (R(1) - EXPONENT) * pace >= R(1)
        ? R(1) : -r_expm1(-pace * logarithmic_mean((R(1) - EXPONENT) * pace));
#endif
#endif
    s->law.force += COULOMB * side * left * gone;
    return s->law.force * LEVEL;
}
