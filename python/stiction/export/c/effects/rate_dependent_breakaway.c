/* Break-away that falls the faster the contact is loaded: Johannes, Green, Brockley, Wear 24
 * (1973). */
#include "contact_age.c"
typedef struct {
    STICTION_REAL offset, filtered, strength;
} stiction_rate_dependent_breakaway;

static void rate_dependent_breakaway_init(stiction_state *s)
{
    s->rate_dependent_breakaway.strength = R(1);
}

static real rate_dependent_breakaway_level(const stiction_state *s, const motion *m)
{
    (void)m;
    return rate_dependent_breakaway_STRENGTH * s->rate_dependent_breakaway.strength;
}

static void rate_dependent_breakaway_remember(stiction_state *s, const motion *m)
{
    stiction_rate_dependent_breakaway *own = &s->rate_dependent_breakaway;
    const real way = slid(&own->offset, m->displacement, rate_dependent_breakaway_WINDOW);
    const real missing = s->friction - own->filtered;
    own->filtered -= missing * r_expm1(-m->dt / rate_dependent_breakaway_LOADING_TIME);
    if (way == R(0)) {
        const real slow = r_exp(-r_fabs(missing) / (rate_dependent_breakaway_LOADING_TIME
                                                    * rate_dependent_breakaway_LOADING_RATE));
        own->strength -= (slow - own->strength) * r_expm1(-m->dt / R(0.02));
    } else {
        own->strength *= r_exp(-way / rate_dependent_breakaway_DISTANCE);
    }
}
