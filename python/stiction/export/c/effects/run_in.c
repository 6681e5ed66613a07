/* Friction that is lost with the path travelled: Blau, Wear 71 (1981). */
static real run_in_level(const stiction_state *s, const motion *m)
{
    (void)m;
    return run_in_COULOMB * r_expm1(-s->path.value / run_in_DISTANCE);
}
