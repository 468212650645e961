/*
 * A hydraulic gear machine from tables: FMI 2.0 for co-simulation, C99, no other dependency.
 *
 * The tables in machine_data.h hold what steady runs of the machine gave over pressure
 * difference and shaft speed: how far flows and torque are from those of the ideal machine
 *
 *     flow = displacement * speed,     torque = displacement * pressure difference,
 *
 * and their ripple over one period of the shaft angle. Both are interpolated linearly. The
 * ideal part is exact at any speed and pressure, so a machine at rest delivers nothing.
 *
 * Beyond the tables the losses are those of the nearest edge. Below the lowest pressure
 * difference leakage falls to zero in proportion and then changes its sign; friction always
 * opposes the motion: no quadrant gives power away. Every excursion is logged as a warning.
 *
 * Compile with   cc -std=c99 -O2 -fPIC -shared machine.c -lm
 * or, to link it into a program, with -DFMI2_FUNCTION_PREFIX=name_
 */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "machine_data.h"

/* ---- FMI 2.0, as far as a unit needs it ------------------------------------------------- */

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef unsigned int fmi2ValueReference;
typedef void (*Logger)(void *environment, fmi2String instance, fmi2Status status,
                       fmi2String category, fmi2String message, ...);
typedef struct {
    Logger logger;
    void *(*allocateMemory)(size_t count, size_t size);
    void (*freeMemory)(void *object);
    void (*stepFinished)(void *environment, fmi2Status status);
    void *environment;
} fmi2CallbackFunctions;

#ifdef FMI2_FUNCTION_PREFIX
#define JOINED(prefix, name) prefix##name
#define PREFIXED(prefix, name) JOINED(prefix, name)
#define FMI(name) PREFIXED(FMI2_FUNCTION_PREFIX, name)
#elif defined _WIN32
#define FMI(name) __declspec(dllexport) name
#else
#define FMI(name) name
#endif

/* ---- The machine ------------------------------------------------------------------------ */

#define TURN 6.283185307179586
#define LONGEST_STEP 1e-4             /* of a shaft that its torques move [s] */
#define LARGEST_TURN (PERIOD / 24.0)  /* in one such step [rad] */

typedef struct {
    double real[REAL_COUNT];
    int boolean[BOOLEAN_COUNT];
    double angle, speed;  /* of the shaft [rad, rad/s] */
    double time, outside; /* simulated, and of that beyond the tables [s] */
    int running, warned;
} State;

typedef struct {
    State state;
    fmi2CallbackFunctions callbacks;
    char name[128];
} Machine;

typedef struct {
    int cell;
    double share;
} Place; /* of a value on an axis */

