
/* What FMI 2.0 and 3.0 have in common: an instance, and its variables by number. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
# if defined __GNUC__
/* The standard asks for more than an FMU needs. */
# pragma GCC diagnostic ignored "-Wunused-parameter"
# endif
# if defined _WIN32 || defined __CYGWIN__
# define EXPORTED __declspec(dllexport)
# elif defined __GNUC__ && __GNUC__ >= 4
# define EXPORTED __attribute__((visibility("default")))
# else
# define EXPORTED
# endif

enum {
    TIME_NOW, INPUT, LOAD, TEMPERATURE_NOW, POSITION_NOW, VELOCITY, FRICTION, ACCELERATION,
    BRISTLES, BENDING, INDICATOR, MEASURED, ENABLED, FALL_INDICATOR
};
enum { SUCCEEDED, WARNED, DISCARDED, FAILED };

/* All that an instance remembers, so that a copy of it goes on from there. */
typedef struct {
    stiction_machine at;
    stiction_way way;
    acting by;
    real since; /* time up to which `at` has come */
    real time;
    real y[3]; /* where the solver is, or the last sample has led */
    int begun;
} remembered;

typedef struct {
    remembered now;
    int exchanges;
    void *environment;
    void *log; /* a callback of one of the two standards */
    char *name;
} instance;

static void begin(instance *it)
{
    machine_begin(&it->now.at, it->now.y[0], it->now.y[1]);
    way_begin(&it->now.way);
    it->now.y[2] = R(0);
    it->now.since = it->now.time;
    it->now.begun = 1;
#ifdef EXCHANGES
    if (it->exchanges) {
        settle(&it->now.at, it->now.y, &it->now.by);
    }
#endif
}

static void reset(instance *it)
{
    it->now = (remembered){0};
    it->now.at.enabled = 1;
    it->now.by.temperature = (real)NAN;
}

static instance *make(const char *name, int exchanges)
{
    instance *it = calloc(1, sizeof *it);
    const size_t length = name ? strlen(name) + 1 : 1;
    char *own = malloc(length);
    if (!it || !own) {
        free(it);
        free(own);
        return NULL;
    }
    memcpy(own, name ? name : "", length);
    it->name = own;
    it->exchanges = exchanges;
    reset(it);
    return it;
}

static void discard(instance *it)
{
    if (it) {
        free(it->name);
        free(it);
    }
}

#ifdef EXCHANGES

static evaluation evaluated(const instance *given)
{
    const instance *it = given;
    instance begun;
    if (!it->now.begun) {
        begun = *given;
        begin(&begun);
        it = &begun;
    }
    return evaluate(&it->now.at, it->now.y, it->now.time - it->now.since, &it->now.by);
}

/* How all that is computed changes where these variables do. Ahead is where the machine goes; of
 * one that rests without sticking either side is as good. */
static dual_evaluation differentiated(const instance *given, const real *seed)
{
    instance it = *given;
    const evaluation rates = evaluated(given);
    const real passed = it.now.time - it.now.since;
    dual_stiction_machine at;
    dual_acting by = lift_acting(&it.now.by);
    dual y[3];
    int k;
    if (!it.now.begun) {
        begin(&it);
    }
    at = lift_stiction_machine(&it.now.at);
    for (k = 0; k < 3; ++k) {
        y[k] = (dual){it.now.y[k], k < STATES ? rates.rate[k] : R(0), R(0)};
    }
    if (y[0].ahead == R(0)) {
        y[0].ahead = y[1].ahead == R(0) ? R(1) : y[1].ahead;
    }
    y[0].tangent = seed[POSITION_NOW];
    y[1].tangent = seed[VELOCITY];
    y[2].tangent = seed[BRISTLES];
    by.input.tangent = seed[INPUT];
    by.load.tangent = seed[LOAD];
    by.temperature.tangent = seed[TEMPERATURE_NOW];
    return dual_evaluate(&at, y, (dual){passed, R(1), seed[TIME_NOW]}, &by);
}

/* The derivative of variables in a direction of others; why not, where there is none. */
static const char *derive(const instance *it, const uint32_t *unknown, size_t unknowns,
                          const uint32_t *known, size_t knowns, const double *seed, double *found)
{
    real direction[FALL_INDICATOR + 1] = {0};
    dual_evaluation all;
    size_t k;
    if (!it->exchanges) {
        return "directional derivatives are those of model exchange";
    }
    for (k = 0; k < knowns; ++k) {
        const uint32_t which = known[k];
        if (which > VELOCITY && which != BRISTLES) {
            return "there is no derivative by this variable";
        }
        direction[which] = seed[k];
    }
    all = differentiated(it, direction);
    for (k = 0; k < unknowns; ++k) {
        switch (unknown[k]) {
        case POSITION_NOW:
            found[k] = direction[POSITION_NOW];
            break;
        case VELOCITY:
            found[k] = all.rate[0].tangent;
            break;
        case FRICTION:
            found[k] = all.friction.tangent;
            break;
        case ACCELERATION:
            found[k] = all.rate[1].tangent;
            break;
        case BENDING:
            found[k] = all.rate[STATES - 1].tangent;
            break;
        case INDICATOR:
            found[k] = all.indicator[0].tangent;
            break;
        case FALL_INDICATOR:
            found[k] = all.indicator[INDICATORS - 1].tangent;
            break;
        case MEASURED: /* in steps */
            found[k] = R(0);
            break;
        default:
            return "there is no derivative of this variable";
        }
    }
    return NULL;
}

