/* Friction of a gear that is loaded from both sides: Duclusaud, Passault, Padois, Ly, Extended
 * Friction Models for the Physics Simulation of Servo Actuators (2025), models M1 to M6. */
#let REST = BREAKAWAY - COULOMB
#let FALLS = any([REST, DRIVE_STRIBECK, BACK_DRIVE_STRIBECK, DRIVE_QUADRATIC, BACK_DRIVE_QUADRATIC])
#include "held.c"
#let SLIDING = BREAKAWAY
#define EXCHANGES
#define RIGID
#let STIFFEST = 0
#let CALMS = VISCOUS
#let FALLS_BY = REST + (DRIVE_STRIBECK + BACK_DRIVE_STRIBECK) * BREAKAWAY

static real law_step(stiction_state *s, const motion *m)
{
    const real motor = m->effort - m->load;
    real level = COULOMB + r_fabs(DRIVE * motor - BACK_DRIVE * m->load);
#if FALLS
    real excess = REST + r_fabs(DRIVE_STRIBECK * motor - BACK_DRIVE_STRIBECK * m->load);
    if (motor * m->load < R(0)) {
        excess += r_fabs(m->load) <= r_fabs(motor) ? DRIVE_QUADRATIC * m->load * m->load
                                                   : BACK_DRIVE_QUADRATIC * motor * motor;
    }
    if (m->velocity == R(0)) {
        level += excess;
    } else {
        const real share = r_fabs(m->velocity / STRIBECK_VELOCITY);
#if STRIBECK_EXPONENT == 2
        level += excess * r_exp(-share * share);
#else
        level += excess * r_exp(-r_pow(share, STRIBECK_EXPONENT));
#endif
    }
#endif
    (void)s;
    if (m->velocity == R(0)) {
        return held(m->effort, level * LEVEL);
    }
    return (m->velocity > R(0) ? level : -level) * LEVEL;
}
