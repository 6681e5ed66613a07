/* A share of the input is lost beyond what the supply allows at a speed. */
static real voltage_limit_input(const stiction_state *s, real input, real velocity)
{
    const real side = input > R(0) ? R(1) : input < R(0) ? R(-1) : R(0);
    const real along = voltage_limit_LIMIT
        - voltage_limit_LIMIT * (velocity * side) / voltage_limit_NO_LOAD;
    const real most = along > R(0) ? along : R(0);
    (void)s;
    return r_fabs(input) > most ? input - voltage_limit_SHARE * (input - most * side) : input;
}
