
/* FMI 2.0, https://fmi-standard.org: types and functions as the standard names them. */
typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment environment;
} fmi2CallbackFunctions;
typedef struct {
    fmi2Boolean again, terminate, nominals, values, defined;
    fmi2Real next;
} fmi2EventInfo;

static fmi2Status told2(const instance *it, const char *message)
{
    const fmi2CallbackFunctions *callbacks = it->log;
    if (callbacks && callbacks->logger) {
        callbacks->logger(it->environment, it->name, fmi2Error, "logStatusError", "%s", message);
    }
    return fmi2Error;
}

EXPORTED const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORTED const char *fmi2GetVersion(void) { return "2.0"; }

EXPORTED fmi2Status fmi2SetDebugLogging(fmi2Component it, fmi2Boolean on, size_t number,
                                        const fmi2String categories[])
{
    (void)it;
    (void)on;
    (void)number;
    (void)categories;
    return fmi2OK;
}

EXPORTED fmi2Component fmi2Instantiate(fmi2String name, fmi2Type kind, fmi2String token,
                                       fmi2String resources,
                                       const fmi2CallbackFunctions *callbacks,
                                       fmi2Boolean visible, fmi2Boolean logging)
{
    instance *it;
    (void)resources;
    (void)visible;
    (void)logging;
#ifdef EXCHANGES
#else
    if (kind == fmi2ModelExchange) {
        return NULL;
    }
#endif
    if (!token || strcmp(token, TOKEN) != 0) {
        return NULL;
    }
    it = make(name, kind == fmi2ModelExchange);
    if (it && callbacks) {
        it->environment = callbacks->environment;
        memcpy(&it->log, &callbacks, sizeof callbacks);
    }
    return it;
}

EXPORTED void fmi2FreeInstance(fmi2Component it) { discard(it); }

EXPORTED fmi2Status fmi2SetupExperiment(fmi2Component given, fmi2Boolean tolerance_defined,
                                        fmi2Real tolerance, fmi2Real start,
                                        fmi2Boolean stop_defined, fmi2Real stop)
{
    instance *it = given;
    (void)tolerance_defined;
    (void)tolerance;
    (void)stop_defined;
    (void)stop;
    it->now.time = it->now.since = start;
    return fmi2OK;
}

EXPORTED fmi2Status fmi2ExitInitializationMode(fmi2Component it)
{
    begin(it);
    return fmi2OK;
}

EXPORTED fmi2Status fmi2Reset(fmi2Component it)
{
    reset(it);
    return fmi2OK;
}

#define ACCEPTED2(name) \
    EXPORTED fmi2Status name(fmi2Component it) { (void)it; return fmi2OK; }
ACCEPTED2(fmi2EnterInitializationMode)
ACCEPTED2(fmi2Terminate)
ACCEPTED2(fmi2EnterEventMode)
ACCEPTED2(fmi2EnterContinuousTimeMode)

EXPORTED fmi2Status fmi2GetReal(fmi2Component it, const fmi2ValueReference which[], size_t number,
                                fmi2Real values[])
{
    size_t k;
    for (k = 0; k < number; ++k) {
        if (get_real(it, which[k], &values[k]) != SUCCEEDED) {
            return told2(it, "there is no such variable");
        }
    }
    return fmi2OK;
}

EXPORTED fmi2Status fmi2SetReal(fmi2Component it, const fmi2ValueReference which[], size_t number,
                                const fmi2Real values[])
{
    size_t k;
    for (k = 0; k < number; ++k) {
        if (set_real(it, which[k], values[k]) != SUCCEEDED) {
            return told2(it, "this variable cannot be set, or not any more");
        }
    }
    return fmi2OK;
}

EXPORTED fmi2Status fmi2GetBoolean(fmi2Component given, const fmi2ValueReference which[],
                                   size_t number, fmi2Boolean values[])
{
    instance *it = given;
    size_t k;
    for (k = 0; k < number; ++k) {
        if (which[k] != ENABLED) {
            return told2(it, "there is no such variable");
        }
        values[k] = it->now.at.enabled;
    }
    return fmi2OK;
}

