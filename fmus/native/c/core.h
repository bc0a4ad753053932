/* One instance of an FMU, and what is known of its variables: the same for FMI 2.0 and FMI 3.0.
 *
 * A face (fmi2.c, fmi3.c) includes this after it has said what a logger is: FmuLogger and fmu_log. The file
 * that is compiled, <Model>_fmi2.c or <Model>_fmi3.c, has included the model's C and defined
 *
 *     FMU_MODEL         the model's name, which is also the struct of all its memory
 *     FMU_TOKEN         GUID or instantiation token
 *     FMU_VARIABLES     the file with a line VARIABLE(...) for each value reference, in their order
 *     FMU_RUNS          the file with a line RUN(...) for each stretch of the model's memory without padding
 *     FMU_LONGEST_NAME  characters
 *     FMU_LISTED        how many signals the model has
 *     FMU_STORE(model)  where the model's step finds its work arrays, with a comma; left out if it has none
 *
 * All is static and begins with fmu, Fmu or FMU: several FMUs can be linked into one image.
 */
#ifndef FMU_CORE_H
#define FMU_CORE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define FMU_PASTE(a, b) a##b
#define FMU_JOIN(a, b) FMU_PASTE(a, b)
#define FMU_CALL(function) FMU_JOIN(FMU_MODEL, _##function)

#ifndef FMU_STORE
#define FMU_STORE(model)
#endif

typedef enum { FMU_OK, FMU_WARNING, FMU_DISCARD, FMU_ERROR, FMU_FATAL } FmuStatus; /* numbers of both standards */

typedef enum { FMU_INSTANTIATED = 1, FMU_INITIALIZATION = 2, FMU_STEPPING = 4, FMU_TERMINATED = 8 } FmuPhase;

#define FMU_SETTING_UP (FMU_INSTANTIATED | FMU_INITIALIZATION)
#define FMU_READABLE (FMU_INITIALIZATION | FMU_STEPPING | FMU_TERMINATED)
#define FMU_ANY_PHASE (FMU_SETTING_UP | FMU_STEPPING | FMU_TERMINATED)

/* All that a saved FMU state holds: numbers, no pointers. */
typedef struct {
    FMU_MODEL model;
    double time;    /* s, on the master's clock */
    int64_t now_ns; /* the same, exact */
    int64_t start_ns;
    int32_t phase;
    int32_t stale; /* a parameter has changed since the model was initialized */
} FmuSaved;

/* REAL is kept as double, INTEGER and ENUMERATION as int64_t, BOOLEAN as bool. */
typedef enum { FMU_REAL, FMU_INTEGER, FMU_ENUMERATION, FMU_BOOLEAN, FMU_KINDS } FmuKind;

/* Numbers of one kind that are kept one behind the other; `first` is the offset of the first in FmuSaved. */
typedef struct {
    uint32_t first;
    uint32_t count;
} FmuStretch;

/* What a call was found to be about: its value references, all of one kind, and where their values are kept. A host
 * makes the same calls at each step; then it is enough to see that they are the same. Of calls about more values than
 * the model has signals nothing is noted. */
typedef struct {
    size_t count; /* of references; 0: none yet */
    size_t size;  /* of values */
    uint32_t references[FMU_LISTED];
    FmuStretch stretches[FMU_LISTED + 1]; /* behind the last: one without numbers */
} FmuList;

/* What the importer says about an instance: all that a message to it needs. */
typedef struct {
    const char *name;
    FmuLogger logger;
    void *environment;
    bool logging;
} FmuHost;

/* Too large for a stack: a model may have a map of its surroundings. It is allocated only, see fmu_new. */
typedef struct {
    FmuHost host; /* first: a message takes the address of the instance as it is */
    FmuSaved saved;
    int64_t stop_ns; /* INT64_MAX: no stop time is defined; the importer's experiment, not part of a saved state */
    FmuList got[FMU_KINDS];
    FmuList given[FMU_KINDS]; /* inputs alone: parameters have limits */
} FmuInstance;

typedef enum { FMU_FIXED, FMU_TUNABLE, FMU_INPUT, FMU_CALCULATED } FmuRole;

/* Where a variable is kept. */
typedef struct {
    uint32_t offset; /* of its first element, in FmuSaved */
    uint8_t kind;
    uint8_t role;
} FmuPlace;

/* What is said of a variable; the limits hold for parameters. */
typedef struct {
    double least;
    double greatest;
    char name[FMU_LONGEST_NAME + 1];
} FmuLabel;

#define MODEL(member) offsetof(FmuSaved, model.member)
#define CLOCK offsetof(FmuSaved, time)

#define VARIABLE(place, kind, role, name, least, greatest, shape) {(uint32_t)(place), FMU_##kind, FMU_##role},
static const FmuPlace fmu_places[] = {
#include FMU_VARIABLES
};
#undef VARIABLE

#define VARIABLE(place, kind, role, name, least, greatest, shape) {least, greatest, name},
static const FmuLabel fmu_labels[] = {
#include FMU_VARIABLES
};
#undef VARIABLE

#define FMU_COUNT (sizeof fmu_places / sizeof *fmu_places)

static inline const char *fmu_name(uint32_t reference) { return fmu_labels[reference].name; }

static inline bool fmu_is(uint32_t reference, FmuKind kind) {
    return reference < FMU_COUNT && fmu_places[reference].kind == (uint8_t)kind;
}

/* An integer as both standards hand it out. */
static inline int32_t fmu_int32(int64_t value) {
    return value > INT32_MAX ? INT32_MAX : value < INT32_MIN ? INT32_MIN : (int32_t)value;
}

#define FMU_SAME(value) (value)

/* Return where the values of these references are kept if they are the listed ones, else NULL. */
static inline const FmuStretch *fmu_listed(const FmuList *list, const uint32_t references[], size_t count) {
    const bool same = count && count == list->count && !memcmp(references, list->references, count * sizeof *references);
    return same ? list->stretches : NULL;
}

/* The number that is kept at an offset in FmuSaved. */
#define FMU_KEPT(fmu, Kept, offset) (*(Kept *)(void *)((unsigned char *)&(fmu)->saved + (offset)))

/* Do `move` for i below the length of each stretch, `kept` being its numbers and `values` those of the call. */
#define FMU_EACH(fmu, Kept, stretches, values, move)                              \
    for (const FmuStretch *stretch = stretches; stretch->count; stretch++) {      \
        Kept *kept = &FMU_KEPT(fmu, Kept, stretch->first);                        \
        for (size_t i = 0; i < stretch->count; i++) move;                         \
        values += stretch->count;                                                 \
    }

#endif
