#let LACKING = COULOMB * (1 - UNHARDENED_SHARE)
/* Level of sliding after a way slid: F_c*(1 - (1 - h)*exp(-k/k_0)). */
static real hardened_level(real slid)
{
#if LACKING != 0
    return COULOMB - LACKING * r_exp(-slid / HARDENING_DISTANCE);
#else
    (void)slid;
    return COULOMB;
#endif
}