EXPORTED fmi2Status fmi2SetBoolean(fmi2Component given, const fmi2ValueReference which[],
                                   size_t number, const fmi2Boolean values[])
{
    instance *it = given;
    size_t k;
    for (k = 0; k < number; ++k) {
        if (which[k] != ENABLED) {
            return told2(it, "there is no such variable");
        }
        it->now.at.enabled = values[k] != 0;
    }
    return fmi2OK;
}

/* There are no variables of these types. */
#define NO_TYPE2(name, type) \
    EXPORTED fmi2Status name(fmi2Component it, const fmi2ValueReference which[], size_t number, \
                             type values[]) \
    { \
        (void)which; \
        (void)values; \
        return number ? told2(it, "there is no variable of this type") : fmi2OK; \
    }
NO_TYPE2(fmi2GetInteger, fmi2Integer)
NO_TYPE2(fmi2SetInteger, const fmi2Integer)
NO_TYPE2(fmi2GetString, fmi2String)
NO_TYPE2(fmi2SetString, const fmi2String)

EXPORTED fmi2Status fmi2GetFMUstate(fmi2Component given, fmi2FMUstate *state)
{
    const instance *it = given;
    if (!*state && !(*state = malloc(sizeof it->now))) {
        return told2(it, "there is no memory for a state");
    }
    memcpy(*state, &it->now, sizeof it->now);
    return fmi2OK;
}

EXPORTED fmi2Status fmi2SetFMUstate(fmi2Component given, fmi2FMUstate state)
{
    instance *it = given;
    memcpy(&it->now, state, sizeof it->now);
    return fmi2OK;
}

