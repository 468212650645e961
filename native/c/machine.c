/* The machine model behind the functions of toothspace.h.
 *
 * A file of a machine holds the block of words that the entry `solver.compiled_model._run` reads,
 * and the memory of all arrays that the block describes; places of what this layer reads and
 * writes stand at its head. Making a machine is reading the file and turning places into
 * addresses.
 */
#include "toothspace.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAGIC "TOOTHSP1"
#define NAME 40
#define RESTARTED_AT 1e-3 /* part by which an input moves the integration to its first order */
#define SAME_SLOPE 1e-9   /* part within which a speed goes on along its line */
#define FOREVER 1e12      /* end of that line [s] */
#define SIDEWAYS 1e-3     /* part by which inputs are moved for a derivative */

enum task { BEGIN, ADVANCE, OBSERVE, PLACE, CONTACTS, EVALUATE, HOLD, MOVING, WALLS, PRESSURE };
enum role { PORT_PRESSURE, SHAFT_SPEED, LOAD_TORQUE, NUMBER, FLOW, PORT_FLOW, INERTIA };

extern int32_t toothspace_solver_compiled_model__run(void *result, void **failure,
                                                     const void *words);
extern const char *toothspace_table;

/* Sizes and places at the head of a file: words are counted, memory is in bytes. */
typedef struct {
    char magic[8], digest[16];
    int64_t words, addresses, bytes, variables, inputs, states;
    int64_t word_task, word_time;                         /* arguments of the entry */
    int64_t state, times, now;                            /* arrays that it takes */
    int64_t sample_time, counts, reached, valid_until;    /* of the integration */
    int64_t free_shaft, direction, driving, holding, breakaway, load; /* of the shaft */
    int64_t knots;                                        /* two rows of time and speed, or -1 */
} head;

typedef struct {
    char name[NAME], unit[16];
    int64_t role, place, density, other; /* of a port its node and its density */
    double factor; /* of inertia what the machine itself has */
} variable;

struct toothspace_machine {
    head at;
    variable *variables;
    int64_t *words, *addresses; /* addresses: number of the word, place in memory */
    char *memory;
    double *values, *masses; /* of variables; of ports at the begin of the step */
    double time;
    int restart;
};

static double *number(const toothspace_machine *m, int64_t place)
{
    return (double *)(m->memory + place);
}

static double run(toothspace_machine *m, enum task task, double time)
{
    double result = 0.0;
    void *failure = NULL;
    m->words[m->at.word_task] = task;
    memcpy(&m->words[m->at.word_time], &time, sizeof time);
    if (toothspace_solver_compiled_model__run(&result, &failure, m->words) != 0)
        return TOOTHSPACE_NOT_FINITE;
    return result;
}

static void set_state(toothspace_machine *m)
{
    memcpy(number(m, m->at.state), number(m, m->at.reached), sizeof(double) * m->at.states);
}

/* Let the shaft stick if it is at rest and friction can hold it; else set its direction. */
static void settle(toothspace_machine *m)
{
    double *state = number(m, m->at.state), *direction = number(m, m->at.direction);
    *direction = (state[1] > 0.0) - (state[1] < 0.0);
    if (*number(m, m->at.free_shaft) == 0.0 || state[1] != 0.0)
        return;
    run(m, HOLD, m->time);
    double driving = *number(m, m->at.driving);
    double holding = *number(m, m->at.breakaway) > 0.0 ? *number(m, m->at.holding) : 0.0;
    *direction = fabs(driving) <= holding ? 0.0 : (driving > 0.0 ? 1.0 : -1.0);
}

/* Outputs at the state that the integration has reached. */
static void observe(toothspace_machine *m, double step)
{
    memcpy(number(m, m->at.now), number(m, m->at.reached), sizeof(double) * m->at.states);
    *number(m, m->at.times) = m->time;
    run(m, OBSERVE, 0.0);
    for (int64_t k = m->at.inputs; k < m->at.variables; k++) {
        const variable *v = &m->variables[k];
        double now = *number(m, v->place);
        if (v->role == FLOW) {
            double moved = now - m->masses[k];
            m->masses[k] = now;
            m->values[k] = step > 0.0 ? v->factor * moved / step / *number(m, v->density) : 0.0;
        } else {
            m->values[k] = v->factor * now;
        }
    }
}

