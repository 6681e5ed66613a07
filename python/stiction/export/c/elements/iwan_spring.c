#define CLOSES_AT_MIRROR
/* Branches are twice the first loading (Masing). */
#define virgin(spring, way) loading(way)
#define branch(spring, direction, way) (R(2) * loading(R(0.5) * (way)))
#include "walk.c"
typedef stiction_spring stiction_law;

static real law_step(stiction_state *s, const motion *m)
{
    const walked end = walk(&s->law, m->displacement);
    accept(&s->law, &end);
    return s->law.force * LEVEL;
}
