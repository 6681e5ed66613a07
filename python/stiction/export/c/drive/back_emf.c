/* Voltage that the motor induces against an input. */
static real back_emf_input(const stiction_state *s, real input, real velocity)
{
    (void)s;
    return input - back_emf_SLOPE * r_fabs(input) * velocity;
}