static double limited(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

static Place place_on(const double *axis, int count, double value)
{
    int cell = 0;
    while (cell < count - 2 && value > axis[cell + 1])
        cell++;
    double share = (value - axis[cell]) / (axis[cell + 1] - axis[cell]);
    return (Place){cell, limited(share, 0.0, 1.0)};
}

/* Linear in pressure difference and speed, from the values at the corners of a cell. */
static double between(double low_low, double low_high, double high_low, double high_high,
                      double pressure, double speed)
{
    double low = low_low + speed * (low_high - low_low);
    double high = high_low + speed * (high_high - high_low);
    return low + pressure * (high - low);
}

/* Outputs of the machine at its present angle, speed and pressures. */
static void evaluate(State *s)
{
    double *real = s->real;
    const double speed = DRIVEN_BY_TORQUE ? s->speed : real[SHAFT_SPEED];
    const double rise = real[OUTLET_PRESSURE] - real[INLET_PRESSURE];
    const double difference = SIGN * rise; /* that the machine works with */
    const double lowest = fmin(real[INLET_PRESSURE], real[OUTLET_PRESSURE]);
    const Place p = place_on(PRESSURE_AXIS, PRESSURE_COUNT, fabs(difference));
    const Place w = place_on(SPEED_AXIS, SPEED_COUNT, fabs(speed));

    double loss[LOSS_COUNT];
    for (int k = 0; k < LOSS_COUNT; k++)
        loss[k] = between(LOSSES[p.cell][w.cell][k], LOSSES[p.cell][w.cell + 1][k],
                          LOSSES[p.cell + 1][w.cell][k], LOSSES[p.cell + 1][w.cell + 1][k],
                          p.share, w.share);

    /* ripple of flows grows with speed, that of the torque with pressure, as their means do */
    const double held_pressure = limited(fabs(difference), PRESSURE_AXIS[0], HIGHEST_PRESSURE);
    const double held_speed = limited(fabs(speed), SPEED_AXIS[0], HIGHEST_SPEED);
    const double with_speed = s->boolean[RIPPLE] ? speed / held_speed : 0.0;
    const double with_pressure = s->boolean[RIPPLE] ? difference / held_pressure : 0.0;
    double turned = fmod(s->angle, PERIOD) / PERIOD * ANGLE_COUNT;
    if (turned < 0.0)
        turned += ANGLE_COUNT;
    const int first = turned < ANGLE_COUNT ? (int)turned : 0, second = (first + 1) % ANGLE_COUNT;
    const double part = turned - floor(turned);
    double ripple[WAVE_COUNT];
    for (int k = 0; k < WAVE_COUNT; k++) {
        double corner[2][2];
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < 2; j++) {
                const double *wave = WAVES[p.cell + i][w.cell + j][k];
                corner[i][j] = wave[first] + part * (wave[second] - wave[first]);
            }
        ripple[k] = between(corner[0][0], corner[0][1], corner[1][0], corner[1][1], p.share,
                            w.share);
    }

    const double leaks = limited(difference / PRESSURE_AXIS[0], -1.0, 1.0);
    const double ideal_flow = DISPLACEMENT * speed;
    const double ideal_torque = DISPLACEMENT * difference;
    const double pulsating = ideal_torque + with_pressure * ripple[TORQUE_WAVE];
    double friction = speed > 0.0 ? loss[FRICTION] : speed < 0.0 ? -loss[FRICTION] : 0.0;
    if (DRIVEN_BY_TORQUE && speed == 0.0) { /* a shaft that sticks carries what acts on it */
        const double most = fmax(loss[FRICTION], 0.0);
        friction = limited(-SIGN * pulsating - real[LOAD_TORQUE], -most, most);
    }
    const double torque = ideal_torque + SIGN * friction;
    const double shaft_power = torque * speed;
    const double hydraulic_power = (ideal_flow - SIGN * leaks * loss[POWER_FLOW]) * difference;
    const double lost = leaks * loss[LOST_FLOW];

    real[INLET_FLOW_RATE] =
        ideal_flow - SIGN * leaks * loss[INLET_SLIP] + with_speed * ripple[INLET_WAVE];
    real[OUTLET_FLOW_RATE] =
        ideal_flow - SIGN * leaks * loss[OUTLET_SLIP] + with_speed * ripple[OUTLET_WAVE];
    real[DRAIN_FLOW_RATE] = leaks * loss[DRAIN_FLOW];
    real[LEAKAGE] = leaks * loss[LEAKAGE_FLOW];
    real[LOST_FLOW_RATE] = lost;
    real[SHAFT_TORQUE] = pulsating + SIGN * friction;
    real[SHAFT_ANGLE] = s->angle;
    real[SHAFT_POWER] = shaft_power;
    real[HYDRAULIC_POWER] = hydraulic_power;
    real[POWER_LOSS] = SIGN * (shaft_power - hydraulic_power);
    if (DRIVEN_BY_TORQUE)
        real[SHAFT_SPEED] = s->speed;

    const double supplied = SIGN > 0 ? shaft_power : hydraulic_power;
    const double delivered = SIGN > 0 ? hydraulic_power : shaft_power;
    const int working = supplied > 0.0 && delivered > 0.0 && ideal_flow > 0.0;
    const double volumetric =
        SIGN > 0 ? (ideal_flow - lost) / ideal_flow : ideal_flow / (ideal_flow + lost);
    const double overall = delivered / supplied;
    real[VOLUMETRIC_EFFICIENCY] = working ? volumetric : 0.0;
    real[OVERALL_EFFICIENCY] = working ? overall : 0.0;
    real[HYDROMECHANICAL_EFFICIENCY] = working ? overall / volumetric : 0.0;

    s->boolean[WITHIN_TABLE] = difference >= PRESSURE_AXIS[0] * (1.0 - ROUNDING) &&
                               difference <= HIGHEST_PRESSURE * (1.0 + ROUNDING) &&
                               speed >= SPEED_AXIS[0] * (1.0 - ROUNDING) &&
                               speed <= HIGHEST_SPEED * (1.0 + ROUNDING) &&
                               lowest >= LOW_PRESSURE * (1.0 - ROUNDING);
}

