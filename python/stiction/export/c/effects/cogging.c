#let cogging_STIFFNESS = hypot(cogging_COSINE, cogging_SINE) * cogging_ORDER \
             + hypot(cogging_COSINE_2, cogging_SINE_2) * cogging_ORDER_2
/* Effort that repeats with the position. */
static real cogging_effort(const stiction_state *s, const motion *m)
{
    const real x = s->position.value, turned = cogging_ORDER * x;
    real effort = cogging_COSINE * r_cos(turned) + cogging_SINE * r_sin(turned);
#if cogging_COSINE_2 != 0 or cogging_SINE_2 != 0
    effort += cogging_COSINE_2 * r_cos(cogging_ORDER_2 * x)
        + cogging_SINE_2 * r_sin(cogging_ORDER_2 * x);
#endif
    (void)m;
    return effort;
}
