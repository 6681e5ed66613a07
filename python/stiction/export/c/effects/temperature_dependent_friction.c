/* Friction that is lost with the temperature, in degrees Celsius; NAN where it is not known. */
static real temperature_dependent_friction_level(const stiction_state *s, const motion *m)
{
    (void)s;
    if (m->temperature != m->temperature) {
        return R(0);
    }
    return temperature_dependent_friction_COULOMB
        * (temperature_dependent_friction_REFERENCE - m->temperature);
}
#if temperature_dependent_friction_VISCOUS != 0

static real temperature_dependent_friction_viscous_level(const stiction_state *s, const motion *m)
{
    (void)s;
    if (m->temperature != m->temperature) {
        return R(0);
    }
    return temperature_dependent_friction_VISCOUS
        * (temperature_dependent_friction_REFERENCE - m->temperature);
}
#endif