/* Acceleration of a free shaft [rad/s2]: the machine drives it (motor) or is driven (pump). */
static double acceleration(State *s, double angle, double speed)
{
    s->angle = angle;
    s->speed = speed;
    evaluate(s);
    return (-SIGN * s->real[SHAFT_TORQUE] - s->real[LOAD_TORQUE]) / s->real[SHAFT_INERTIA];
}

/* Turn the shaft by a step of time; a free shaft by the midpoint rule, and it may stick. */
static void turn(State *s, double step)
{
    if (!DRIVEN_BY_TORQUE) {
        s->angle += s->real[SHAFT_SPEED] * step;
        return;
    }
    while (step > 0.0) {
        const double angle = s->angle, speed = s->speed;
        const double fastest = fmax(fabs(speed), LARGEST_TURN / LONGEST_STEP);
        const double part = fmin(step, LARGEST_TURN / fastest);
        const double middle = speed + 0.5 * part * acceleration(s, angle, speed);
        double next = speed + part * acceleration(s, angle + 0.5 * part * speed, middle);
        if (speed * next < 0.0 || speed * middle < 0.0)
            next = 0.0; /* friction stops a shaft before it turns back */
        s->angle = angle + 0.5 * part * (speed + next);
        s->speed = next;
        step = part < step ? step - part : 0.0;
    }
}

static void begin(State *s)
{
    s->angle = s->real[SHAFT_ANGLE_START];
    s->speed = s->real[SHAFT_SPEED_START];
}

static void complain(Machine *m, fmi2Status status, const char *message)
{
    const char *category = status == fmi2Warning ? "logStatusWarning" : "logStatusError";
    if (m->callbacks.logger != NULL)
        m->callbacks.logger(m->callbacks.environment, m->name, status, category, "%s", message);
}

/* Warn when the machine first leaves its tables; within_table and the end tell of the rest. */
static void watch(Machine *m, double step)
{
    State *s = &m->state;
    char text[400];
    if (s->boolean[WITHIN_TABLE])
        return;
    s->outside += step;
    if (s->warned)
        return;
    s->warned = 1;
    snprintf(text, sizeof text,
             "Beyond the tables at %.6g s: %.4g bar to %.4g bar at %.5g rpm, tabulated are "
             "differences of %.4g to %.4g bar above %.4g bar at %.5g to %.5g rpm. Losses are "
             "those of the edge.",
             s->time, s->real[INLET_PRESSURE] * 1e-5, s->real[OUTLET_PRESSURE] * 1e-5,
             s->real[SHAFT_SPEED] * 60.0 / TURN, PRESSURE_AXIS[0] * 1e-5, HIGHEST_PRESSURE * 1e-5,
             LOW_PRESSURE * 1e-5, SPEED_AXIS[0] * 60.0 / TURN, HIGHEST_SPEED * 60.0 / TURN);
    complain(m, fmi2Warning, text);
}

