/* Friction that grows with the load, otherwise while the load drives. */
#if 0 < SLIDING < inf
static real load_dependent_friction_level(const stiction_state *s, const motion *m)
{
    const real v = m->velocity, v_0 = load_dependent_friction_VELOCITY;
    const real direction = v / r_sqrt(v * v + v_0 * v_0);
    const real drive = load_dependent_friction_DRIVE;
    const real back_drive = load_dependent_friction_BACK_DRIVE;
    (void)s;
    return R(0.5) * ((drive + back_drive) * r_fabs(m->load)
                     - (drive - back_drive) * m->load * direction) / SLIDING;
}
#endif
