/* Friction that differs with the position. */
static real position_dependent_friction_level(const stiction_state *s, const motion *m)
{
    const real x = s->position.value, turned = position_dependent_friction_ORDER * x;
    real level = position_dependent_friction_COSINE * r_cos(turned)
        + position_dependent_friction_SINE * r_sin(turned);
#if position_dependent_friction_COSINE_2 != 0 or position_dependent_friction_SINE_2 != 0
    level += position_dependent_friction_COSINE_2 * r_cos(position_dependent_friction_ORDER_2 * x)
        + position_dependent_friction_SINE_2 * r_sin(position_dependent_friction_ORDER_2 * x);
#endif
    (void)m;
    return level;
}