static void completed(instance *it)
{
    complete(&it->now.at, it->now.y, it->now.time - it->now.since, &it->now.by);
    it->now.since = it->now.time;
}

/* At an event; whether states were changed. */
static int arrive(instance *it)
{
    completed(it);
    return settle(&it->now.at, it->now.y, &it->now.by);
}
#endif

static int get_real(const instance *it, uint32_t which, double *value)
{
    switch (which) {
    case TIME_NOW:
        *value = it->now.time;
        return SUCCEEDED;
    case INPUT:
        *value = it->now.by.input;
        return SUCCEEDED;
    case LOAD:
        *value = it->now.by.load;
        return SUCCEEDED;
    case TEMPERATURE_NOW:
        *value = it->now.by.temperature;
        return SUCCEEDED;
    case POSITION_NOW:
        *value = it->now.y[0];
        return SUCCEEDED;
    case VELOCITY:
        *value = it->now.y[1];
        return SUCCEEDED;
    case MEASURED:
#if COUNT > 0
        *value = COUNT * r_round(it->now.y[0] / COUNT);
#else
        *value = it->now.y[0];
#endif
        return SUCCEEDED;
#ifdef EXCHANGES
    case FRICTION:
        *value = it->exchanges ? evaluated(it).friction : it->now.at.contact.friction;
        return SUCCEEDED;
    case ACCELERATION:
        *value = evaluated(it).rate[1];
        return SUCCEEDED;
    case BRISTLES:
        *value = it->now.y[2];
        return SUCCEEDED;
    case BENDING:
        *value = evaluated(it).rate[STATES - 1];
        return SUCCEEDED;
    case INDICATOR:
        *value = evaluated(it).indicator[0];
        return SUCCEEDED;
    case FALL_INDICATOR:
        *value = evaluated(it).indicator[INDICATORS - 1];
        return SUCCEEDED;
#else
    case FRICTION:
        *value = it->now.at.contact.friction;
        return SUCCEEDED;
#endif
    default:
        return FAILED;
    }
}

static int set_real(instance *it, uint32_t which, double value)
{
    if (which == INPUT) {
        it->now.by.input = value;
    } else if (which == LOAD) {
        it->now.by.load = value;
    } else if (which == TEMPERATURE_NOW) {
        it->now.by.temperature = value;
    } else if (which == POSITION_NOW && !it->now.begun) {
        it->now.y[0] = value;
    } else if (which == VELOCITY && !it->now.begun) {
        it->now.y[1] = value;
    } else {
        return FAILED;
    }
    return SUCCEEDED;
}

/* A sample of held input; why not, where it cannot be gone through. */
static const char *sample(instance *it, double time, double span)
{
    const remembered before = it->now;
    acting arrived = it->now.by;
    if (!(span > 0.0)) {
        return "a communication step has to be longer than 0 s";
    }
    arrived.input = way_pass(&it->now.way, it->now.by.input, span);
    if (!machine_step(&it->now.at, &arrived, span)) {
        it->now = before;
        return "this communication step would take more than 10000 inner steps: make it shorter";
    }
    it->now.y[0] = it->now.at.contact.position.value;
    it->now.y[1] = it->now.at.velocity;
#ifdef BENDS
    it->now.y[2] = it->now.at.contact.law.force;
#endif
    if (!isfinite(it->now.y[0] + it->now.y[1])) {
        it->now = before;
        return "this input leads to no number; the machine stays where it was";
    }
    it->now.time = it->now.since = time + span;
    return NULL;
}

/* Beside the standards, for who starts a machine in the midst of a recording: leads the contact
 * along measured positions, one more than samples, of which it stands at the first, under what
 * drove the machine. It goes on with this velocity. */
EXPORTED void stiction_follow(void *given, size_t samples, double dt, const double positions[],
                              const double inputs[], const double loads[], double velocity)
{
    instance *it = given;
    acting by = it->now.by;
    size_t k;
    for (k = 0; k < samples; ++k) {
        by.input = way_pass(&it->now.way, inputs[k], dt);
        by.load = loads[k];
        machine_follow(&it->now.at, &by, positions[k + 1], dt);
    }
    it->now.at.velocity = velocity;
    it->now.y[0] = it->now.at.contact.position.value;
    it->now.y[1] = velocity;
#ifdef BENDS
    it->now.y[2] = it->now.at.contact.law.force;
#endif
}

/* Sets the clock and the path of a session, which effects may go by. */
EXPORTED void stiction_set_clock(void *given, double clock, double path)
{
    instance *it = given;
    it->now.at.contact.time.value = clock;
    it->now.at.contact.path.value = path;
}
