/* Force of the damping of bristles, of whose motion this share slips: s1*exp(-(v/v_d)^2)*z'. */
static real bristle_damping(real velocity, real slips)
{
#if DAMPING == 0
    (void)velocity;
    (void)slips;
    return R(0);
#else
    const real pace = velocity * (R(1) - slips);
#if DAMPING_VELOCITY == inf
    return DAMPING * pace;
#else
    const real share = velocity / DAMPING_VELOCITY;
    return DAMPING * r_exp(-share * share) * pace;
#endif
#endif
}
