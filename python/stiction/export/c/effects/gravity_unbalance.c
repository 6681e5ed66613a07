#let gravity_unbalance_STIFFNESS = hypot(gravity_unbalance_COSINE, gravity_unbalance_SINE)
/* A centre of mass beside the axis. */
static real gravity_unbalance_effort(const stiction_state *s, const motion *m)
{
    (void)m;
    return gravity_unbalance_COSINE * r_cos(s->position.value)
        + gravity_unbalance_SINE * r_sin(s->position.value);
}
