/* Beyond a limit a share of the input is lost. */
static real drive_saturation_input(const stiction_state *s, real input, real velocity)
{
    const real limit = input < R(0) ? -drive_saturation_LIMIT : drive_saturation_LIMIT;
    (void)s;
    (void)velocity;
    return r_fabs(input) > drive_saturation_LIMIT
        ? input - drive_saturation_SHARE * (input - limit) : input;
}
