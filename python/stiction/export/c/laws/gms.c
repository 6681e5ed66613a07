/* Eight elements, each a spring until it reaches its share of a level that falls with speed, drawn
 * to that while it slips, no faster than its spring: Al-Bender, Lampaert, Swevers, IEEE Trans.
 * Autom. Control 50 (2005). */
#let FREE = [-log(1 - (i + 0.5) / 8) / (1 - YIELD_SHAPE) for i in range(8)]
#let YIELD = [w if YIELD_SHAPE == 0 else -expm1(-YIELD_SHAPE * w) / YIELD_SHAPE for w in FREE]
#let SHARE = [y / sum(YIELD) for y in YIELD]
#let ONE_STIFFNESS = INITIAL_STIFFNESS / 8
#include "sliding_level.c"
#ifdef MACHINE
#include "lagging.c"
#endif
#let SLIDING = BREAKAWAY
#let STIFFEST = INITIAL_STIFFNESS
#let CALMS = VISCOUS
#let FALLS_BY = EXCESS
typedef struct {
    STICTION_REAL force[8];
    signed char slips[8]; /* 0 sticks, +1 and -1 slip in that direction */
} stiction_law;

static real law_step(stiction_state *s, const motion *m)
{
    const int side = m->displacement > R(0) ? 1 : -1;
    const real to = sliding_level(m->velocity);
#ifdef MACHINE
    const real from = sliding_level(m->start), level = R(0.5) * (from + to);
#else
    const real level = to;
#endif
    const real reach = ONE_STIFFNESS * r_fabs(m->displacement);
    /* How far below its level an element gains as fast as its spring. */
    const real shortfall = SPEED * ONE_STIFFNESS * level / ATTRACTION;
    const real way = ATTRACTION * m->dt / level;
#ifdef MACHINE
#else
    const real whole = r_exp(-way);
#endif
    real sum = R(0);
    int i;
    for (i = 0; i < 8; ++i) {
        if (m->displacement != R(0)) {
            const real along = (real)side * s->law.force[i], most = along + reach;
            const int slipped = s->law.slips[i] == side;
#ifdef MACHINE
            const real target = SHARE[i] * from, moves = SHARE[i] * (to - from);
            const real leaves = slipped ? SHARE[i] * level - shortfall : target;
            const real speed = slipped ? reach : reach - moves;
#else
            const real target = SHARE[i] * level;
            const real leaves = slipped ? target - shortfall : target;
#endif
            real gone = R(0), at = along, end = most;
            if (leaves > along) {
#ifdef MACHINE
                gone = (leaves - along) / speed;
                at = slipped ? leaves : along + reach * gone;
                gone = gone > R(0) ? gone : R(2);
#else
                gone = (leaves - along) / reach;
                at = slipped ? leaves : along + reach * gone;
#endif
            }
            s->law.slips[i] = (signed char)(slipped ? side : 0);
            if (slipped ? gone < R(1) : gone <= R(1)) {
#ifdef MACHINE
                const real drawn = lagging(at, target + moves * gone, target + moves,
                                           way * (R(1) - gone));
#else
                const real left = gone == R(0) ? whole : r_exp(-way * (R(1) - gone));
                const real drawn = target + (at - target) * left;
#endif
                end = drawn > most ? most : drawn;
                s->law.slips[i] = (signed char)side;
            }
            s->law.force[i] = (real)side * end;
        }
        sum += s->law.force[i];
    }
    return sum * LEVEL;
}
