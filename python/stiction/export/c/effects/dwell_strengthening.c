/* Friction that grows while the contact rests: Rabinowicz, Proc. Phys. Soc. 71 (1958). */
#include "contact_age.c"
typedef struct {
    STICTION_REAL offset, strength;
} stiction_dwell_strengthening;

static real dwell_strengthening_level(const stiction_state *s, const motion *m)
{
    (void)m;
    return dwell_strengthening_STRENGTH * s->dwell_strengthening.strength;
}

static void dwell_strengthening_remember(stiction_state *s, const motion *m)
{
    stiction_dwell_strengthening *own = &s->dwell_strengthening;
    const real way = slid(&own->offset, m->displacement, dwell_strengthening_WINDOW);
    if (way == R(0)) {
        own->strength += (own->strength - R(1)) * r_expm1(-m->dt / dwell_strengthening_TIME);
    } else {
        own->strength *= r_exp(-way / dwell_strengthening_DISTANCE);
    }
}
