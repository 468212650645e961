/* The whole machine as a C library: every tooth space, cavitation, contacts and bearings.
 *
 * A machine is made from a file that `toothspace fmu CASE --model full -o CASE.machine` writes.
 * Inputs (pressure or flow of each port, shaft speed, or load torque and inertia) hold during a
 * step, but the speed, which goes to its value along a straight line; outputs are those at the end
 * of the step, flows the means over it. All numbers are in SI units. Machines share nothing: each may
 * be stepped on a thread of its own. No function prints, and none ends the program.
 */
#ifndef TOOTHSPACE_H
#define TOOTHSPACE_H

#include <stddef.h>

#if defined(_WIN32) && !defined(TOOTHSPACE_STATIC)
#define TOOTHSPACE_EXPORT __declspec(dllexport)
#elif defined(__GNUC__) && !defined(TOOTHSPACE_STATIC)
#define TOOTHSPACE_EXPORT __attribute__((visibility("default")))
#else
#define TOOTHSPACE_EXPORT
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct toothspace_machine toothspace_machine;

/* What a step ends with. */
enum toothspace_status {
    TOOTHSPACE_DONE = 0,
    TOOTHSPACE_EVENT = 1,
    TOOTHSPACE_STEP_TOO_SMALL = 2,
    TOOTHSPACE_TOO_MANY_STEPS = 3,
    TOOTHSPACE_NOT_FINITE = 4,
    TOOTHSPACE_WRONG_TIME = 5
};

/* Make a machine from its file, at time zero; NULL with a sentence in the message if not. */
TOOTHSPACE_EXPORT toothspace_machine *toothspace_create(const char *file, char *message,
                                                        size_t size);
TOOTHSPACE_EXPORT void toothspace_destroy(toothspace_machine *machine);

/* Variables by their number, from zero; inputs come first. */
TOOTHSPACE_EXPORT int toothspace_inputs(const toothspace_machine *machine);
TOOTHSPACE_EXPORT int toothspace_variables(const toothspace_machine *machine);
TOOTHSPACE_EXPORT const char *toothspace_name(const toothspace_machine *machine, int number);
TOOTHSPACE_EXPORT const char *toothspace_unit(const toothspace_machine *machine, int number);
/* Number of a variable, -1 if there is none of that name. */
TOOTHSPACE_EXPORT int toothspace_find(const toothspace_machine *machine, const char *name);

/* Set an input for the steps that follow; returns 0, or -1 if it is none or not finite. */
TOOTHSPACE_EXPORT int toothspace_set(toothspace_machine *machine, int number, double value);
/* Value of a variable, NaN if there is none. */
TOOTHSPACE_EXPORT double toothspace_get(const toothspace_machine *machine, int number);

/* Integrate to a later time [s]. */
TOOTHSPACE_EXPORT int toothspace_step(toothspace_machine *machine, double end);
/* The same, but end with TOOTHSPACE_EVENT where the shaft stops or breaks away before. */
TOOTHSPACE_EXPORT int toothspace_step_to_event(toothspace_machine *machine, double end);
TOOTHSPACE_EXPORT double toothspace_time(const toothspace_machine *machine);

/* A second machine in the same state; give a machine the state of another one of the same file. */
TOOTHSPACE_EXPORT toothspace_machine *toothspace_copy(const toothspace_machine *machine);
TOOTHSPACE_EXPORT void toothspace_assign(toothspace_machine *machine,
                                         const toothspace_machine *other);

/* How outputs after one step from now change with inputs that move along a seed: central
 * difference of two copies that start their integration anew. */
TOOTHSPACE_EXPORT int toothspace_derivative(const toothspace_machine *machine, double step,
                                            int inputs, const int *input, const double *seed,
                                            int outputs, const int *output, double *derivative);

/* The state as bytes, to be kept in a file: as many as toothspace_state_size says. */
TOOTHSPACE_EXPORT size_t toothspace_state_size(const toothspace_machine *machine);
TOOTHSPACE_EXPORT void toothspace_save(const toothspace_machine *machine, void *bytes);
TOOTHSPACE_EXPORT void toothspace_restore(toothspace_machine *machine, const void *bytes);

#ifdef __cplusplus
}
#endif

#endif