EXPORTED fmi2Status fmi2FreeFMUstate(fmi2Component it, fmi2FMUstate *state)
{
    (void)it;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

EXPORTED fmi2Status fmi2SerializedFMUstateSize(fmi2Component it, fmi2FMUstate state, size_t *size)
{
    (void)it;
    (void)state;
    *size = sizeof(remembered);
    return fmi2OK;
}

EXPORTED fmi2Status fmi2SerializeFMUstate(fmi2Component it, fmi2FMUstate state, fmi2Byte bytes[],
                                          size_t size)
{
    if (size != sizeof(remembered)) {
        return told2(it, "a serialized state of this FMU has another size");
    }
    memcpy(bytes, state, size);
    return fmi2OK;
}

EXPORTED fmi2Status fmi2DeSerializeFMUstate(fmi2Component it, const fmi2Byte bytes[], size_t size,
                                            fmi2FMUstate *state)
{
    if (size != sizeof(remembered)) {
        return told2(it, "a serialized state of this FMU has another size");
    }
    if (!*state && !(*state = malloc(size))) {
        return told2(it, "there is no memory for a state");
    }
    memcpy(*state, bytes, size);
    return fmi2OK;
}

EXPORTED fmi2Status fmi2DoStep(fmi2Component it, fmi2Real time, fmi2Real span, fmi2Boolean final)
{
    const char *why = sample(it, time, span);
    (void)final;
    return why ? told2(it, why) : fmi2OK;
}

#define NOT_THERE2(name, ...) \
    EXPORTED fmi2Status name(fmi2Component it, __VA_ARGS__) \
    { \
        return told2(it, #name " is not offered by this FMU"); \
    }
typedef const fmi2ValueReference *references2;
#ifdef EXCHANGES
EXPORTED fmi2Status fmi2GetDirectionalDerivative(fmi2Component it, references2 unknown,
                                                 size_t unknowns, references2 known,
                                                 size_t knowns, const fmi2Real seed[],
                                                 fmi2Real found[])
{
    const char *why = derive(it, unknown, unknowns, known, knowns, seed, found);
    return why ? told2(it, why) : fmi2OK;
}
#else
NOT_THERE2(fmi2GetDirectionalDerivative, references2 a, size_t b, references2 c, size_t d,
           const fmi2Real *e, fmi2Real *f)
#endif
NOT_THERE2(fmi2SetRealInputDerivatives, references2 a, size_t b, const fmi2Integer *c,
           const fmi2Real *d)
NOT_THERE2(fmi2GetRealOutputDerivatives, references2 a, size_t b, const fmi2Integer *c,
           fmi2Real *d)
NOT_THERE2(fmi2GetStatus, int a, fmi2Status *b)
NOT_THERE2(fmi2GetRealStatus, int a, fmi2Real *b)
NOT_THERE2(fmi2GetIntegerStatus, int a, fmi2Integer *b)
NOT_THERE2(fmi2GetBooleanStatus, int a, fmi2Boolean *b)
NOT_THERE2(fmi2GetStringStatus, int a, fmi2String *b)

EXPORTED fmi2Status fmi2CancelStep(fmi2Component it)
{
    return told2(it, "a step of this FMU is done when it returns");
}
#ifdef EXCHANGES

EXPORTED fmi2Status fmi2NewDiscreteStates(fmi2Component it, fmi2EventInfo *info)
{
    *info = (fmi2EventInfo){0};
    info->values = arrive(it);
    return fmi2OK;
}

EXPORTED fmi2Status fmi2CompletedIntegratorStep(fmi2Component it, fmi2Boolean final,
                                                fmi2Boolean *event, fmi2Boolean *terminate)
{
    (void)final;
    *event = *terminate = 0;
    completed(it);
    return fmi2OK;
}

EXPORTED fmi2Status fmi2SetTime(fmi2Component given, fmi2Real time)
{
    instance *it = given;
    it->now.time = time;
    return fmi2OK;
}

EXPORTED fmi2Status fmi2SetContinuousStates(fmi2Component given, const fmi2Real states[],
                                            size_t number)
{
    instance *it = given;
    if (number != STATES) {
        return told2(it, "this FMU has another number of states");
    }
    memcpy(it->now.y, states, number * sizeof *states);
    return fmi2OK;
}

EXPORTED fmi2Status fmi2GetContinuousStates(fmi2Component given, fmi2Real states[], size_t number)
{
    const instance *it = given;
    if (number != STATES) {
        return told2(it, "this FMU has another number of states");
    }
    memcpy(states, it->now.y, number * sizeof *states);
    return fmi2OK;
}

EXPORTED fmi2Status fmi2GetDerivatives(fmi2Component it, fmi2Real rates[], size_t number)
{
    evaluation found;
    if (number != STATES) {
        return told2(it, "this FMU has another number of states");
    }
    found = evaluated(it);
    memcpy(rates, found.rate, sizeof found.rate);
    return fmi2OK;
}

EXPORTED fmi2Status fmi2GetEventIndicators(fmi2Component it, fmi2Real indicators[], size_t number)
{
    evaluation found;
    if (number != INDICATORS) {
        return told2(it, "this FMU has another number of event indicators");
    }
    found = evaluated(it);
    memcpy(indicators, found.indicator, sizeof found.indicator);
    return fmi2OK;
}

EXPORTED fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component it, fmi2Real nominals[],
                                                      size_t number)
{
    if (number != STATES) {
        return told2(it, "this FMU has another number of states");
    }
    memcpy(nominals, NOMINAL, number * sizeof *nominals);
    return fmi2OK;
}
#else
NOT_THERE2(fmi2NewDiscreteStates, fmi2EventInfo *a)
NOT_THERE2(fmi2CompletedIntegratorStep, fmi2Boolean a, fmi2Boolean *b, fmi2Boolean *c)
NOT_THERE2(fmi2SetTime, fmi2Real a)
NOT_THERE2(fmi2SetContinuousStates, const fmi2Real *a, size_t b)
NOT_THERE2(fmi2GetContinuousStates, fmi2Real *a, size_t b)
NOT_THERE2(fmi2GetDerivatives, fmi2Real *a, size_t b)
NOT_THERE2(fmi2GetEventIndicators, fmi2Real *a, size_t b)
NOT_THERE2(fmi2GetNominalsOfContinuousStates, fmi2Real *a, size_t b)
#endif
