
/* What the input passes on its way to the drive: a delay, a limit of its rate, a lag. A sample gets
 * the mean of what arrives during it. */
#define WAITING 1024
typedef struct {
#ifdef DELAYS
    real value[WAITING], duration[WAITING]; /* on their way, in a ring */
    int first, number;
#endif
#ifdef SLOWS
    real reached;
    int begun;
#endif
#ifdef LAGS
    real followed;
#endif
    int passed; /* no structure is empty */
} stiction_way;

static void way_begin(stiction_way *way)
{
    *way = (stiction_way){0};
#ifdef DELAYS
    way->duration[0] = input_delay_DELAY;
    way->number = input_delay_DELAY > R(0) ? 1 : 0;
#endif
}
#ifdef DELAYS

static real delayed(stiction_way *way, real input, real dt)
{
    const real least = dt < input_delay_DELAY ? dt : input_delay_DELAY, nearly = R(1e-9) * least;
    real left = dt, mean = R(0);
    int at;
    if (way->number == WAITING) {
        /* Without room the two that are next arrive as one, with their mean. */
        const int one = way->first, two = (one + 1) % WAITING;
        const real whole = way->duration[one] + way->duration[two];
        way->value[two] = (way->value[one] * way->duration[one]
                           + way->value[two] * way->duration[two]) / whole;
        way->duration[two] = whole;
        way->first = two;
        way->number -= 1;
    }
    at = (way->first + way->number) % WAITING;
    way->value[at] = input;
    way->duration[at] = dt;
    way->number += 1;
    while (way->number > 0) {
        const real value = way->value[way->first];
        const real beyond = way->duration[way->first] - left;
        if (beyond > nearly) {
            way->duration[way->first] = beyond;
            return mean + value * (left / dt);
        }
        if (beyond < -nearly) {
            mean += value * (way->duration[way->first] / dt);
            left -= way->duration[way->first];
        } else {
            mean += value * (left / dt);
            left = R(0);
        }
        way->first = (way->first + 1) % WAITING;
        way->number -= 1;
        if (left == R(0)) {
            break;
        }
    }
    return mean;
}
#endif
#ifdef SLOWS

/* u - d*T/(2*dt) where it gets there within T = |d|*slowness, else half of the way it makes. */
static real slowed(stiction_way *way, real input, real dt)
{
    const real missing = input - way->reached;
    const real needed = r_fabs(missing) * goal_rate_limit_SLOWNESS;
    real made;
    if (!way->begun || needed <= dt) {
        const real late = way->begun ? missing * needed / (R(2) * dt) : R(0);
        way->begun = 1;
        way->reached = input;
        return input - late;
    }
    made = (missing < R(0) ? -dt : dt) / goal_rate_limit_SLOWNESS;
    way->reached += made;
    return way->reached - R(0.5) * made;
}
#endif
#ifdef LAGS

static real lagged(stiction_way *way, real input, real dt)
{
    const real behind = way->followed - input, share = dt / current_loop_lag_TIME;
    const real gone = -r_expm1(-share);
    if (!(current_loop_lag_TIME > R(0))) {
        way->followed = input;
        return input;
    }
    way->followed = input - behind * (gone - R(1));
    return input + behind * gone / share;
}
#endif

static real way_pass(stiction_way *way, real input, real dt)
{
    way->passed = 1;
#ifdef DELAYS
    input = delayed(way, input, dt);
#endif
#ifdef SLOWS
    input = slowed(way, input, dt);
#endif
#ifdef LAGS
    input = lagged(way, input, dt);
#endif
    (void)dt;
    return input;
}
