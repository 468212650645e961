/* FMI 2.0 for co-simulation. */
#include "unit.h"

#include <stdlib.h>
#include <string.h>

#ifdef FMI2_FUNCTION_PREFIX
#define FMI(name) PREFIXED(FMI2_FUNCTION_PREFIX, name)
#else
#define FMI(name) name
#endif
#define STATUS UNIT_EXPORT fmi2Status

typedef int fmi2Status, fmi2Integer, fmi2Boolean;
typedef double fmi2Real;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef const unsigned *references;
typedef void (*fmi2Logger)(void *environment, fmi2String name, fmi2Status status,
                           fmi2String category, fmi2String message, ...);
typedef struct {
    fmi2Logger logger;
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *object);
    void (*finished)(void *environment, fmi2Status status);
    void *environment;
} fmi2Callbacks;

static void tell(unit *u, int status, const char *text)
{
    if (u->logger)
        ((fmi2Logger)u->logger)(u->environment, u->name, status, "logStatusError", "%s", text);
}

/* Path of a file URI: without its scheme, and with its escaped characters. */
static void path_of(const char *uri, char *path, size_t size)
{
    size_t k = 0;
    if (uri && strncmp(uri, "file:", 5) == 0) {
        uri += 5;
        if (strncmp(uri, "//", 2) == 0)
            for (uri += 2; *uri && *uri != '/'; uri++) /* the host */
                ;
#ifdef _WIN32
        uri += uri[0] == '/' && uri[1] && uri[2] == ':';
#endif
    }
    for (; uri && *uri && k + 1 < size; uri++) {
        char digits[3] = {0};
        if (*uri == '%' && uri[1] && uri[2]) {
            memcpy(digits, uri + 1, 2);
            uri += 2;
        }
        path[k++] = digits[0] ? (char)strtol(digits, NULL, 16) : *uri;
    }
    while (k > 1 && path[k - 1] == '/')
        k--;
    path[k] = 0;
}

UNIT_EXPORT fmi2String FMI(fmi2GetTypesPlatform)(void) { return "default"; }
UNIT_EXPORT fmi2String FMI(fmi2GetVersion)(void) { return "2.0"; }

UNIT_EXPORT void *FMI(fmi2Instantiate)(fmi2String name, int kind, fmi2String token,
                                       fmi2String resources, const fmi2Callbacks *callbacks,
                                       fmi2Boolean visible, fmi2Boolean logging)
{
    (void)visible, (void)logging;
    char path[1024];
    unit given = {.tell = tell};
    strncpy(given.name, name ? name : "", sizeof given.name - 1);
    if (callbacks) {
        given.logger = (void (*)(void))callbacks->logger;
        given.environment = callbacks->environment;
    }
    if (kind != 1) {
        tell(&given, UNIT_ERROR, "This unit is for co-simulation only.");
        return NULL;
    }
    path_of(resources, path, sizeof path);
    return unit_create(&given, path, token);
}

UNIT_EXPORT void FMI(fmi2FreeInstance)(void *u) { unit_destroy(u); }

STATUS FMI(fmi2SetDebugLogging)(void *u, fmi2Boolean on, size_t count, const fmi2String *kinds)
{
    (void)u, (void)on, (void)count, (void)kinds;
    return UNIT_OK;
}

STATUS FMI(fmi2SetupExperiment)(void *u, fmi2Boolean tolerant, fmi2Real tolerance, fmi2Real start,
                                fmi2Boolean ends, fmi2Real stop)
{
    (void)tolerant, (void)tolerance, (void)ends, (void)stop;
    ((unit *)u)->start = start;
    return UNIT_OK;
}

STATUS FMI(fmi2EnterInitializationMode)(void *u) { return (void)u, UNIT_OK; }
STATUS FMI(fmi2ExitInitializationMode)(void *u) { return (void)u, UNIT_OK; }
STATUS FMI(fmi2Terminate)(void *u) { return (void)u, UNIT_OK; }
STATUS FMI(fmi2Reset)(void *u) { return unit_reset(u); }

