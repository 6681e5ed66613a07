/* A share of friction that builds up after each reversal, over four elements that stick and slide:
 * Iwan, J. Appl. Mech. 33 (1966). */
#include "held.c"
#if SLIDING < inf
#let reverse_point_memory_STIFFNESS = reverse_point_memory_SHARE * SLIDING * 2 \
             / reverse_point_memory_DISTANCE
#endif
#let YIELD_AT = [reverse_point_memory_DISTANCE * share for share in (0.2, 0.6, 1.2, 2.0)]
typedef struct {
    STICTION_REAL stretch[4];
} stiction_reverse_point_memory;

static real reverse_point_memory_level(const stiction_state *s, const motion *m)
{
    (void)s;
    (void)m;
    return -reverse_point_memory_SHARE;
}

static void reverse_point_memory_remember(stiction_state *s, const motion *m)
{
    real *stretch = s->reverse_point_memory.stretch;
    int k;
    for (k = 0; k < 4; ++k) {
        stretch[k] = held(stretch[k] + m->displacement, YIELD_AT[k]);
    }
}
#if SLIDING < inf

static real reverse_point_memory_effort(const stiction_state *s, const motion *m)
{
    real mean = R(0);
    int k;
    for (k = 0; k < 4; ++k) {
#ifdef MACHINE
        mean += held(s->reverse_point_memory.stretch[k] + s->moved, YIELD_AT[k]) / YIELD_AT[k];
#else
        mean += s->reverse_point_memory.stretch[k] / YIELD_AT[k];
#endif
    }
    (void)m;
    return -reverse_point_memory_SHARE * SLIDING * mean / R(4);
}
#endif
