#let QUADRATIC_DRAG = viscous_quadratic_QUADRATIC
/* Drag that grows with the square of speed. */
static real viscous_quadratic_effort(const stiction_state *s, const motion *m)
{
    (void)s;
    return -viscous_quadratic_QUADRATIC * m->velocity * r_fabs(m->velocity);
}
