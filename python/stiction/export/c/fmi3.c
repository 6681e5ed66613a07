
/* FMI 3.0, https://fmi-standard.org/docs/3.0: types and functions as the standard names them. */
typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef double fmi3Float64;
typedef bool fmi3Boolean;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String category,
                                       fmi3String message);

static fmi3Status told3(const instance *it, const char *message)
{
    fmi3LogMessageCallback log;
    memcpy(&log, &it->log, sizeof log);
    if (log) {
        log(it->environment, fmi3Error, "logStatusError", message);
    }
    return fmi3Error;
}

EXPORTED const char *fmi3GetVersion(void) { return "3.0"; }

EXPORTED fmi3Status fmi3SetDebugLogging(fmi3Instance it, fmi3Boolean on, size_t number,
                                        const fmi3String categories[])
{
    (void)it;
    (void)on;
    (void)number;
    (void)categories;
    return fmi3OK;
}

static instance *made3(fmi3String name, fmi3String token, fmi3InstanceEnvironment environment,
                       fmi3LogMessageCallback log, int exchanges)
{
    instance *it;
    if (!token || strcmp(token, TOKEN) != 0) {
        if (log) {
            log(environment, fmi3Error, "logStatusError",
                "the instantiation token is not that of this FMU's model description");
        }
        return NULL;
    }
    it = make(name, exchanges);
    if (it) {
        it->environment = environment;
        memcpy(&it->log, &log, sizeof log);
    }
    return it;
}

EXPORTED fmi3Instance fmi3InstantiateModelExchange(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    (void)resources;
    (void)visible;
    (void)logging;
#ifdef EXCHANGES
    return made3(name, token, environment, log, 1);
#else
    (void)name;
    (void)token;
    (void)environment;
    (void)log;
    return NULL;
#endif
}

EXPORTED fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
    const fmi3ValueReference required[], size_t number, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback log, void (*update)(void))
{
    (void)resources;
    (void)visible;
    (void)logging;
    (void)events;
    (void)early;
    (void)required;
    (void)number;
    (void)update;
    return made3(name, token, environment, log, 0);
}

EXPORTED fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    void (*update)(void), void (*lock)(void), void (*unlock)(void))
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)logging;
    (void)environment;
    (void)log;
    (void)update;
    (void)lock;
    (void)unlock;
    return NULL;
}

EXPORTED void fmi3FreeInstance(fmi3Instance it) { discard(it); }

EXPORTED fmi3Status fmi3EnterInitializationMode(fmi3Instance given, fmi3Boolean tolerance_defined,
                                                fmi3Float64 tolerance, fmi3Float64 start,
                                                fmi3Boolean stop_defined, fmi3Float64 stop)
{
    instance *it = given;
    (void)tolerance_defined;
    (void)tolerance;
    (void)stop_defined;
    (void)stop;
    it->now.time = it->now.since = start;
    return fmi3OK;
}

EXPORTED fmi3Status fmi3ExitInitializationMode(fmi3Instance it)
{
    begin(it);
    return fmi3OK;
}

EXPORTED fmi3Status fmi3Reset(fmi3Instance it)
{
    reset(it);
    return fmi3OK;
}

#define ACCEPTED(name) \
    EXPORTED fmi3Status name(fmi3Instance it) { (void)it; return fmi3OK; }
ACCEPTED(fmi3EnterEventMode)
ACCEPTED(fmi3Terminate)
ACCEPTED(fmi3EnterConfigurationMode)
ACCEPTED(fmi3ExitConfigurationMode)
ACCEPTED(fmi3EvaluateDiscreteStates)
ACCEPTED(fmi3EnterContinuousTimeMode)
ACCEPTED(fmi3EnterStepMode)

EXPORTED fmi3Status fmi3GetFloat64(fmi3Instance it, const fmi3ValueReference which[],
                                   size_t number, fmi3Float64 values[], size_t many)
{
    size_t k;
    if (number != many) {
        return told3(it, "as many values as variables are needed");
    }
    for (k = 0; k < number; ++k) {
        if (get_real(it, which[k], &values[k]) != SUCCEEDED) {
            return told3(it, "there is no such variable");
        }
    }
    return fmi3OK;
}

