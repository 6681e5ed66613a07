/* Friction that falls with speed: Bo, Pavelescu, Wear 82 (1982). */
static real stribeck_level(const stiction_state *s, const motion *m)
{
    const real share = r_fabs(m->velocity / stribeck_VELOCITY);
    (void)s;
#if stribeck_EXPONENT == 2
    return stribeck_EXCESS * r_exp(-share * share);
#else
    return stribeck_EXCESS * r_exp(-r_pow(share, stribeck_EXPONENT));
#endif
}
