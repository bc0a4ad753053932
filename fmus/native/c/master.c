/* The exchange of orchestrator/simulation/cosim/algorithm.py as one call: read all outputs, copy them to the connected
 * inputs, write all inputs, step all. Drives FMUs through the pointers to their FMI 2.0 functions and knows
 * nothing else of them. Holds no lock and no static data.
 *
 * A row has inputs and outputs of all slaves, as they are at one exchange. It is what the FMUs write to and
 * read from; what nobody writes at an exchange is that of the row before.
 */
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "fmi2.h"

#define NANOSECONDS 1e9

/* All variables of one FMI type and one direction: one call. They lie together in a row. */
typedef struct {
    int (*call)(void *component, const uint32_t *references, size_t count, void *buffer);
    const uint32_t *references;
    int32_t *integers; /* what is handed over instead of the row's numbers, unless they are real: then null */
    int64_t begin;     /* in a row */
    int64_t count;
    int64_t changed; /* inputs: any differs from what was sent */
} Transfer;

/* A row has all inputs of a slave, then all its outputs. */
typedef struct {
    void *component;
    int (*do_step)(void *component, double time, double step, int no_rollback);
    int64_t begin; /* in a row */
    int64_t count;
    Transfer *gets;
    Transfer *sets;
    int64_t get_count;
    int64_t set_count;
    const int32_t *integers; /* those of all gets that are not real, one behind the other as in a row */
    int64_t integers_begin;
    int64_t integers_count;
    const int64_t *held; /* places of inputs that nobody writes */
    int64_t held_count;
    int64_t every; /* stepped every n-th time, by n communication steps */
    double step;   /* their length [s]; the last one ends at the stop time */
    int64_t due;   /* at this exchange */
} Slave;

/* Signals from one slave to the inputs of one transfer, by their places in a row. */
typedef struct {
    const Slave *target;
    Transfer *set;
    const int64_t *source_places;
    const int64_t *target_places;
    int64_t count;
} Link;

typedef enum { NOTHING, FETCH, SEND, STEP } Failure;

typedef struct {
    Slave *slaves;
    const Link *links;
    const double *before; /* the row of the exchange before the next */
    int64_t slave_count;
    int64_t link_count;
    int64_t width; /* of a row */
    int64_t kept;  /* exchanges whose rows there is room for, two or more: exchange n has row n % kept */
    int64_t step_ns;
    int64_t stop_ns; /* time of the last exchange; the step to it may be shorter */
    int64_t last;    /* its number; nothing is stepped after it */
    int64_t failed;  /* out: number of the slave that refused */
    int64_t failure; /* out: in what, see Failure */
    int64_t status;  /* out: the FMI status it gave */
} Run;

static int call(const Slave *slave, const Transfer *transfer, double *row) {
    void *buffer = transfer->integers ? (void *)transfer->integers : (void *)(row + transfer->begin);
    return transfer->call(slave->component, transfer->references, (size_t)transfer->count, buffer);
}

/* The last transfers, of integers, come first and are converted last: what has just been written cannot be read in
 * wider pieces without waiting for it. */
static int fetch(const Slave *slave, double *row) {
    double *converted = row + slave->integers_begin;
    for (int64_t g = slave->get_count - 1; g >= 0; g--) {
        int status = call(slave, &slave->gets[g], row);
        if (status > fmi2Warning) return status;
    }
    for (int64_t i = 0; i < slave->integers_count; i++) converted[i] = slave->integers[i];
    return fmi2OK;
}

/* An FMU holds its inputs: those of a type of which none has changed are not sent again. */
static int send(const Slave *slave, double *row) {
    for (int64_t s = 0; s < slave->set_count; s++) {
        Transfer *set = &slave->sets[s];
        if (!set->changed) continue;
        set->changed = 0;
        if (set->integers)
            for (int64_t i = 0; i < set->count; i++) set->integers[i] = (int32_t)row[set->begin + i];
        int status = call(slave, set, row);
        if (status > fmi2Warning) return status;
    }
    return fmi2OK;
}

static int fail(Run *run, int64_t slave, Failure failure, int status) {
    run->failed = slave;
    run->failure = failure;
    run->status = status;
    return 0;
}

/* What has other bits is another value: NaN is itself, -0.0 is not 0.0. */
static void hand_over(const Link *link, const double *before, double *row) {
    uint64_t differences = 0, now, then;
    for (int64_t i = 0; i < link->count; i++) {
        memcpy(&now, &row[link->source_places[i]], sizeof now);
        memcpy(&then, &before[link->target_places[i]], sizeof then);
        memcpy(&row[link->target_places[i]], &now, sizeof now);
        differences |= now ^ then;
    }
    if (differences) link->set->changed = 1;
}

/* Everything up to the moment at which all of the row is as it is at this exchange. */
static int exchange(Run *run, int64_t number, double *row) {
    const double *before = run->before;
    for (int64_t k = 0; k < run->slave_count; k++) {
        Slave *slave = &run->slaves[k];
        slave->due = slave->every == 1 || number % slave->every == 0 || number == run->last;
        if (!slave->due) {
            memcpy(row + slave->begin, before + slave->begin, (size_t)slave->count * sizeof *row);
            continue;
        }
        for (int64_t i = 0; i < slave->held_count; i++) row[slave->held[i]] = before[slave->held[i]];
        int status = fetch(slave, row);
        if (status > fmi2Warning) return fail(run, k, FETCH, status);
    }
    for (int64_t l = 0; l < run->link_count; l++)
        if (run->links[l].target->due) hand_over(&run->links[l], before, row);
    run->before = row;
    return 1;
}

static int advance(Run *run, int64_t number, double *row) {
    const int64_t now = number * run->step_ns, rest = run->stop_ns - now;
    const double time = (double)now / NANOSECONDS;
    for (int64_t k = 0; k < run->slave_count; k++) {
        int status = run->slaves[k].due ? send(&run->slaves[k], row) : fmi2OK;
        if (status > fmi2Warning) return fail(run, k, SEND, status);
    }
    for (int64_t k = 0; k < run->slave_count; k++) {
        const Slave *slave = &run->slaves[k];
        if (!slave->due) continue;
        double step = slave->every * run->step_ns <= rest ? slave->step : (double)rest / NANOSECONDS;
        int status = slave->do_step(slave->component, time, step, fmi2True);
        if (status > fmi2Warning) return fail(run, k, STEP, status);
    }
    return 1;
}

/* Do the exchanges numbered first, first + 1 ... at most `count` of them, stepping after each, and
 * return how many are whole. Fewer than asked: `last` is reached, or a slave refused. `rows` must be the same at every
 * call. */
FMI2_EXPORT int64_t master_run(Run *run, int64_t first, int64_t count, double *rows) {
    run->failure = NOTHING;
    for (int64_t done = 0; done < count; done++) {
        int64_t number = first + done;
        double *row = rows + number % run->kept * run->width;
        if (!exchange(run, number, row)) return done;
        if (number == run->last || !advance(run, number, row)) return done + 1;
    }
    return count;
}
