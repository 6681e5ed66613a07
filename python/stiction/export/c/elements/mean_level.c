#include "sliding_level.c"
/* g over a step: of the velocity that is held, or the mean of both ends. */
static real mean_level(const motion *m)
{
#ifdef MACHINE
    return R(0.5) * (sliding_level(m->start) + sliding_level(m->velocity));
#else
    return sliding_level(m->velocity);
#endif
}
