/* What FMI 2.0 and FMI 3.0 have in common, see unit.h. */
#include "unit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FIRST_STEP 1e-4 /* length of the step of a derivative before the first one [s] */

static int told(unit *u, const char *text)
{
    u->tell(u, UNIT_ERROR, text);
    return UNIT_ERROR;
}

static int opened(unit *u)
{
    char text[400];
    u->machine = toothspace_create(u->file, text, sizeof text);
    u->step = FIRST_STEP;
    return u->machine ? UNIT_OK : told(u, text);
}

/* Whether the resources are those of the description. */
static int belongs(const char *resources, const char *token)
{
    char path[1100], found[64] = {0};
    snprintf(path, sizeof path, "%s/token.txt", resources);
    FILE *stream = fopen(path, "rb");
    size_t size = stream ? fread(found, 1, sizeof found - 1, stream) : 0;
    if (stream)
        fclose(stream);
    return size > 0 && token && strcmp(found, token) == 0;
}

unit *unit_create(const unit *given, const char *resources, const char *token)
{
    unit *u = malloc(sizeof *u);
    if (!u)
        return NULL;
    *u = *given;
    if (snprintf(u->file, sizeof u->file, "%s/model.machine", resources) >= (int)sizeof u->file)
        told(u, "The path of the resources is longer than 1000 characters.");
    else if (!belongs(resources, token))
        told(u, "The resources do not belong to modelDescription.xml, or cannot be read.");
    else if (opened(u) == UNIT_OK)
        return u;
    free(u);
    return NULL;
}

void unit_destroy(unit *u)
{
    if (u)
        toothspace_destroy(u->machine);
    free(u);
}

int unit_reset(unit *u)
{
    toothspace_destroy(u->machine);
    u->start = 0.0;
    return opened(u);
}

int unit_get(unit *u, const unsigned *references, size_t count, double *values)
{
    unsigned variables = (unsigned)toothspace_variables(u->machine);
    for (size_t k = 0; k < count; k++) {
        if (references[k] > variables)
            return told(u, "A value reference is not that of a variable.");
        values[k] = references[k] == variables ? u->start + toothspace_time(u->machine)
                                               : toothspace_get(u->machine, (int)references[k]);
    }
    return UNIT_OK;
}

int unit_set(unit *u, const unsigned *references, size_t count, const double *values)
{
    for (size_t k = 0; k < count; k++)
        if (toothspace_set(u->machine, (int)references[k], values[k]) != 0)
            return told(u, isfinite(values[k]) ? "A variable that is no input cannot be set."
                                               : "An input is not a finite number.");
    return UNIT_OK;
}

int unit_step(unit *u, double end, double *reached)
{
    double begin = toothspace_time(u->machine), to = end - u->start;
    if (fabs(to - begin) <= 1e-12 * fmax(fabs(end), 1e-3)) {
        *reached = end;
        return UNIT_OK;
    }
    int code = u->stops ? toothspace_step_to_event(u->machine, to)
                        : toothspace_step(u->machine, to);
    *reached = code == TOOTHSPACE_DONE ? end : u->start + toothspace_time(u->machine);
    switch (code) {
    case TOOTHSPACE_DONE:
    case TOOTHSPACE_EVENT:
        u->step = to - begin;
        return UNIT_OK;
    case TOOTHSPACE_WRONG_TIME:
        return told(u, "A step must end after the time that the unit has reached.");
    case TOOTHSPACE_STEP_TOO_SMALL:
        return told(u, "The equations cannot be integrated: an input is far from what the machine "
                       "is made for, or jumps too often.");
    default:
        return told(u, "The model gives no finite numbers: an input is far from what the machine "
                       "is made for.");
    }
}

int unit_derivative(unit *u, const unsigned *unknowns, size_t outputs, const unsigned *knowns,
                    size_t inputs, const double *seed, double *derivative)
{
    /* references are numbers of variables */
    if (toothspace_derivative(u->machine, u->step, (int)inputs, (const int *)knowns, seed,
                              (int)outputs, (const int *)unknowns, derivative) != 0)
        return told(u, "Derivatives are those of outputs after a step with respect to inputs.");
    return UNIT_OK;
}

size_t unit_state_size(const unit *u)
{
    return 2 * sizeof(double) + toothspace_state_size(u->machine);
}

int unit_keep(unit *u, void **state)
{
    if (!*state && !(*state = malloc(unit_state_size(u))))
        return told(u, "There is no memory for the state.");
    double first[2] = {u->start, u->step};
    memcpy(*state, first, sizeof first);
    toothspace_save(u->machine, (char *)*state + sizeof first);
    return UNIT_OK;
}

int unit_put_back(unit *u, const void *state)
{
    double first[2];
    if (!state)
        return told(u, "No state was kept.");
    memcpy(first, state, sizeof first);
    u->start = first[0];
    u->step = first[1];
    toothspace_restore(u->machine, (const char *)state + sizeof first);
    return UNIT_OK;
}
