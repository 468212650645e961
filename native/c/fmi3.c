/* FMI 3.0 for co-simulation, with events of the shaft. */
#include "unit.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef FMI3_FUNCTION_PREFIX
#define FMI(name) PREFIXED(FMI3_FUNCTION_PREFIX, name)
#else
#define FMI(name) name
#endif
#define STATUS UNIT_EXPORT fmi3Status

typedef int fmi3Status;
typedef const char *fmi3String;
typedef const unsigned *references;
typedef void (*fmi3Logger)(void *environment, fmi3Status status, fmi3String category,
                           fmi3String message);

static void tell(unit *u, int status, const char *text)
{
    if (u->logger)
        ((fmi3Logger)u->logger)(u->environment, status, "logStatusError", text);
}

UNIT_EXPORT fmi3String FMI(fmi3GetVersion)(void) { return "3.0"; }

UNIT_EXPORT void *FMI(fmi3InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resources, bool visible, bool logging,
    bool with_events, bool early_return, references intermediate, size_t count, void *environment,
    fmi3Logger logger, void *update)
{
    (void)visible, (void)logging, (void)intermediate, (void)count, (void)update;
    unit given = {.tell = tell, .stops = with_events && early_return, .environment = environment};
    char path[1024] = {0};
    given.logger = (void (*)(void))logger;
    strncpy(given.name, name ? name : "", sizeof given.name - 1);
    strncpy(path, resources ? resources : "", sizeof path - 1);
    size_t end = strlen(path);
    while (end > 1 && (path[end - 1] == '/' || path[end - 1] == '\\'))
        path[--end] = 0;
    return unit_create(&given, path, token);
}

UNIT_EXPORT void *FMI(fmi3InstantiateModelExchange)(fmi3String name, fmi3String token,
                                                    fmi3String resources, bool visible,
                                                    bool logging, void *environment,
                                                    fmi3Logger logger)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging;
    (void)environment, (void)logger;
    return NULL;
}

UNIT_EXPORT void *FMI(fmi3InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resources, bool visible, bool logging,
    void *environment, fmi3Logger logger, void *clock, void *lock, void *unlock)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging;
    (void)environment, (void)logger, (void)clock, (void)lock, (void)unlock;
    return NULL;
}

UNIT_EXPORT void FMI(fmi3FreeInstance)(void *u) { unit_destroy(u); }

STATUS FMI(fmi3SetDebugLogging)(void *u, bool on, size_t count, const fmi3String *kinds)
{
    (void)u, (void)on, (void)count, (void)kinds;
    return UNIT_OK;
}

STATUS FMI(fmi3EnterInitializationMode)(void *u, bool tolerant, double tolerance, double start,
                                        bool ends, double stop)
{
    (void)tolerant, (void)tolerance, (void)ends, (void)stop;
    ((unit *)u)->start = start;
    return UNIT_OK;
}

STATUS FMI(fmi3ExitInitializationMode)(void *u) { return (void)u, UNIT_OK; }
STATUS FMI(fmi3EnterEventMode)(void *u) { return (void)u, UNIT_OK; }
STATUS FMI(fmi3EnterStepMode)(void *u) { return (void)u, UNIT_OK; }
STATUS FMI(fmi3Terminate)(void *u) { return (void)u, UNIT_OK; }
STATUS FMI(fmi3Reset)(void *u) { return unit_reset(u); }

STATUS FMI(fmi3UpdateDiscreteStates)(void *u, bool *again, bool *ends, bool *nominals,
                                     bool *values, bool *timed, double *next)
{
    (void)u, (void)next;
    *again = *ends = *nominals = *values = *timed = false;
    return UNIT_OK;
}

STATUS FMI(fmi3DoStep)(void *u, double time, double step, bool no_return, bool *event, bool *ends,
                       bool *early, double *reached)
{
    (void)no_return;
    int status = unit_step(u, time + step, reached);
    *ends = false;
    *early = *event = status == UNIT_OK && *reached < time + step;
    return status;
}

STATUS FMI(fmi3GetFloat64)(void *u, references r, size_t n, double *v, size_t count)
{
    return n == count ? unit_get(u, r, n, v) : UNIT_ERROR;
}

STATUS FMI(fmi3SetFloat64)(void *u, references r, size_t n, const double *v, size_t count)
{
    return n == count ? unit_set(u, r, n, v) : UNIT_ERROR;
}

STATUS FMI(fmi3GetDirectionalDerivative)(void *u, references unknowns, size_t outputs,
                                         references knowns, size_t inputs, const double *seed,
                                         size_t seeds, double *derivative, size_t derivatives)
{
    if (inputs != seeds || outputs != derivatives)
        return UNIT_ERROR;
    return unit_derivative(u, unknowns, outputs, knowns, inputs, seed, derivative);
}

STATUS FMI(fmi3GetFMUState)(void *u, void **state) { return unit_keep(u, state); }
STATUS FMI(fmi3SetFMUState)(void *u, void *state) { return unit_put_back(u, state); }

STATUS FMI(fmi3FreeFMUState)(void *u, void **state)
{
    (void)u;
    free(*state);
    *state = NULL;
    return UNIT_OK;
}

STATUS FMI(fmi3SerializedFMUStateSize)(void *u, void *state, size_t *size)
{
    (void)state;
    *size = unit_state_size(u);
    return UNIT_OK;
}

