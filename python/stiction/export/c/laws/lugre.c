/* z' = v - s0*|v|*z/g(v), F = s0*z + s1(v)*z': Canudas de Wit, Olsson, Astroem, Lischinsky, IEEE
 * Trans. Autom. Control 40 (1995); solved over a step in which the velocity is held. */
#include "sliding_level.c"
#include "bristle_damping.c"
#ifdef MACHINE
#include "lagging.c"
#endif
#let SLIDING = BREAKAWAY
#define EXCHANGES
#define BENDS
#let STIFFEST = 2 * INITIAL_STIFFNESS
#let CALMS = DAMPING + VISCOUS
#let FALLS_BY = EXCESS
typedef struct {
    STICTION_REAL force; /* s0*z */
} stiction_law;

static real law_step(stiction_state *s, const motion *m)
{
    const real level = sliding_level(m->velocity);
#ifdef MACHINE
    /* Towards a level that changes with the velocity. */
    const real from = sliding_level(m->start), side = m->displacement > R(0) ? R(1) : R(-1);
    const real path = INITIAL_STIFFNESS * r_fabs(m->displacement);
    real along;
    s->law.force = side * lagging(side * s->law.force, from, level,
                                  path * (R(0.5) / from + R(0.5) / level));
#else
    const real way = INITIAL_STIFFNESS * r_fabs(m->displacement) / level;
    const real goal = m->displacement > R(0) ? level : -level;
    real along;
    s->law.force += (goal - s->law.force) * -r_expm1(-way);
#endif
    along = m->velocity > R(0) ? s->law.force : -s->law.force;
    return (s->law.force + bristle_damping(m->velocity, along / level)) * LEVEL;
}
#ifdef MACHINE

/* Rate at which the bristles bend, as a force. */
static real law_rate(real force, real velocity)
{
    return INITIAL_STIFFNESS * (velocity - r_fabs(velocity) * force / sliding_level(velocity));
}
#endif