static int sound(Machine *m)
{
    if (!DRIVEN_BY_TORQUE || m->state.real[SHAFT_INERTIA] > 0.0)
        return 1;
    complain(m, fmi2Error, "shaft_inertia: found zero or less, allowed above zero.");
    return 0;
}

static void reset(Machine *m)
{
    memset(&m->state, 0, sizeof m->state);
    memcpy(m->state.real, REAL_START, sizeof REAL_START);
    m->state.boolean[RIPPLE] = 1;
}

/* ---- Functions of the interface --------------------------------------------------------- */

fmi2String FMI(fmi2GetTypesPlatform)(void) { return "default"; }
fmi2String FMI(fmi2GetVersion)(void) { return "2.0"; }

void *FMI(fmi2Instantiate)(fmi2String name, int kind, fmi2String token, fmi2String resources,
                           const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                           fmi2Boolean logging)
{
    (void)resources, (void)visible, (void)logging;
    Machine *m = calloc(1, sizeof *m);
    if (m == NULL)
        return NULL;
    if (callbacks != NULL)
        m->callbacks = *callbacks;
    strncpy(m->name, name != NULL ? name : MODEL_NAME, sizeof m->name - 1);
    if (kind != 1 || token == NULL || strcmp(token, TOKEN) != 0) {
        complain(m, fmi2Error, kind != 1 ? "This unit is for co-simulation only."
                                         : "The binary does not belong to modelDescription.xml.");
        free(m);
        return NULL;
    }
    reset(m);
    return m;
}

void FMI(fmi2FreeInstance)(void *m) { free(m); }

fmi2Status FMI(fmi2SetDebugLogging)(void *m, fmi2Boolean on, size_t count,
                                    const fmi2String *categories)
{
    (void)m, (void)on, (void)count, (void)categories;
    return fmi2OK;
}

fmi2Status FMI(fmi2SetupExperiment)(void *m, fmi2Boolean tolerant, fmi2Real tolerance,
                                    fmi2Real start, fmi2Boolean ends, fmi2Real stop)
{
    (void)tolerant, (void)tolerance, (void)ends, (void)stop;
    ((Machine *)m)->state.time = start;
    return fmi2OK;
}

fmi2Status FMI(fmi2EnterInitializationMode)(void *m) { return (void)m, fmi2OK; }

fmi2Status FMI(fmi2ExitInitializationMode)(void *component)
{
    Machine *m = component;
    if (!sound(m))
        return fmi2Error;
    begin(&m->state);
    m->state.running = 1;
    return fmi2OK;
}

fmi2Status FMI(fmi2DoStep)(void *component, fmi2Real time, fmi2Real step, fmi2Boolean final)
{
    Machine *m = component;
    (void)final;
    if (!sound(m) || !(step >= 0.0) || !isfinite(step))
        return fmi2Error;
    m->state.time = time;
    evaluate(&m->state);
    watch(m, step);
    turn(&m->state, step);
    m->state.time = time + step;
    evaluate(&m->state);
    watch(m, 0.0);
    return fmi2OK;
}

fmi2Status FMI(fmi2Terminate)(void *component)
{
    Machine *m = component;
    char text[120];
    if (m->state.outside > 0.0) {
        snprintf(text, sizeof text, "Beyond the tables for %.6g s in all.", m->state.outside);
        complain(m, fmi2Warning, text);
    }
    return fmi2OK;
}

fmi2Status FMI(fmi2Reset)(void *m) { return reset(m), fmi2OK; }
fmi2Status FMI(fmi2CancelStep)(void *m) { return (void)m, fmi2Error; }

/* Outputs follow inputs at once, also while the unit is being initialised. */
static void refresh(State *s)
{
    if (!s->running)
        begin(s);
    evaluate(s);
}

#define FOR_EVERY(count_of_kind, action)                                                        \
    for (size_t k = 0; k < count; k++) {                                                        \
        if (references[k] >= (count_of_kind))                                                   \
            return fmi2Error;                                                                   \
        action;                                                                                 \
    }                                                                                           \
    return fmi2OK

