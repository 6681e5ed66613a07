/* Elastic-linear-hardening elements in parallel: Prager, Proc. Inst. Mech. Eng. 169 (1955); Iwan
 * (1966); Hodge (1957) on the rules of hardening. */
#let FIRST = [COULOMB / 4 * (1 + YIELD_SPREAD * (2 * i / 3 - 1)) for i in range(4)]
#let SLIDING = COULOMB
#define EXCHANGES
#let STIFFEST = INITIAL_STIFFNESS
#let CALMS = VISCOUS
typedef struct {
    STICTION_REAL force, upper, lower; /* by how much its yield points were moved */
} stiction_element;
typedef struct {
    stiction_element element[4];
} stiction_law;

static real law_step(stiction_state *s, const motion *m)
{
    const real pull = INITIAL_STIFFNESS * m->displacement / R(4);
    real force = R(0);
    int i;
    for (i = 0; i < 4; ++i) {
        const real at = s->law.element[i].force + pull;
        const real above = at - FIRST[i] - s->law.element[i].upper;
        const real below = at + FIRST[i] - s->law.element[i].lower;
        s->law.element[i].force = at;
        if (above > R(0)) {
            s->law.element[i].upper += HARDENING_SHARE * above;
#if HARDENING == 'kinematic'
            s->law.element[i].lower += HARDENING_SHARE * above;
#endif
#if HARDENING == 'isotropic'
            s->law.element[i].lower -= HARDENING_SHARE * above;
#endif
            s->law.element[i].force = s->law.element[i].upper + FIRST[i];
        } else if (below < R(0)) {
            s->law.element[i].lower += HARDENING_SHARE * below;
#if HARDENING == 'kinematic'
            s->law.element[i].upper += HARDENING_SHARE * below;
#endif
#if HARDENING == 'isotropic'
            s->law.element[i].upper -= HARDENING_SHARE * below;
#endif
            s->law.element[i].force = s->law.element[i].lower - FIRST[i];
        }
        force += s->law.element[i].force;
    }
    return force * LEVEL;
}
#ifdef MACHINE

/* Direction in which an element yields. */
static int yields(const stiction_law *law, int i)
{
    const real force = law->element[i].force;
    return force == law->element[i].upper + FIRST[i] ? 1
        : force == law->element[i].lower - FIRST[i] ? -1 : 0;
}

/* Whether an element began to yield. */
static int law_breaks(const stiction_law *before, const stiction_law *after)
{
    int i;
    for (i = 0; i < 4; ++i) {
        const int is = yields(after, i);
        if (is != 0 && is != yields(before, i)) {
            return 1;
        }
    }
    return 0;
}
#endif
