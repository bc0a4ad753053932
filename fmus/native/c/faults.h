/* What a receiver sees instead of what was sent to it, between two exchanges: as orchestrator/simulation/cosim/faults.py has it,
 * to the same bits.
 */
#ifndef FAULTS_H
#define FAULTS_H

#include "library.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum { OVERRIDE, FREEZE, DROP, DELAY, NOISE } FaultKind;

/* Which inputs of a model are disturbed, and how. */
typedef struct {
    int64_t kind, model, first, count; /* of all inputs that any fault disturbs: places[first .. first + count) */
} FaultPlan;

/* What is a run's own: from when to when [ns]; value, probability, age [ns] or standard deviation; seed. */
typedef struct {
    double start, stop, amount, seed;
} FaultNumbers;

#define FAULT_NUMBERS ((int64_t)(sizeof(FaultNumbers) / sizeof(double)))

typedef struct {
    const FaultPlan *plan;
    FaultNumbers numbers;
    unsigned char **at; /* the inputs */
    uint32_t *kinds;
    double *held;  /* freeze: as they were when it began; drop: as they were received last */
    double *line;  /* delay: for each exchange its time [ns] and the values, a ring */
    int64_t room, oldest, length; /* of the ring */
    int holds;
    uint32_t random;
} Fault;

/* modelkit/random.py */
static uint32_t fault_next(uint32_t state) {
    state ^= state << 13;
    state ^= state >> 17;
    return state ^ state << 5;
}

static uint32_t fault_seed(double seed) {
    uint32_t state = (uint32_t)(((uint64_t)seed ^ 0x6A09E667u) & 0xFFFFFFFFu);
    if (state == 0) state = 0x3C6EF372u;
    for (int i = 0; i < 16; i++) state = fault_next(state);
    return state;
}

static double fault_uniform(Fault *fault) {
    fault->random = fault_next(fault->random);
    return (double)fault->random / 4294967296.0;
}

static double fault_normal(Fault *fault) {
    const double first = fault_uniform(fault);
    const double second = fault_uniform(fault);
    return sqrt(-2.0 * log(first)) * cos(6.283185307179586 * second);
}

static double fault_look(const Fault *fault, int64_t k) { return library_read(fault->at[k], fault->kinds[k]); }

static void fault_put(const Fault *fault, const double *values) {
    for (int64_t k = 0; k < fault->plan->count; k++) library_write(fault->at[k], fault->kinds[k], values[k]);
}

static void fault_hold(const Fault *fault, double *values) {
    for (int64_t k = 0; k < fault->plan->count; k++) values[k] = fault_look(fault, k);
}

/* Before the first exchange, the inputs at their start values. Returns 0, or -1 if there is no memory. */
static int fault_begin(Fault *fault, const double *numbers, int64_t step_ns) {
    memcpy(&fault->numbers, numbers, sizeof(FaultNumbers));
    fault->random = fault_seed(fault->numbers.seed);
    fault->holds = 0;
    fault->oldest = fault->length = 0;
    fault_hold(fault, fault->held);
    if (fault->plan->kind == DELAY) {
        fault->room = (int64_t)(fault->numbers.amount / (double)step_ns) + 3;
        free(fault->line);
        fault->line = malloc((size_t)(fault->room * (1 + fault->plan->count)) * sizeof(double));
        return fault->line ? 0 : -1;
    }
    return 0;
}

/* Note the values of now; leave as the oldest the newest ones that are at least `amount` old. Returns these. */
static const double *fault_late(Fault *fault, double now) {
    const int64_t width = 1 + fault->plan->count;
    double *newest = fault->line + (fault->oldest + fault->length) % fault->room * width;
    *newest = now;
    fault_hold(fault, newest + 1);
    fault->length++;
    while (fault->length > 1 && fault->line[(fault->oldest + 1) % fault->room * width] <= now - fault->numbers.amount) {
        fault->oldest = (fault->oldest + 1) % fault->room;
        fault->length--;
    }
    return fault->line + fault->oldest * width + 1;
}

static void fault_drop(Fault *fault, int active) {
    if (active && fault_uniform(fault) < fault->numbers.amount)
        fault_put(fault, fault->held);
    else
        fault_hold(fault, fault->held);
}

static void fault_freeze(Fault *fault, int active) {
    if (!active)
        fault->holds = 0;
    else if (fault->holds)
        fault_put(fault, fault->held);
    else {
        fault_hold(fault, fault->held);
        fault->holds = 1;
    }
}

static void fault_apply(Fault *fault, int64_t now_ns) {
    const double now = (double)now_ns;
    const int active = fault->numbers.start <= now && now < fault->numbers.stop;
    const double *late;
    switch ((FaultKind)fault->plan->kind) {
    case FREEZE: fault_freeze(fault, active); break;
    case DROP: fault_drop(fault, active); break;
    case DELAY:
        late = fault_late(fault, now);
        if (active) fault_put(fault, late);
        break;
    case OVERRIDE:
        for (int64_t k = 0; active && k < fault->plan->count; k++)
            library_write(fault->at[k], fault->kinds[k], fault->numbers.amount);
        break;
    case NOISE:
        for (int64_t k = 0; active && k < fault->plan->count; k++)
            library_write(fault->at[k], fault->kinds[k], fault_look(fault, k) + fault->numbers.amount * fault_normal(fault));
        break;
    }
}

#endif
