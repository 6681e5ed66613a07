/* A velocity that is held over a time, and what else reaches the contact. */
typedef struct {
    real velocity, dt, displacement, effort, load;
#ifdef MACHINE
    real start; /* velocity before */
#endif
#ifdef LEVELS
    real level, viscous_level;
#endif
#ifdef TEMPERATURE
    real temperature;
#endif
} motion;
#ifdef LEVELS
#define LEVEL m->level
#define VISCOUS_LEVEL m->viscous_level
#else
#define LEVEL R(1)
#define VISCOUS_LEVEL R(1)
#endif
#ifdef USES_WAY
#ifdef APART
#define WAY(span) (m->dt > R(0) ? m->displacement * ((span) / m->dt) : m->displacement)
#else
#define WAY(span) (m->velocity * (span))
#endif
#endif
#ifdef USES_SPEED
#ifdef APART
#define SPEED (m->dt > R(0) ? r_fabs(m->displacement / m->dt) : R(0))
#else
#define SPEED r_fabs(m->velocity)
#endif
#endif
