/* z' = v - s0*|v|*z/g(v), F = s0*z + s1(v)*z': Canudas de Wit, Olsson, Astroem, Lischinsky, IEEE
 * Trans. Autom. Control 40 (1995); solved over a step in which the velocity is held. */
#include "sliding_level.c"
#include "bristle_damping.c"
#let SLIDING = BREAKAWAY
typedef struct {
    STICTION_REAL force; /* s0*z */
} stiction_law;

static real law_step(stiction_state *s, const motion *m)
{
    const real level = sliding_level(m->velocity);
    const real way = INITIAL_STIFFNESS * r_fabs(m->displacement) / level;
    const real goal = m->displacement > R(0) ? level : -level;
    real along;
    s->law.force += (goal - s->law.force) * -r_expm1(-way);
    along = m->velocity > R(0) ? s->law.force : -s->law.force;
    return (s->law.force + bristle_damping(m->velocity, along / level)) * LEVEL;
}
