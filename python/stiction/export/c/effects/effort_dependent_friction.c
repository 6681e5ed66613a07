/* Friction that grows with the effort of the motor: all effort but friction and the load. */
#if 0 < SLIDING < inf
static real effort_dependent_friction_level(const stiction_state *s, const motion *m)
{
    (void)s;
    return effort_dependent_friction_SHARE * r_fabs(m->effort - m->load) / SLIDING;
}
#endif
