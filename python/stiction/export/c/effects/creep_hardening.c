/* Creep beside the law until it has hardened, which a slide makes new: the plastic module of Hsieh,
 * Pan, Wear 242 (2000). */
#if 0 < SLIDING < inf
typedef struct {
    STICTION_REAL hardening;
} stiction_creep_hardening;

static real creep_hardening_creep(stiction_state *s, const motion *m)
{
    const real share = r_fabs(s->friction) / SLIDING;
    real gained;
    if (share >= R(0.98)) {
        s->creep_hardening.hardening = R(0);
        return R(0);
    }
    gained = creep_hardening_CREEP * r_pow(share, creep_hardening_EXPONENT)
        - s->creep_hardening.hardening;
    if (gained <= R(0)) {
        return R(0);
    }
    gained *= -r_expm1(-creep_hardening_RATE * m->dt);
    s->creep_hardening.hardening += gained;
    return s->friction > R(0) ? gained : -gained;
}
#endif
