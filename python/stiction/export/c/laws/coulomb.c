/* Dry friction with true stick. */
#include "held.c"
#include "sliding_level.c"
#let SLIDING = BREAKAWAY
#define EXCHANGES
#define RIGID
#let STIFFEST = 0
#let CALMS = VISCOUS
#let FALLS_BY = EXCESS

static real law_step(stiction_state *s, const motion *m)
{
    (void)s;
    if (m->velocity == R(0)) {
        return held(m->effort, BREAKAWAY * LEVEL);
    }
    return (m->velocity > R(0) ? R(1) : R(-1)) * sliding_level(m->velocity) * LEVEL;
}
