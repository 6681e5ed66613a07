/* A velocity that is held over a time, and what else reaches the contact. */
typedef struct {
    real velocity, dt, displacement, effort, load;
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
