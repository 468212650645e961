/* A machine as a functional mock-up unit: what FMI 2.0 and FMI 3.0 have in common.
 *
 * The value reference of a variable is its number in the machine, and that of the time the number
 * behind the last one.
 */
#ifndef UNIT_H
#define UNIT_H

#include "toothspace.h"

#if defined(_WIN32)
#define UNIT_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define UNIT_EXPORT __attribute__((visibility("default")))
#else
#define UNIT_EXPORT
#endif

#define JOINED(prefix, name) prefix##name
#define PREFIXED(prefix, name) JOINED(prefix, name)

/* The first five are the same in both standards. */
enum unit_status { UNIT_OK, UNIT_WARNING, UNIT_DISCARD, UNIT_ERROR, UNIT_FATAL };

typedef struct unit {
    toothspace_machine *machine;
    double start, step; /* time at the start, and the last step [s] */
    int stops;          /* whether steps end where the shaft stops or breaks away */
    void (*tell)(struct unit *, int status, const char *text);
    void (*logger)(void); /* of the importer, as its standard has it */
    void *environment;
    char name[128], file[1024];
} unit;

/* Make the machine of a unit from the folder of its resources; the token must be that in it. */
unit *unit_create(const unit *given, const char *resources, const char *token);
void unit_destroy(unit *u);
int unit_reset(unit *u);

int unit_get(unit *u, const unsigned *references, size_t count, double *values);
int unit_set(unit *u, const unsigned *references, size_t count, const double *values);

/* Step to a time, or to an event of the shaft before it: then it is the first value behind. */
int unit_step(unit *u, double end, double *reached);

int unit_derivative(unit *u, const unsigned *unknowns, size_t outputs, const unsigned *knowns,
                    size_t inputs, const double *seed, double *derivative);

/* A kept state: bytes that can be written to a file. */
size_t unit_state_size(const unit *u);
int unit_keep(unit *u, void **state);
int unit_put_back(unit *u, const void *state);

#endif
