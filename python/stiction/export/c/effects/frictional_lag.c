/* Friction that follows speed late: Hess, Soom, J. Tribology 112 (1990). */
typedef struct {
    STICTION_REAL followed; /* velocity behind a lag */
} stiction_frictional_lag;

static real frictional_lag_level(const stiction_state *s, const motion *m)
{
    const real now = m->velocity / frictional_lag_VELOCITY;
    const real late = s->frictional_lag.followed / frictional_lag_VELOCITY;
    return frictional_lag_EXCESS
        * (r_exp(-late * late) - (R(1) - frictional_lag_FALL) * r_exp(-now * now));
}

static void frictional_lag_remember(stiction_state *s, const motion *m)
{
    stiction_frictional_lag *own = &s->frictional_lag;
    own->followed -= (m->velocity - own->followed) * r_expm1(-m->dt / frictional_lag_TIME);
}
