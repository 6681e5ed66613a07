/* LuGre's bristles that slip from a share of F_c on alone: Dupont, Hayward, Armstrong, Altpeter,
 * IEEE Trans. Autom. Control 47 (2002). */
#let ELASTIC = ELASTIC_SHARE * COULOMB
#include "mean_level.c"
#include "bristle_damping.c"
#let SLIDING = BREAKAWAY
#define EXCHANGES
#define BENDS
#let STIFFEST = INITIAL_STIFFNESS
#let CALMS = DAMPING + VISCOUS
#let FALLS_BY = EXCESS
typedef struct {
    STICTION_REAL force; /* s0*z */
} stiction_law;

/* The share of a motion that slips where bristles bear this force along it. */
static real slipping(real along, real level)
{
    real left;
    if (along <= ELASTIC) {
        return R(0);
    }
    if (along >= level) {
        return along / level;
    }
    left = (level - along) / (level - ELASTIC);
    return R(0.5) * (R(1) + r_cos(PI * left)) * (along / level);
}

/* Of r = 1 - s0*z/g; one less the share that slips is the square of a sine. */
static real rate(real r, const real *of)
{
    const real sine = r_sin(r / of[0] * (R(0.5) * PI));
    return sine * sine / r + (R(1) - sine * sine);
}
#include "approach.c"

/* Force along the motion after a path s0*|x|. */
static real followed(real along, real path, real level)
{
    real whole, steep;
    if (along < ELASTIC) {
        if (path <= ELASTIC - along) {
            return along + path;
        }
        path -= ELASTIC - along;
        along = ELASTIC;
    }
    if (along >= level) {
        return level + (along - level) * r_exp(-path / level);
    }
    whole = R(1) - ELASTIC / level;
    steep = R(0.5) * PI / whole;
    return level * (R(1) - approach(R(1) - along / level, path / level, steep * steep, &whole));
}

static real law_step(stiction_state *s, const motion *m)
{
    const real side = m->displacement > R(0) ? R(1) : R(-1);
    const real level = sliding_level(m->velocity);
    real along;
    if (m->displacement != R(0)) {
        const real path = INITIAL_STIFFNESS * r_fabs(m->displacement);
        s->law.force = side * followed(side * s->law.force, path, mean_level(m));
    }
    if (m->velocity == R(0)) {
        return s->law.force * LEVEL;
    }
    along = m->velocity > R(0) ? s->law.force : -s->law.force;
    return (s->law.force + bristle_damping(m->velocity, slipping(along, level))) * LEVEL;
}
#ifdef MACHINE

/* Rate at which the bristles bend, as a force. */
static real law_rate(real force, real velocity)
{
    const real along = velocity < R(0) ? -force : force;
    return INITIAL_STIFFNESS * velocity * (R(1) - slipping(along, sliding_level(velocity)));
}
#endif
