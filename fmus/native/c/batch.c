/* Whole runs in one call: models, exchange, ending and the numbers kept of each run.
 *
 * The exchange is that of orchestrator/master.py, step by step: fetch the outputs of the models that
 * are due, hand them to the inputs of the same name, note what is kept, ask whether the run is over,
 * step what is due. Every scalar is a double. Holds no lock and no static data: any number of threads
 * may be in here at once.
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef int32_t (*Initialize)(double *state, const double *parameters, double *outputs);
typedef int32_t (*Step)(double *state, const double *inputs, const double *parameters, double *outputs, int64_t dt_ns);

typedef struct {
    Initialize initialize;
    Step step;
    const double *starts; /* of the inputs; a connected one is overwritten */
    int64_t parameters, inputs, outputs, states;
} Model;

typedef struct {
    int64_t source, source_place, target, target_place;
} Link;

/* Where a signal is: an output of a model as last fetched, or an input as it was seen. */
typedef struct {
    int64_t model, place, input;
} Signal;

typedef enum { LAST, LARGEST, GREATEST, SMALLEST, TRAVEL } How;

typedef struct {
    int64_t how;
    Signal signal;
} Kept;

typedef struct {
    const Model *models;
    const Link *links;
    const Kept *kept;
    int64_t model_count, link_count, kept_count;
    Signal mode, speed;
    uint64_t final; /* bit n: the mode's value n is final; 0: a run ends at its stop time only */
    double still;   /* largest absolute speed that counts as standing */
    int64_t still_ns;
} Batch;

typedef enum { STOP_TIME, STANDSTILL, ABORTED } End;

/* The arrays of one model in one run. */
typedef struct {
    double *state, *inputs, *outputs, *fetched;
    const double *parameters;
    int64_t every;
    int due; /* at this exchange */
} Slave;

static double look(const Slave *slaves, Signal signal) {
    const Slave *slave = &slaves[signal.model];
    return signal.input ? slave->inputs[signal.place] : slave->fetched[signal.place];
}

static void hand_over(const Batch *batch, const Slave *slaves) {
    for (int64_t k = 0; k < batch->link_count; k++) {
        const Link *link = &batch->links[k];
        if (slaves[link->target].due) {
            slaves[link->target].inputs[link->target_place] = slaves[link->source].fetched[link->source_place];
        }
    }
}

static void begin_notes(const Batch *batch, const Slave *slaves, double *kept, double *before) {
    for (int64_t k = 0; k < batch->kept_count; k++) {
        const double now = look(slaves, batch->kept[k].signal);
        const int64_t how = batch->kept[k].how;
        kept[k] = how == GREATEST || how == SMALLEST ? now : 0.0;
        before[k] = now;
    }
}

/* NaN is the worst there is: once seen, it stays. */
static void note(const Batch *batch, const Slave *slaves, double *kept, double *before) {
    for (int64_t k = 0; k < batch->kept_count; k++) {
        const double now = look(slaves, batch->kept[k].signal);
        const int nan = now != now;
        switch ((How)batch->kept[k].how) {
        case LAST: kept[k] = now; break;
        case LARGEST: if (fabs(now) > fabs(kept[k]) || nan) kept[k] = now; break;
        case GREATEST: if (now > kept[k] || nan) kept[k] = now; break;
        case SMALLEST: if (now < kept[k] || nan) kept[k] = now; break;
        case TRAVEL: kept[k] += fabs(now - before[k]); before[k] = now; break;
        }
    }
}

static int stands(const Batch *batch, const Slave *slaves) {
    const double mode = look(slaves, batch->mode);
    const int final = mode >= 0.0 && mode < 64.0 && (batch->final >> (unsigned)mode & 1u);
    return final && !(fabs(look(slaves, batch->speed)) > batch->still);
}

static void initialize(const Batch *batch, Slave *slaves) {
    for (int64_t m = 0; m < batch->model_count; m++) {
        const Model *model = &batch->models[m];
        slaves[m].due = 1;
        memcpy(slaves[m].inputs, model->starts, (size_t)model->inputs * sizeof(double));
        model->initialize(slaves[m].state, slaves[m].parameters, slaves[m].outputs);
        memcpy(slaves[m].fetched, slaves[m].outputs, (size_t)model->outputs * sizeof(double));
    }
    hand_over(batch, slaves);
}

/* Fills row: the end, its time [ns], what is kept. */
static void run(const Batch *batch, Slave *slaves, int64_t step_ns, int64_t last, double *row, double *before) {
    double *kept = row + 2;
    End end = STOP_TIME;
    int64_t since = -1, count = 0;
    initialize(batch, slaves);
    begin_notes(batch, slaves, kept, before);
    for (;; count++) {
        for (int64_t m = 0; m < batch->model_count; m++) {
            slaves[m].due = slaves[m].every == 1 || count % slaves[m].every == 0;
            if (slaves[m].due) {
                memcpy(slaves[m].fetched, slaves[m].outputs, (size_t)batch->models[m].outputs * sizeof(double));
            }
        }
        hand_over(batch, slaves);
        note(batch, slaves, kept, before);
        const int64_t now = count * step_ns;
        since = !stands(batch, slaves) ? -1 : since < 0 ? now : since;
        if (since >= 0 && now - since >= batch->still_ns) {
            end = STANDSTILL;
            break;
        }
        if (count == last) break;
        for (int64_t m = 0; m < batch->model_count; m++) {
            const Slave *slave = &slaves[m];
            if (slave->due && batch->models[m].step(slave->state, slave->inputs, slave->parameters, slave->outputs,
                                                    slave->every * step_ns)) {
                end = ABORTED;
            }
        }
        if (end == ABORTED) break;
    }
    row[0] = (double)end;
    row[1] = (double)(count * step_ns);
}

static int64_t take(double **memory, double *free_memory, int64_t at, int64_t size) {
    *memory = free_memory + at;
    return at + size;
}

/* times: for each run the step [ns], the stop [ns] and the decimation of each model; out: 2 + kept_count
 * numbers for each run. Returns 0, or -1 if there is no memory. */
__attribute__((visibility("default"))) int64_t
batch_rows(const Batch *batch, int64_t rows, const double *parameters, const int64_t *times, double *out) {
    int64_t width = 0, size = batch->kept_count;
    for (int64_t m = 0; m < batch->model_count; m++) {
        const Model *model = &batch->models[m];
        width += model->parameters;
        size += model->states + model->inputs + 2 * model->outputs;
    }
    double *memory = calloc((size_t)size + 1, sizeof(double));
    Slave *slaves = calloc((size_t)batch->model_count + 1, sizeof(Slave));
    if (memory && slaves) {
        int64_t at = batch->kept_count;
        for (int64_t m = 0; m < batch->model_count; m++) {
            at = take(&slaves[m].state, memory, at, batch->models[m].states);
            at = take(&slaves[m].inputs, memory, at, batch->models[m].inputs);
            at = take(&slaves[m].outputs, memory, at, batch->models[m].outputs);
            at = take(&slaves[m].fetched, memory, at, batch->models[m].outputs);
        }
        for (int64_t r = 0; r < rows; r++) {
            const int64_t *time = times + r * (2 + batch->model_count);
            const double *own = parameters + r * width;
            for (int64_t m = 0; m < batch->model_count; m++) {
                slaves[m].parameters = own;
                slaves[m].every = time[2 + m];
                own += batch->models[m].parameters;
            }
            run(batch, slaves, time[0], time[1] / time[0], out + r * (2 + batch->kept_count), memory);
        }
    }
    const int64_t failed = memory && slaves ? 0 : -1;
    free(memory);
    free(slaves);
    return failed;
}
