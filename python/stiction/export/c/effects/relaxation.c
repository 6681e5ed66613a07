/* Creep beside the law as long as it is loaded, but for a slide: Norton (1929). */
#if 0 < SLIDING < inf

static real relaxation_creep(const stiction_state *s, const motion *m)
{
    const real share = r_fabs(s->friction) / SLIDING;
    const real way = relaxation_SPEED * r_pow(share, relaxation_EXPONENT) * m->dt;
    if (share >= R(0.98)) {
        return R(0);
    }
    return s->friction > R(0) ? way : -way;
}
#endif
