#let EXCESS = BREAKAWAY - COULOMB
/* g(v) = F_c + (F_s - F_c)*exp(-|v/v_s|^d): Bo, Pavelescu, Wear 82 (1982). */
static real sliding_level(real velocity)
{
#if EXCESS != 0
    const real share = r_fabs(velocity / STRIBECK_VELOCITY);
#if STRIBECK_EXPONENT == 2
    return COULOMB + EXCESS * r_exp(-share * share);
#else
    return COULOMB + EXCESS * r_exp(-r_pow(share, STRIBECK_EXPONENT));
#endif
#else
    (void)velocity;
    return COULOMB;
#endif
}
