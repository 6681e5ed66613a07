/* Effort per input that changes with the position. */
static real torque_constant_ripple_input(const stiction_state *s, real input, real velocity)
{
    const real x = s->position.value, turned = torque_constant_ripple_ORDER * x;
    real share = torque_constant_ripple_COSINE * r_cos(turned)
        + torque_constant_ripple_SINE * r_sin(turned);
#if torque_constant_ripple_COSINE_2 != 0 or torque_constant_ripple_SINE_2 != 0
    share += torque_constant_ripple_COSINE_2 * r_cos(torque_constant_ripple_ORDER_2 * x)
        + torque_constant_ripple_SINE_2 * r_sin(torque_constant_ripple_ORDER_2 * x);
#endif
    (void)velocity;
    return input + input * share;
}
