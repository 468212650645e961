/*
 * A simulator in C as small as can be: loads a unit, steps it and prints what it was asked for.
 *
 *     fmu_host LIBRARY TOKEN STEPS STEP_SIZE [REFERENCE=VALUE | +REFERENCE=VALUE | REFERENCE]...
 *
 * REFERENCE=VALUE is given before the start, +REFERENCE=VALUE from half of the steps on; the values
 * of bare references are printed after every step. The unit is put back once, as by a master that
 * rejects steps. Messages go to standard error, and the time that all steps took.
 */

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST = 64 };

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

static void logged(void *environment, const char *name, int status, const char *category,
                   const char *message, ...)
{
    va_list rest;
    va_start(rest, message);
    fprintf(stderr, "%s %d %s: ", name, status, category);
    vfprintf(stderr, message, rest);
    fputc('\n', stderr);
    va_end(rest);
    (void)environment;
}

/* Place of the resources: those of the folder in which "binaries/PLATFORM/LIBRARY" lies. */
static const char *resources_of(const char *path)
{
    static char uri[2000];
    snprintf(uri, sizeof uri, "file://%s", path);
    for (int k = 0; k < 3; k++) {
        char *end = strrchr(uri, '/');
        if (end != NULL)
            *end = '\0';
    }
    strncat(uri, "/resources", sizeof uri - strlen(uri) - 1);
    return uri;
}

static void *library;

static void *function(const char *name)
{
    void *found = dlsym(library, name);
    if (found == NULL) {
        fprintf(stderr, "%s\n", dlerror());
        exit(2);
    }
    return found;
}

int main(int count, char **words)
{
    if (count < 5 || (library = dlopen(words[1], RTLD_NOW | RTLD_LOCAL)) == NULL) {
        fprintf(stderr, "%s\n", count < 5 ? "too few arguments" : dlerror());
        return 2;
    }
    void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int,
                         int) = function("fmi2Instantiate");
    int (*set_up)(void *, int, double, double, int, double) = function("fmi2SetupExperiment");
    int (*enter)(void *) = function("fmi2EnterInitializationMode");
    int (*leave)(void *) = function("fmi2ExitInitializationMode");
    int (*set)(void *, const unsigned *, size_t, const double *) = function("fmi2SetReal");
    int (*get)(void *, const unsigned *, size_t, double *) = function("fmi2GetReal");
    int (*step)(void *, double, double, int) = function("fmi2DoStep");
    int (*keep)(void *, void **) = function("fmi2GetFMUstate");
    int (*put_back)(void *, void *) = function("fmi2SetFMUstate");
    int (*forget)(void *, void **) = function("fmi2FreeFMUstate");
    int (*terminate)(void *) = function("fmi2Terminate");
    void (*release)(void *) = function("fmi2FreeInstance");

    const Callbacks callbacks = {logged, calloc, free, NULL, NULL};
    void *unit = instantiate("unit", 1, words[2], resources_of(words[1]), &callbacks, 0, 0);
    if (unit == NULL)
        return 3;
    unsigned wanted[MOST], late[MOST];
    double values[MOST], later[MOST];
    size_t outputs = 0, changes = 0;
    int status = set_up(unit, 0, 0.0, 0.0, 0, 0.0) | enter(unit);
    for (int k = 5; k < count && k < MOST; k++) {
        const unsigned reference = (unsigned)strtoul(words[k] + (words[k][0] == '+'), NULL, 10);
        const char *value = strchr(words[k], '=');
        const double number = value == NULL ? 0.0 : strtod(value + 1, NULL);
        if (value == NULL)
            wanted[outputs++] = reference;
        else if (words[k][0] == '+')
            late[changes] = reference, later[changes++] = number;
        else
            status |= set(unit, &reference, 1, &number);
    }
    status |= leave(unit);

    const long steps = atol(words[3]);
    const double size = strtod(words[4], NULL);
    const clock_t begun = clock();
    for (long k = 0; k < steps && status == 0; k++) {
        if (k == steps / 2) {
            void *kept = NULL;
            status |= keep(unit, &kept) | step(unit, (double)k * size, 3.0 * size, 1);
            status |= put_back(unit, kept) | forget(unit, &kept);
            if (changes > 0)
                status |= set(unit, late, changes, later);
        }
        status |= step(unit, (double)k * size, size, 1);
        if (outputs > 0)
            status |= get(unit, wanted, outputs, values);
        for (size_t j = 0; j < outputs; j++)
            printf("%.17g%c", values[j], j + 1 < outputs ? ',' : '\n');
    }
    fprintf(stderr, "seconds %.6f\n", (double)(clock() - begun) / CLOCKS_PER_SEC);
    status |= terminate(unit);
    release(unit);
    return status == 0 ? 0 : 4;
}