/* Lead the speed along a straight line to its value at the end of the step. */
static void take_speed(toothspace_machine *m, double value, double end)
{
    double *knots = number(m, m->at.knots), now = number(m, m->at.reached)[1];
    double slope = (value - now) / (end - m->time);
    double former = (knots[3] - knots[1]) / (knots[2] - knots[0]);
    double change = fabs(slope - former) * (end - m->time), size = fmax(fabs(value), fabs(now));
    if (change <= SAME_SLOPE * size)
        return;
    if (change > RESTARTED_AT * size)
        m->restart = 1;
    knots[0] = m->time, knots[1] = now;
    knots[2] = m->time + FOREVER, knots[3] = now + slope * FOREVER;
    if (now == 0.0)
        *number(m, m->at.direction) = (value > 0.0) - (value < 0.0);
}

/* Hand the inputs to the model. */
static void take_inputs(toothspace_machine *m, double end)
{
    for (int64_t k = 0; k < m->at.inputs; k++) {
        const variable *v = &m->variables[k];
        double value = m->values[k], *place = number(m, v->place);
        if (v->role == PORT_PRESSURE && *place != value) {
            double *given = number(m, m->at.state);
            given[0] = (double)v->other;
            given[1] = value;
            run(m, PRESSURE, m->time);
        } else if (v->role == LOAD_TORQUE) {
            *place = value;
        } else if (v->role == INERTIA) {
            *place = v->factor + value;
        } else if (v->role == PORT_FLOW) {
            place[0] = place[2] = value; /* two rows of time and flow */
        } else if (v->role == SHAFT_SPEED) {
            take_speed(m, value, end);
        }
    }
}

/* The shaft stops or breaks away. */
static void pass_event(toothspace_machine *m)
{
    m->time = *number(m, m->at.valid_until);
    set_state(m);
    double *direction = number(m, m->at.direction), driving = *number(m, m->at.driving);
    if (*direction == 0.0) {
        *direction = (driving > 0.0) - (driving < 0.0);
    } else {
        number(m, m->at.state)[1] = 0.0;
        settle(m);
    }
    memcpy(number(m, m->at.reached), number(m, m->at.state), sizeof(double) * m->at.states);
    run(m, BEGIN, m->time);
}

static int stepped(toothspace_machine *m, double end, int to_event)
{
    if (!(end > m->time) || !isfinite(end))
        return TOOTHSPACE_WRONG_TIME;
    double begin = m->time;
    take_inputs(m, end);
    if (m->restart) {
        set_state(m);
        settle(m);
        run(m, BEGIN, m->time);
        m->restart = 0;
    }
    for (;;) {
        int64_t *counts = (int64_t *)(m->memory + m->at.counts);
        counts[0] = counts[1] = 0;
        *number(m, m->at.sample_time) = end;
        int code = (int)run(m, ADVANCE, end);
        if (code == TOOTHSPACE_DONE)
            break;
        if (code != TOOTHSPACE_EVENT)
            return code;
        pass_event(m);
        if (to_event && m->time < end) {
            observe(m, m->time - begin);
            return TOOTHSPACE_EVENT;
        }
    }
    m->time = end;
    observe(m, end - begin);
    return TOOTHSPACE_DONE;
}

int toothspace_step(toothspace_machine *m, double end) { return stepped(m, end, 0); }

int toothspace_step_to_event(toothspace_machine *m, double end) { return stepped(m, end, 1); }

/* Making and ending machines. */

static void *copied(const void *bytes, size_t size)
{
    void *block = malloc(size ? size : 1);
    if (block && bytes)
        memcpy(block, bytes, size);
    return block;
}

static void point(toothspace_machine *m)
{
    for (int64_t k = 0; k < m->at.addresses; k++)
        m->words[m->addresses[2 * k]] = (int64_t)(intptr_t)(m->memory + m->addresses[2 * k + 1]);
}

static toothspace_machine *made(const head *at, const variable *variables, const int64_t *words,
                                const int64_t *addresses, const char *memory)
{
    toothspace_machine *m = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    m->at = *at;
    m->variables = copied(variables, sizeof(variable) * at->variables);
    m->words = copied(words, sizeof(int64_t) * at->words);
    m->addresses = copied(addresses, 2 * sizeof(int64_t) * at->addresses);
    m->memory = copied(memory, (size_t)at->bytes);
    m->values = calloc((size_t)at->variables, sizeof(double));
    m->masses = calloc((size_t)at->variables, sizeof(double));
    if (m->variables && m->words && m->addresses && m->memory && m->values && m->masses) {
        point(m);
        return m;
    }
    toothspace_destroy(m);
    return NULL;
}