EXPORTED fmi3Status fmi3SetFloat64(fmi3Instance it, const fmi3ValueReference which[],
                                   size_t number, const fmi3Float64 values[], size_t many)
{
    size_t k;
    if (number != many) {
        return told3(it, "as many values as variables are needed");
    }
    for (k = 0; k < number; ++k) {
        if (set_real(it, which[k], values[k]) != SUCCEEDED) {
            return told3(it, "this variable cannot be set, or not any more");
        }
    }
    return fmi3OK;
}

EXPORTED fmi3Status fmi3GetBoolean(fmi3Instance given, const fmi3ValueReference which[],
                                   size_t number, fmi3Boolean values[], size_t many)
{
    instance *it = given;
    size_t k;
    for (k = 0; k < number && k < many; ++k) {
        if (which[k] != ENABLED) {
            return told3(it, "there is no such variable");
        }
        values[k] = it->now.at.enabled != 0;
    }
    return fmi3OK;
}

EXPORTED fmi3Status fmi3SetBoolean(fmi3Instance given, const fmi3ValueReference which[],
                                   size_t number, const fmi3Boolean values[], size_t many)
{
    instance *it = given;
    size_t k;
    for (k = 0; k < number && k < many; ++k) {
        if (which[k] != ENABLED) {
            return told3(it, "there is no such variable");
        }
        it->now.at.enabled = values[k];
    }
    return fmi3OK;
}

/* There are no variables of these types. */
#define NO_VARIABLES(name, type) \
    EXPORTED fmi3Status name(fmi3Instance it, const fmi3ValueReference which[], size_t number, \
                             type values[], size_t many) \
    { \
        (void)which; \
        (void)values; \
        return number || many ? told3(it, "there is no variable of this type") : fmi3OK; \
    }
