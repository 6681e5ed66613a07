#define DRAGGED_ALONG
typedef struct {
    STICTION_REAL stretch;
    int mode; /* 0 holds, +1 and -1 are dragged in that direction */
} stiction_law;

/* A damped spring that holds up to LIMIT and is dragged along with DRAGGED until motion turns. */
static real law_step(stiction_state *s, const motion *m)
{
    stiction_law *bond = &s->law;
    if ((real)bond->mode * m->velocity < R(0) || (bond->mode != 0 && m->velocity == R(0))) {
        bond->stretch = LIMIT * (real)bond->mode;
        bond->mode = 0;
    }
    if (bond->mode == 0) {
        const real stretch = bond->stretch + m->displacement;
        if (r_fabs(stretch) <= LIMIT) {
            bond->stretch = stretch;
#if DAMPING != 0
            return INITIAL_STIFFNESS * stretch * LEVEL + DAMPING * m->velocity;
#else
            return INITIAL_STIFFNESS * stretch * LEVEL;
#endif
        }
        bond->mode = stretch > R(0) ? 1 : -1;
        bond->stretch = LIMIT * (real)bond->mode;
    }
    return DRAGGED * (real)bond->mode * LEVEL;
}
#ifdef MACHINE

/* Whether the bond tore. */
static int law_breaks(const stiction_law *before, const stiction_law *after)
{
    return before->mode == 0 && after->mode != 0;
}
#endif
