/* Ten stops of evenly spaced thresholds, weighted by an exponential density: Krasnosel'skii,
 * Pokrovskii, Systems with Hysteresis (1989); Al Janaideh, Rakheja, Su (2009). */
#let PLACE = [(j + 0.5) / 10 for j in range(10)]
#let DENSITY = [exp(-DENSITY_DECAY * place) for place in PLACE]
#let MOMENT = sum(share * place for share, place in zip(DENSITY, PLACE))
#let WIDEST = COULOMB / INITIAL_STIFFNESS * sum(DENSITY) / MOMENT
#let THRESHOLD = [WIDEST * place for place in PLACE]
#let WEIGHT = [INITIAL_STIFFNESS * share / sum(DENSITY) for share in DENSITY]
#include "held.c"
#let SLIDING = COULOMB
#define EXCHANGES
#let STIFFEST = INITIAL_STIFFNESS
#let CALMS = VISCOUS
typedef struct {
    STICTION_REAL stretch[10];
} stiction_law;

static real law_step(stiction_state *s, const motion *m)
{
    real force = R(0);
    int j;
    for (j = 0; j < 10; ++j) {
        s->law.stretch[j] = held(s->law.stretch[j] + m->displacement, THRESHOLD[j]);
        force += WEIGHT[j] * s->law.stretch[j];
    }
    return force * LEVEL;
}
#ifdef MACHINE

/* Whether a stop began to slide. */
static int law_breaks(const stiction_law *before, const stiction_law *after)
{
    int j;
    for (j = 0; j < 10; ++j) {
        if (r_fabs(after->stretch[j]) == THRESHOLD[j]
            && after->stretch[j] != before->stretch[j]) {
            return 1;
        }
    }
    return 0;
}
#endif