void toothspace_destroy(toothspace_machine *m)
{
    if (!m)
        return;
    free(m->variables);
    free(m->words);
    free(m->addresses);
    free(m->memory);
    free(m->values);
    free(m->masses);
    free(m);
}

static int has_digest(const head *at)
{
    char digest[17] = {0};
    memcpy(digest, at->digest, 16);
    return strstr(toothspace_table, digest) != NULL;
}

static toothspace_machine *refused(char *message, size_t size, const char *file, const char *why)
{
    if (message && size)
        snprintf(message, size, "%s: %s", file, why);
    return NULL;
}

static char *whole_file(const char *file, size_t *size)
{
    FILE *stream = fopen(file, "rb");
    char *bytes = NULL;
    long length = -1;
    if (stream && fseek(stream, 0, SEEK_END) == 0)
        length = ftell(stream);
    if (length > 0 && fseek(stream, 0, SEEK_SET) == 0)
        bytes = malloc((size_t)length);
    if (bytes && fread(bytes, 1, (size_t)length, stream) != (size_t)length) {
        free(bytes);
        bytes = NULL;
    }
    if (stream)
        fclose(stream);
    *size = (size_t)length;
    return bytes;
}

toothspace_machine *toothspace_create(const char *file, char *message, size_t size)
{
    size_t length = 0;
    char *bytes = whole_file(file, &length);
    if (!bytes)
        return refused(message, size, file, "found no file that can be read");
    const head *at = (const head *)bytes;
    toothspace_machine *m = NULL;
    if (length < sizeof *at || memcmp(at->magic, MAGIC, 8) != 0) {
        refused(message, size, file, "found no file of a machine");
    } else if (!has_digest(at)) {
        refused(message, size, file, "found a machine for another version of the library");
    } else {
        size_t variables = sizeof *at, words = variables + sizeof(variable) * at->variables;
        size_t addresses = words + sizeof(int64_t) * at->words;
        size_t memory = addresses + 2 * sizeof(int64_t) * at->addresses;
        if (memory + at->bytes != length)
            refused(message, size, file, "found a file that is cut short");
        else if (!(m = made(at, (const variable *)(bytes + variables),
                            (const int64_t *)(bytes + words), (const int64_t *)(bytes + addresses),
                            bytes + memory)))
            refused(message, size, file, "found no memory for it");
    }
    free(bytes);
    if (!m)
        return NULL;
    for (int64_t k = 0; k < m->at.variables; k++) {
        const variable *v = &m->variables[k];
        m->values[k] = *number(m, v->place) - (v->role == INERTIA ? v->factor : 0.0);
        m->masses[k] = m->values[k];
    }
    settle(m);
    run(m, BEGIN, 0.0);
    memcpy(number(m, m->at.reached), number(m, m->at.state), sizeof(double) * m->at.states);
    observe(m, 0.0);
    return m;
}

/* State: time, values and memory; addresses within are none of it. */

size_t toothspace_state_size(const toothspace_machine *m)
{
    return sizeof(double) * (2 + 2 * (size_t)m->at.variables) + (size_t)m->at.bytes;
}

void toothspace_save(const toothspace_machine *m, void *bytes)
{
    size_t values = sizeof(double) * (size_t)m->at.variables;
    double first[2] = {m->time, m->restart};
    char *to = bytes;
    memcpy(to, first, sizeof first);
    memcpy(to + sizeof first, m->values, values);
    memcpy(to + sizeof first + values, m->masses, values);
    memcpy(to + sizeof first + 2 * values, m->memory, (size_t)m->at.bytes);
}

void toothspace_restore(toothspace_machine *m, const void *bytes)
{
    size_t values = sizeof(double) * (size_t)m->at.variables;
    double first[2];
    const char *from = bytes;
    memcpy(first, from, sizeof first);
    m->time = first[0];
    m->restart = first[1] != 0.0;
    memcpy(m->values, from + sizeof first, values);
    memcpy(m->masses, from + sizeof first + values, values);
    memcpy(m->memory, from + sizeof first + 2 * values, (size_t)m->at.bytes);
}