fmi2Status FMI(fmi2GetReal)(void *m, const fmi2ValueReference *references, size_t count,
                            fmi2Real *values)
{
    State *s = &((Machine *)m)->state;
    refresh(s);
    FOR_EVERY(REAL_COUNT, values[k] = s->real[references[k]]);
}

fmi2Status FMI(fmi2GetBoolean)(void *m, const fmi2ValueReference *references, size_t count,
                               fmi2Boolean *values)
{
    State *s = &((Machine *)m)->state;
    refresh(s);
    FOR_EVERY(BOOLEAN_COUNT, values[k] = s->boolean[references[k]]);
}

fmi2Status FMI(fmi2SetReal)(void *component, const fmi2ValueReference *references, size_t count,
                            const fmi2Real *values)
{
    Machine *m = component;
    for (size_t k = 0; k < count; k++)
        if (!isfinite(values[k])) {
            complain(m, fmi2Error, "An input or parameter is not a finite number.");
            return fmi2Error;
        }
    FOR_EVERY(GIVEN_COUNT, m->state.real[references[k]] = values[k]);
}

fmi2Status FMI(fmi2SetBoolean)(void *m, const fmi2ValueReference *references, size_t count,
                               const fmi2Boolean *values)
{
    State *s = &((Machine *)m)->state;
    FOR_EVERY(WITHIN_TABLE, s->boolean[references[k]] = values[k] != 0);
}

/* Masters that reject steps keep the state of the unit and put it back. */
fmi2Status FMI(fmi2GetFMUstate)(void *m, void **kept)
{
    if (*kept == NULL && (*kept = malloc(sizeof(State))) == NULL)
        return fmi2Error;
    memcpy(*kept, &((Machine *)m)->state, sizeof(State));
    return fmi2OK;
}

fmi2Status FMI(fmi2SetFMUstate)(void *m, void *kept)
{
    memcpy(&((Machine *)m)->state, kept, sizeof(State));
    return fmi2OK;
}

fmi2Status FMI(fmi2FreeFMUstate)(void *m, void **kept)
{
    (void)m;
    free(*kept);
    *kept = NULL;
    return fmi2OK;
}

/* What FMI 2.0 wants to be there and this unit has not. */
#define ABSENT(name, ...)                                                                       \
    fmi2Status FMI(name)(void *m, __VA_ARGS__) { return (void)m, fmi2Error; }
typedef const fmi2ValueReference *References;

ABSENT(fmi2GetInteger, References r, size_t n, fmi2Integer *v)
ABSENT(fmi2SetInteger, References r, size_t n, const fmi2Integer *v)
ABSENT(fmi2GetString, References r, size_t n, fmi2String *v)
ABSENT(fmi2SetString, References r, size_t n, const fmi2String *v)
ABSENT(fmi2SerializedFMUstateSize, void *s, size_t *n)
ABSENT(fmi2SerializeFMUstate, void *s, fmi2Byte *b, size_t n)
ABSENT(fmi2DeSerializeFMUstate, const fmi2Byte *b, size_t n, void **s)
ABSENT(fmi2GetDirectionalDerivative, References u, size_t n, References k, size_t c,
       const fmi2Real *d, fmi2Real *v)
ABSENT(fmi2SetRealInputDerivatives, References r, size_t n, const fmi2Integer *o,
       const fmi2Real *v)
ABSENT(fmi2GetRealOutputDerivatives, References r, size_t n, const fmi2Integer *o, fmi2Real *v)
ABSENT(fmi2GetStatus, int kind, fmi2Status *v)
ABSENT(fmi2GetRealStatus, int kind, fmi2Real *v)
ABSENT(fmi2GetIntegerStatus, int kind, fmi2Integer *v)
ABSENT(fmi2GetBooleanStatus, int kind, fmi2Boolean *v)
ABSENT(fmi2GetStringStatus, int kind, fmi2String *v)