STATUS FMI(fmi3SerializeFMUState)(void *u, void *state, uint8_t *bytes, size_t size)
{
    if (size < unit_state_size(u))
        return UNIT_ERROR;
    memcpy(bytes, state, unit_state_size(u));
    return UNIT_OK;
}

STATUS FMI(fmi3DeserializeFMUState)(void *u, const uint8_t *bytes, size_t size, void **state)
{
    if (size != unit_state_size(u) || (!*state && !(*state = malloc(size))))
        return UNIT_ERROR;
    memcpy(*state, bytes, size);
    return UNIT_OK;
}

/* Outputs follow inputs through a step only, so none depends on another variable. */
STATUS FMI(fmi3GetNumberOfVariableDependencies)(void *u, unsigned reference, size_t *count)
{
    (void)u, (void)reference;
    *count = 0;
    return UNIT_OK;
}

STATUS FMI(fmi3GetVariableDependencies)(void *u, unsigned dependent, size_t *of_dependent,
                                        unsigned *independents, size_t *of_independents,
                                        int *kinds, size_t count)
{
    (void)u, (void)dependent, (void)of_dependent, (void)independents, (void)of_independents;
    (void)kinds, (void)count;
    return UNIT_OK;
}

/* What FMI 3.0 wants to be there and this unit has not; to ask for nothing is no error. */
#define VALUES(name, type)                                                                      \
    STATUS FMI(fmi3Get##name)(void *u, references r, size_t n, type *v, size_t count)           \
    {                                                                                           \
        (void)u, (void)r, (void)v, (void)count;                                                 \
        return n ? UNIT_ERROR : UNIT_OK;                                                        \
    }                                                                                           \
    STATUS FMI(fmi3Set##name)(void *u, references r, size_t n, const type *v, size_t count)     \
    {                                                                                           \
        (void)u, (void)r, (void)v, (void)count;                                                 \
        return n ? UNIT_ERROR : UNIT_OK;                                                        \
    }
#define ABSENT(name, ...)                                                                       \
    STATUS FMI(name)(void *u, __VA_ARGS__) { return (void)u, UNIT_ERROR; }

VALUES(Float32, float)
VALUES(Int8, int8_t)
VALUES(UInt8, uint8_t)
VALUES(Int16, int16_t)
VALUES(UInt16, uint16_t)
VALUES(Int32, int32_t)
VALUES(UInt32, uint32_t)
VALUES(Int64, int64_t)
VALUES(UInt64, uint64_t)
VALUES(Boolean, bool)
VALUES(String, fmi3String)
ABSENT(fmi3GetBinary, references r, size_t n, size_t *s, const uint8_t **v, size_t count)
ABSENT(fmi3SetBinary, references r, size_t n, const size_t *s, const uint8_t **v, size_t count)
ABSENT(fmi3GetClock, references r, size_t n, bool *v)
ABSENT(fmi3SetClock, references r, size_t n, const bool *v)
ABSENT(fmi3GetAdjointDerivative, references o, size_t n, references k, size_t c, const double *s,
       size_t m, double *v, size_t l)
ABSENT(fmi3GetIntervalDecimal, references r, size_t n, double *v, int *q)
ABSENT(fmi3GetIntervalFraction, references r, size_t n, uint64_t *v, uint64_t *w, int *q)
ABSENT(fmi3GetShiftDecimal, references r, size_t n, double *v)
ABSENT(fmi3GetShiftFraction, references r, size_t n, uint64_t *v, uint64_t *w)
ABSENT(fmi3SetIntervalDecimal, references r, size_t n, const double *v)
ABSENT(fmi3SetIntervalFraction, references r, size_t n, const uint64_t *v, const uint64_t *w)
ABSENT(fmi3SetShiftDecimal, references r, size_t n, const double *v)
ABSENT(fmi3SetShiftFraction, references r, size_t n, const uint64_t *v, const uint64_t *w)
ABSENT(fmi3GetOutputDerivatives, references r, size_t n, const int32_t *o, double *v, size_t c)
ABSENT(fmi3CompletedIntegratorStep, bool last, bool *event, bool *ends)
ABSENT(fmi3SetTime, double time)
ABSENT(fmi3SetContinuousStates, const double *v, size_t n)
ABSENT(fmi3GetContinuousStateDerivatives, double *v, size_t n)
ABSENT(fmi3GetEventIndicators, double *v, size_t n)
ABSENT(fmi3GetContinuousStates, double *v, size_t n)
ABSENT(fmi3GetNominalsOfContinuousStates, double *v, size_t n)
ABSENT(fmi3GetNumberOfEventIndicators, size_t *n)
ABSENT(fmi3GetNumberOfContinuousStates, size_t *n)
ABSENT(fmi3ActivateModelPartition, unsigned clock, double time)
STATUS FMI(fmi3EvaluateDiscreteStates)(void *u) { return (void)u, UNIT_OK; }
STATUS FMI(fmi3EnterConfigurationMode)(void *u) { return (void)u, UNIT_OK; }
STATUS FMI(fmi3ExitConfigurationMode)(void *u) { return (void)u, UNIT_OK; }
STATUS FMI(fmi3EnterContinuousTimeMode)(void *u) { return (void)u, UNIT_ERROR; }
