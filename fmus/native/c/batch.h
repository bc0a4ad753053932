/* What a batch of runs is made of: models, the links between them, when a run is over, what is kept of it. */
#ifndef BATCH_H
#define BATCH_H

#include "faults.h"
#include "library.h"

#include <stddef.h>

#define NUMBER ((int64_t)sizeof(double)) /* or integer [bytes] */

typedef struct {
    int64_t source, source_place, target, target_place; /* an output of a model, an input of another */
} Link;

/* An output of a model as last fetched, or an input as it was seen. */
typedef struct {
    int64_t model, place, input;
} Signal;

typedef enum { LAST, LARGEST, GREATEST, SMALLEST, TRAVEL, FIRST, TIME } How;

typedef struct {
    int64_t how;
    Signal signal;
    Signal when;     /* a mode: noted only while bit n of values is set for its value n */
    uint64_t values; /* 0: always */
} Kept;

typedef struct {
    const Library *const *models;
    const Link *links;
    const Kept *kept;
    int64_t model_count, link_count, kept_count;
    Signal mode, speed;
    uint64_t final; /* bit n: the mode's value n is final; 0: a run ends at its stop time only */
    double still;   /* largest absolute speed that counts as standing */
    int64_t still_ns;
    const FaultPlan *faults;
    const int64_t *places; /* inputs that they disturb */
    int64_t fault_count;
} Batch;

typedef enum { STOP_TIME, STANDSTILL } End;

/* Whether it is read once a run is over, and not noted before. */
static int is_at_end(const Kept *kept) { return kept->how == LAST && !kept->values; }

#ifndef BATCH_ALIGNMENT /* of what is laid out in memory [bytes] */
#define BATCH_ALIGNMENT sizeof(double)
#endif

/* Take `size` bytes of `memory` behind those taken, aligned; NULL of no memory. */
static void *part(unsigned char *memory, size_t *taken, size_t size) {
    unsigned char *begin = memory ? memory + *taken : NULL;
    *taken += (size + BATCH_ALIGNMENT - 1) / BATCH_ALIGNMENT * BATCH_ALIGNMENT;
    return begin;
}

#endif
