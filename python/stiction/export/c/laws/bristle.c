/* Twenty bristles that break at a stretch and bond again at the next site, sites being drawn once:
 * Haessig, Friedland, J. Dyn. Syst. Meas. Control 113 (1991). */
#let LIMIT = COULOMB / (INITIAL_STIFFNESS * (0.5 - SCATTER**2 / 12))
#let SEEDED = 'UINT64_C(%d)' % (int(SEED + 0.5) * 0x9E3779B97F4A7C15 % 2**64)
#let SLIDING = COULOMB
#let STIFFEST = INITIAL_STIFFNESS
#let CALMS = VISCOUS
typedef struct {
    STICTION_REAL stretch[20]; /* in limits */
    STICTION_REAL off[20]; /* how far the site of a bond is scattered, in spacings */
    int32_t site[20];
} stiction_law;

/* Evenly distributed over (-1/2, 1/2): splitmix64 of seed, bristle and site. */
static real scattered(int bristle, int32_t site)
{
    uint64_t z;
    if (site == 0) {
        return R(0);
    }
    z = SEEDED + (uint64_t)(bristle + 1) * UINT64_C(0xBF58476D1CE4E5B9)
        + (uint64_t)(int64_t)site * UINT64_C(0x94D049BB133111EB);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    z ^= z >> 31;
    return (real)(z >> 11) * R(1.0 / 9007199254740992.0) - R(0.5);
}

/* Each at its first place of an even spacing. */
static void law_init(stiction_state *s)
{
    int i;
    for (i = 0; i < 20; ++i) {
        s->law.stretch[i] = R(0.5) - (real)(2 * i + 1) / R(40);
    }
}

static real law_step(stiction_state *s, const motion *m)
{
    stiction_law *law = &s->law;
    real sum = R(0);
    int i;
    for (i = 0; i < 20; ++i) {
        real stretch = law->stretch[i] + m->displacement / LIMIT;
        if (r_fabs(stretch) > R(1)) {
            /* To the first site in reach: one of two, for they lie near even spacing. */
            const int side = stretch > R(0) ? 1 : -1;
            const real way = (real)side * (stretch + SCATTER * law->off[i]) - R(1);
            int32_t on = (int32_t)r_ceil(way - R(0.5) * SCATTER);
            real off;
            on = on > 1 ? on : 1;
            off = scattered(i, law->site[i] + side * on);
            if (way - (real)side * SCATTER * off > (real)on) {
                on += 1;
                off = scattered(i, law->site[i] + side * on);
            }
            stretch -= SCATTER * (off - law->off[i]) + (real)(side * on);
            law->site[i] += side * on;
            law->off[i] = off;
        }
        law->stretch[i] = stretch;
        sum += stretch;
    }
    return INITIAL_STIFFNESS * LIMIT / R(20) * sum * LEVEL;
}
