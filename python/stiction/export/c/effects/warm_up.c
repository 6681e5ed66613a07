/* Friction that is lost with the time since the start. */
static real warm_up_level(const stiction_state *s, const motion *m)
{
    (void)m;
    return warm_up_COULOMB * r_expm1(-s->time.value / warm_up_TIME);
}
#if warm_up_VISCOUS != 0

static real warm_up_viscous_level(const stiction_state *s, const motion *m)
{
    (void)m;
    return warm_up_VISCOUS * r_expm1(-s->time.value / warm_up_TIME);
}
#endif
