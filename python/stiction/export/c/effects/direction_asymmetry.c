/* Friction that differs between the directions. */
static real direction_asymmetry_level(const stiction_state *s, const motion *m)
{
    const real v = m->velocity, v_0 = direction_asymmetry_VELOCITY;
    (void)s;
    return direction_asymmetry_COULOMB * v / r_sqrt(v * v + v_0 * v_0);
}
#if direction_asymmetry_VISCOUS != 0

static real direction_asymmetry_viscous_level(const stiction_state *s, const motion *m)
{
    const real v = m->velocity, v_0 = direction_asymmetry_VELOCITY;
    (void)s;
    return direction_asymmetry_VISCOUS * v / r_sqrt(v * v + v_0 * v_0);
}
#endif