STATUS FMI(fmi2DoStep)(void *u, fmi2Real time, fmi2Real step, fmi2Boolean final)
{
    double reached;
    (void)final;
    return unit_step(u, time + step, &reached);
}

STATUS FMI(fmi2GetReal)(void *u, references r, size_t n, fmi2Real *v)
{
    return unit_get(u, r, n, v);
}

STATUS FMI(fmi2SetReal)(void *u, references r, size_t n, const fmi2Real *v)
{
    return unit_set(u, r, n, v);
}

STATUS FMI(fmi2GetDirectionalDerivative)(void *u, references unknowns, size_t outputs,
                                         references knowns, size_t inputs, const fmi2Real *seed,
                                         fmi2Real *derivative)
{
    return unit_derivative(u, unknowns, outputs, knowns, inputs, seed, derivative);
}

STATUS FMI(fmi2GetFMUstate)(void *u, void **state) { return unit_keep(u, state); }
STATUS FMI(fmi2SetFMUstate)(void *u, void *state) { return unit_put_back(u, state); }

STATUS FMI(fmi2FreeFMUstate)(void *u, void **state)
{
    (void)u;
    free(*state);
    *state = NULL;
    return UNIT_OK;
}

STATUS FMI(fmi2SerializedFMUstateSize)(void *u, void *state, size_t *size)
{
    (void)state;
    *size = unit_state_size(u);
    return UNIT_OK;
}

STATUS FMI(fmi2SerializeFMUstate)(void *u, void *state, fmi2Byte *bytes, size_t size)
{
    if (size < unit_state_size(u))
        return UNIT_ERROR;
    memcpy(bytes, state, unit_state_size(u));
    return UNIT_OK;
}

STATUS FMI(fmi2DeSerializeFMUstate)(void *u, const fmi2Byte *bytes, size_t size, void **state)
{
    if (size != unit_state_size(u) || (!*state && !(*state = malloc(size))))
        return UNIT_ERROR;
    memcpy(*state, bytes, size);
    return UNIT_OK;
}

/* What FMI 2.0 wants to be there and this unit has not; to ask for nothing is no error. */
#define NONE(name, type)                                                                        \
    STATUS FMI(name)(void *u, references r, size_t n, type v)                                   \
    {                                                                                           \
        (void)u, (void)r, (void)v;                                                              \
        return n ? UNIT_ERROR : UNIT_OK;                                                        \
    }
#define ABSENT(name, ...)                                                                       \
    STATUS FMI(name)(void *u, __VA_ARGS__) { return (void)u, UNIT_ERROR; }

NONE(fmi2GetInteger, fmi2Integer *)
NONE(fmi2GetBoolean, fmi2Boolean *)
NONE(fmi2GetString, fmi2String *)
NONE(fmi2SetInteger, const fmi2Integer *)
NONE(fmi2SetBoolean, const fmi2Boolean *)
NONE(fmi2SetString, const fmi2String *)
ABSENT(fmi2SetRealInputDerivatives, references r, size_t n, const fmi2Integer *o,
       const fmi2Real *v)
ABSENT(fmi2GetRealOutputDerivatives, references r, size_t n, const fmi2Integer *o, fmi2Real *v)
ABSENT(fmi2GetStatus, int kind, fmi2Status *v)
ABSENT(fmi2GetRealStatus, int kind, fmi2Real *v)
ABSENT(fmi2GetIntegerStatus, int kind, fmi2Integer *v)
ABSENT(fmi2GetBooleanStatus, int kind, fmi2Boolean *v)
ABSENT(fmi2GetStringStatus, int kind, fmi2String *v)
STATUS FMI(fmi2CancelStep)(void *u) { return (void)u, UNIT_ERROR; }