#define NO_TYPE(name, type) \
    NO_VARIABLES(fmi3Get##name, type) \
    NO_VARIABLES(fmi3Set##name, const type)
NO_TYPE(Float32, float)
NO_TYPE(Int8, int8_t)
NO_TYPE(UInt8, uint8_t)
NO_TYPE(Int16, int16_t)
NO_TYPE(UInt16, uint16_t)
NO_TYPE(Int32, int32_t)
NO_TYPE(UInt32, uint32_t)
NO_TYPE(Int64, int64_t)
NO_TYPE(UInt64, uint64_t)
NO_VARIABLES(fmi3GetString, fmi3String)
NO_VARIABLES(fmi3SetString, const fmi3String)

/* Nor are there clocks, binaries, dependencies to be asked for or partitions. */
#define NOT_THERE(name, ...) \
    EXPORTED fmi3Status name(fmi3Instance it, __VA_ARGS__) \
    { \
        return told3(it, #name " is not offered by this FMU"); \
    }
typedef const fmi3ValueReference *references;
NOT_THERE(fmi3GetBinary, references a, size_t b, size_t *c, const fmi3Byte **d, size_t e)
NOT_THERE(fmi3SetBinary, references a, size_t b, const size_t *c, const fmi3Byte *const *d,
          size_t e)
NOT_THERE(fmi3GetClock, references a, size_t b, bool *c)
NOT_THERE(fmi3SetClock, references a, size_t b, const bool *c)
NOT_THERE(fmi3GetNumberOfVariableDependencies, fmi3ValueReference a, size_t *b)
NOT_THERE(fmi3GetVariableDependencies, fmi3ValueReference a, size_t *b, fmi3ValueReference *c,
          size_t *d, int *e, size_t f)
#ifdef EXCHANGES
EXPORTED fmi3Status fmi3GetDirectionalDerivative(fmi3Instance it, references unknown,
                                                 size_t unknowns, references known, size_t knowns,
                                                 const fmi3Float64 seed[], size_t seeds,
                                                 fmi3Float64 found[], size_t many)
{
    const char *why = knowns != seeds || unknowns != many
        ? "as many values as variables are needed"
        : derive(it, unknown, unknowns, known, knowns, seed, found);
    return why ? told3(it, why) : fmi3OK;
}
#else
NOT_THERE(fmi3GetDirectionalDerivative, references a, size_t b, references c, size_t d,
          const fmi3Float64 *e, size_t f, fmi3Float64 *g, size_t h)
#endif
NOT_THERE(fmi3GetAdjointDerivative, references a, size_t b, references c, size_t d,
          const fmi3Float64 *e, size_t f, fmi3Float64 *g, size_t h)
NOT_THERE(fmi3GetIntervalDecimal, references a, size_t b, fmi3Float64 *c, int *d)
NOT_THERE(fmi3GetIntervalFraction, references a, size_t b, uint64_t *c, uint64_t *d, int *e)
NOT_THERE(fmi3GetShiftDecimal, references a, size_t b, fmi3Float64 *c)
NOT_THERE(fmi3GetShiftFraction, references a, size_t b, uint64_t *c, uint64_t *d)
NOT_THERE(fmi3SetIntervalDecimal, references a, size_t b, const fmi3Float64 *c)
NOT_THERE(fmi3SetIntervalFraction, references a, size_t b, const uint64_t *c, const uint64_t *d)
NOT_THERE(fmi3SetShiftDecimal, references a, size_t b, const fmi3Float64 *c)
NOT_THERE(fmi3SetShiftFraction, references a, size_t b, const uint64_t *c, const uint64_t *d)
NOT_THERE(fmi3GetOutputDerivatives, references a, size_t b, const int32_t *c, fmi3Float64 *d,
          size_t e)
NOT_THERE(fmi3ActivateModelPartition, fmi3ValueReference a, fmi3Float64 b)

EXPORTED fmi3Status fmi3GetFMUState(fmi3Instance given, fmi3FMUState *state)
{
    const instance *it = given;
    if (!*state && !(*state = malloc(sizeof it->now))) {
        return told3(it, "there is no memory for a state");
    }
    memcpy(*state, &it->now, sizeof it->now);
    return fmi3OK;
}

EXPORTED fmi3Status fmi3SetFMUState(fmi3Instance given, fmi3FMUState state)
{
    instance *it = given;
    memcpy(&it->now, state, sizeof it->now);
    return fmi3OK;
}

EXPORTED fmi3Status fmi3FreeFMUState(fmi3Instance it, fmi3FMUState *state)
{
    (void)it;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

EXPORTED fmi3Status fmi3SerializedFMUStateSize(fmi3Instance it, fmi3FMUState state, size_t *size)
{
    (void)it;
    (void)state;
    *size = sizeof(remembered);
    return fmi3OK;
}

EXPORTED fmi3Status fmi3SerializeFMUState(fmi3Instance it, fmi3FMUState state, fmi3Byte bytes[],
                                          size_t size)
{
    if (size != sizeof(remembered)) {
        return told3(it, "a serialized state of this FMU has another size");
    }
    memcpy(bytes, state, size);
    return fmi3OK;
}

EXPORTED fmi3Status fmi3DeserializeFMUState(fmi3Instance it, const fmi3Byte bytes[], size_t size,
                                            fmi3FMUState *state)
{
    if (size != sizeof(remembered)) {
        return told3(it, "a serialized state of this FMU has another size");
    }
    if (!*state && !(*state = malloc(size))) {
        return told3(it, "there is no memory for a state");
    }
    memcpy(*state, bytes, size);
    return fmi3OK;
}

EXPORTED fmi3Status fmi3UpdateDiscreteStates(fmi3Instance given, fmi3Boolean *again,
                                             fmi3Boolean *terminate, fmi3Boolean *nominals,
                                             fmi3Boolean *values, fmi3Boolean *defined,
                                             fmi3Float64 *next)
{
    instance *it = given;
    *again = *terminate = *nominals = *values = *defined = false;
    *next = 0.0;
#ifdef EXCHANGES
    if (it->exchanges) {
        *values = arrive(it) != 0;
    }
#else
    (void)it;
#endif
    return fmi3OK;
}

EXPORTED fmi3Status fmi3DoStep(fmi3Instance given, fmi3Float64 time, fmi3Float64 span,
                               fmi3Boolean final, fmi3Boolean *event, fmi3Boolean *terminate,
                               fmi3Boolean *early, fmi3Float64 *last)
{
    instance *it = given;
    const char *why = sample(it, time, span);
    (void)final;
    *event = *terminate = *early = false;
    *last = it->now.time;
    return why ? told3(it, why) : fmi3OK;
}
#ifdef EXCHANGES

EXPORTED fmi3Status fmi3CompletedIntegratorStep(fmi3Instance it, fmi3Boolean final,
                                                fmi3Boolean *event, fmi3Boolean *terminate)
{
    (void)final;
    *event = *terminate = false;
    completed(it);
    return fmi3OK;
}

EXPORTED fmi3Status fmi3SetTime(fmi3Instance given, fmi3Float64 time)
{
    instance *it = given;
    it->now.time = time;
    return fmi3OK;
}

EXPORTED fmi3Status fmi3SetContinuousStates(fmi3Instance given, const fmi3Float64 states[],
                                            size_t number)
{
    instance *it = given;
    if (number != STATES) {
        return told3(it, "this FMU has another number of states");
    }
    memcpy(it->now.y, states, number * sizeof *states);
    return fmi3OK;
}

EXPORTED fmi3Status fmi3GetContinuousStates(fmi3Instance given, fmi3Float64 states[],
                                            size_t number)
{
    const instance *it = given;
    if (number != STATES) {
        return told3(it, "this FMU has another number of states");
    }
    memcpy(states, it->now.y, number * sizeof *states);
    return fmi3OK;
}

EXPORTED fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance it, fmi3Float64 rates[],
                                                      size_t number)
{
    evaluation found;
    if (number != STATES) {
        return told3(it, "this FMU has another number of states");
    }
    found = evaluated(it);
    memcpy(rates, found.rate, sizeof found.rate);
    return fmi3OK;
}

EXPORTED fmi3Status fmi3GetEventIndicators(fmi3Instance it, fmi3Float64 indicators[],
                                           size_t number)
{
    evaluation found;
    if (number != INDICATORS) {
        return told3(it, "this FMU has another number of event indicators");
    }
    found = evaluated(it);
    memcpy(indicators, found.indicator, sizeof found.indicator);
    return fmi3OK;
}

EXPORTED fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance it, fmi3Float64 nominals[],
                                                      size_t number)
{
    if (number != STATES) {
        return told3(it, "this FMU has another number of states");
    }
    memcpy(nominals, NOMINAL, number * sizeof *nominals);
    return fmi3OK;
}

EXPORTED fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance it, size_t *number)
{
    (void)it;
    *number = INDICATORS;
    return fmi3OK;
}

EXPORTED fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance it, size_t *number)
{
    (void)it;
    *number = STATES;
    return fmi3OK;
}
#else
NOT_THERE(fmi3CompletedIntegratorStep, fmi3Boolean a, fmi3Boolean *b, fmi3Boolean *c)
NOT_THERE(fmi3SetTime, fmi3Float64 a)
NOT_THERE(fmi3SetContinuousStates, const fmi3Float64 *a, size_t b)
NOT_THERE(fmi3GetContinuousStates, fmi3Float64 *a, size_t b)
NOT_THERE(fmi3GetContinuousStateDerivatives, fmi3Float64 *a, size_t b)
NOT_THERE(fmi3GetEventIndicators, fmi3Float64 *a, size_t b)
NOT_THERE(fmi3GetNominalsOfContinuousStates, fmi3Float64 *a, size_t b)
NOT_THERE(fmi3GetNumberOfEventIndicators, size_t *a)
NOT_THERE(fmi3GetNumberOfContinuousStates, size_t *a)
#endif
