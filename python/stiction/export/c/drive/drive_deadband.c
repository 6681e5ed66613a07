/* An input within a band about 0 does nothing. */
static real drive_deadband_input(const stiction_state *s, real input, real velocity)
{
    const real band = drive_deadband_DEADBAND;
    (void)s;
    (void)velocity;
    return input > band ? input - band : input < -band ? input + band : R(0) * input;
}
