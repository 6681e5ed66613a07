/* True stick, and a level that hardens with the way slid: Fredriksson, Comput. Struct. 6 (1976). */
#include "held.c"
#include "slip_hardening.c"
#let SLIDING = COULOMB
#define EXCHANGES
#define RIGID
#let STIFFEST = 0
#let CALMS = VISCOUS
typedef struct {
    STICTION_REAL slid;
} stiction_law;

static real law_step(stiction_state *s, const motion *m)
{
    if (m->velocity == R(0)) {
        return held(m->effort, hardened_level(s->law.slid) * LEVEL);
    }
    s->law.slid += r_fabs(m->displacement);
    return (m->velocity > R(0) ? R(1) : R(-1)) * hardened_level(s->law.slid) * LEVEL;
}