toothspace_machine *toothspace_copy(const toothspace_machine *m)
{
    toothspace_machine *copy = made(&m->at, m->variables, m->words, m->addresses, m->memory);
    if (copy)
        toothspace_assign(copy, m);
    return copy;
}

void toothspace_assign(toothspace_machine *m, const toothspace_machine *other)
{
    m->time = other->time;
    m->restart = other->restart;
    memcpy(m->values, other->values, sizeof(double) * (size_t)m->at.variables);
    memcpy(m->masses, other->masses, sizeof(double) * (size_t)m->at.variables);
    memcpy(m->memory, other->memory, (size_t)m->at.bytes);
}

/* Variables. */

static int known(const toothspace_machine *m, int k) { return k >= 0 && k < m->at.variables; }

int toothspace_inputs(const toothspace_machine *m) { return (int)m->at.inputs; }
int toothspace_variables(const toothspace_machine *m) { return (int)m->at.variables; }
double toothspace_time(const toothspace_machine *m) { return m->time; }

const char *toothspace_name(const toothspace_machine *m, int k)
{
    return known(m, k) ? m->variables[k].name : "";
}

const char *toothspace_unit(const toothspace_machine *m, int k)
{
    return known(m, k) ? m->variables[k].unit : "";
}

int toothspace_find(const toothspace_machine *m, const char *name)
{
    for (int k = 0; k < m->at.variables; k++)
        if (strcmp(m->variables[k].name, name) == 0)
            return k;
    return -1;
}

int toothspace_set(toothspace_machine *m, int k, double value)
{
    if (!known(m, k) || k >= m->at.inputs || !isfinite(value))
        return -1;
    double size = fmax(fabs(value), fabs(m->values[k]));
    if (m->variables[k].role != SHAFT_SPEED && fabs(value - m->values[k]) > RESTARTED_AT * size)
        m->restart = 1;
    m->values[k] = value;
    return 0;
}

double toothspace_get(const toothspace_machine *m, int k)
{
    return known(m, k) ? m->values[k] : NAN;
}

/* Derivatives. */

/* Size of an input that is small for a machine. [SI] */
static double small(const variable *v)
{
    return v->role == PORT_PRESSURE ? 1e6
           : v->role == SHAFT_SPEED ? 10.0
           : v->role == PORT_FLOW   ? 1e-5
           : v->role == INERTIA     ? 1e-5
                                    : 1.0;
}

/* Outputs after one step with all inputs moved along the seed, which take the integrator's begin
 * with them; the machine is a copy that ends here. */
static int moved(toothspace_machine *m, double step, double by, int inputs, const int *input,
                 const double *seed, int outputs, const int *output, double *values)
{
    int code = m ? 0 : TOOTHSPACE_NOT_FINITE;
    for (int k = 0; k < inputs && !code; k++)
        code = toothspace_set(m, input[k], toothspace_get(m, input[k]) + by * seed[k]);
    if (!code) {
        m->restart = 1;
        code = toothspace_step(m, m->time + step);
    }
    for (int k = 0; k < outputs && !code; k++)
        values[k] = toothspace_get(m, output[k]);
    toothspace_destroy(m);
    return code;
}

int toothspace_derivative(const toothspace_machine *m, double step, int inputs, const int *input,
                          const double *seed, int outputs, const int *output, double *derivative)
{
    double by = INFINITY;
    for (int k = 0; k < inputs; k++) {
        if (!known(m, input[k]) || input[k] >= m->at.inputs)
            return -1;
        double size = fmax(fabs(m->values[input[k]]), small(&m->variables[input[k]]));
        if (seed[k] != 0.0)
            by = fmin(by, SIDEWAYS * size / fabs(seed[k]));
    }
    for (int k = 0; k < outputs; k++)
        derivative[k] = 0.0;
    if (!isfinite(by))
        return TOOTHSPACE_DONE;
    double *above = calloc((size_t)outputs + 1, sizeof *above);
    if (!above)
        return TOOTHSPACE_NOT_FINITE;
    int code = moved(toothspace_copy(m), step, by, inputs, input, seed, outputs, output, above);
    if (!code)
        code = moved(toothspace_copy(m), step, -by, inputs, input, seed, outputs, output,
                     derivative);
    for (int k = 0; k < outputs && !code; k++)
        derivative[k] = 0.5 * (above[k] - derivative[k]) / by;
    free(above);
    return code;
}
