/* A linear spring behind a slider: Fredriksson, Comput. Struct. 6 (1976); Curnier, Int. J. Solids
 * Struct. 20 (1984). */
#include "slip_hardening.c"
#let SLIDING = COULOMB
#define EXCHANGES
#let STIFFEST = INITIAL_STIFFNESS
#let CALMS = VISCOUS
typedef struct {
    STICTION_REAL force;
    STICTION_REAL slid;
} stiction_law;
#if LACKING != 0

/* How far the slider goes that the spring pulls with so much above its level: Newton on
 * R*(1 - exp(-w)) + k*k_0*w = over, which comes from the left. */
static real slip(real slid, real over)
{
    const real rise = LACKING * r_exp(-slid / HARDENING_DISTANCE);
    const real spring = INITIAL_STIFFNESS * HARDENING_DISTANCE;
    real w = (over - rise) / spring;
    int k;
    if (w < R(0)) {
        w = R(0);
    }
    for (k = 0; k < 120; ++k) {
        const real faded = r_expm1(-w);
        const real step = (over + rise * faded - spring * w) / (rise * (R(1) + faded) + spring);
        w += step;
        if (r_fabs(step) <= R(2) * EPSILON * w) {
            break;
        }
    }
    return w * HARDENING_DISTANCE;
}
#endif

static real law_step(stiction_state *s, const motion *m)
{
    const real pull = s->law.force + INITIAL_STIFFNESS * m->displacement;
    const real level = hardened_level(s->law.slid);
    if (r_fabs(pull) <= level) {
        s->law.force = pull;
        return pull * LEVEL;
    }
#if LACKING != 0
    s->law.slid += slip(s->law.slid, r_fabs(pull) - level);
#endif
    s->law.force = (pull > R(0) ? R(1) : R(-1)) * hardened_level(s->law.slid);
    return s->law.force * LEVEL;
}
#ifdef MACHINE

/* Direction in which the slider slides. */
static int slides(const stiction_law *law)
{
    const real level = hardened_level(law->slid);
    return law->force >= level ? 1 : law->force <= -level ? -1 : 0;
}

/* Whether the slider began to slide. */
static int law_breaks(const stiction_law *before, const stiction_law *after)
{
    const int was = slides(before), is = slides(after);
    return is != 0 && is != was;
}
#endif
