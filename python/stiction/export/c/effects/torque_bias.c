/* An effort that pushes all the time. */
static real torque_bias_effort(const stiction_state *s, const motion *m)
{
    (void)s;
    (void)m;
    return torque_bias_BIAS;
}
