/* Whole runs in one call: models, exchange, ending and the numbers kept of each run.
 *
 * The exchange is that of the Python master, step by step: fetch the outputs of the models that are due, hand
 * them to the inputs of the same name, disturb these, note what is kept, ask whether the run is over, step what is due. The
 * models keep their variables as the structs of their own C; parameters are laid in once per run. Holds no lock and
 * no static data: any number of threads may be in here at once.
 */
#include "batch.h"
#include "library.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* One model in one run. */
typedef struct {
    const Library *model;
    unsigned char *memory;
    unsigned char *copy;    /* room for outputs */
    unsigned char *fetched; /* outputs as they are seen: in memory, or a copy that stays until the model is due */
    int64_t every;
    int due; /* at this exchange */
} Slave;

/* Where a signal is in memory. */
typedef struct {
    const unsigned char *at;
    uint32_t kind;
} Place;

typedef struct {
    Place source;
    unsigned char *target;
    int64_t count; /* of numbers that follow each other on both sides */
    const int *due;
} Wire;

/* Everything of a call but the run's own numbers. */
typedef struct {
    const Batch *batch;
    Slave *slaves;
    Wire *wires;
    int64_t wire_count;
    Place *kept, *when;
    double *before;       /* the value noted last */
    unsigned char *noted; /* whether there is one */
    Fault *faults;
    Place mode, speed;
} Runner;

static Place place_of(const Slave *slaves, Signal signal) {
    const Slave *slave = &slaves[signal.model];
    const LibraryPlace there = signal.input ? slave->model->inputs[signal.place] : slave->model->outputs[signal.place];
    const int64_t offset = signal.input ? there.offset : there.offset - slave->model->outputs_offset;
    const Place place = {(signal.input ? slave->memory : slave->fetched) + offset, there.kind};
    return place;
}

static double look(Place place) { return library_read(place.at, place.kind); }

static unsigned char *outputs_of(const Slave *slave) { return slave->memory + slave->model->outputs_offset; }

static void fetch(const Slave *slave) {
    if (slave->fetched == slave->copy) memcpy(slave->copy, outputs_of(slave), (size_t)slave->model->outputs_size);
}

static void hand_over(const Runner *runner) {
    for (int64_t k = 0; k < runner->wire_count; k++) {
        const Wire *wire = &runner->wires[k];
        if (!*wire->due) continue;
        if (wire->source.kind == LIBRARY_BOOLEAN) {
            memcpy(wire->target, wire->source.at, sizeof(bool));
            continue;
        }
        for (int64_t i = 0; i < wire->count; i++)
            memcpy(wire->target + i * NUMBER, wire->source.at + i * NUMBER, NUMBER);
    }
}

static int is_in(double mode, uint64_t values) {
    return mode >= 0.0 && mode < 64.0 && (values >> (unsigned)mode & 1u);
}

static void begin_notes(const Runner *runner, double *kept) {
    for (int64_t k = 0; k < runner->batch->kept_count; k++) {
        kept[k] = NAN;
        runner->noted[k] = 0;
    }
}

/* Where a run is: at exchange `count`, standing in a final state since [ns], or not (-1). */
typedef struct {
    int64_t step_ns, stop_ns, last, count, since;
} Course;

/* The last exchange is at the stop time, whether that is a whole number of steps or not. */
static Course course_to(int64_t step_ns, int64_t stop_ns) {
    const Course course = {step_ns, stop_ns, (stop_ns + step_ns - 1) / step_ns, 0, -1};
    return course;
}

static int64_t time_of(const Course *course) {
    const int64_t regular = course->count * course->step_ns;
    return regular < course->stop_ns ? regular : course->stop_ns;
}

/* Of the values noted: NaN is the worst there is; once seen, it stays. None noted: NaN. `all`: also those that are read
 * once a run is over. */
static void note(const Runner *runner, const Course *course, double *kept, int all) {
    for (int64_t k = 0; k < runner->batch->kept_count; k++) {
        const Kept *wanted = &runner->batch->kept[k];
        if (!all && is_at_end(wanted)) continue;
        if (wanted->values && !is_in(look(runner->when[k]), wanted->values)) continue;
        const double now = look(runner->kept[k]);
        const int nan = isnan(now) != 0;
        if (!runner->noted[k]) {
            kept[k] = wanted->how == TRAVEL && !nan ? 0.0
                      : wanted->how == TIME         ? (double)time_of(course) / 1e9
                                                    : now;
        } else {
            switch ((How)wanted->how) {
            case LAST: kept[k] = now; break;
            case LARGEST: if (fabs(now) > fabs(kept[k]) || nan) kept[k] = now; break;
            case GREATEST: if (now > kept[k] || nan) kept[k] = now; break;
            case SMALLEST: if (now < kept[k] || nan) kept[k] = now; break;
            case TRAVEL: kept[k] += fabs(now - runner->before[k]); break;
            case FIRST: case TIME: break;
            }
        }
        runner->before[k] = now;
        runner->noted[k] = 1;
    }
}

static int stands(const Runner *runner) {
    return is_in(look(runner->mode), runner->batch->final) && !(fabs(look(runner->speed)) > runner->batch->still);
}

/* faults: the numbers of each. Returns 0, or -1 if there is no memory. */
static int initialize(const Runner *runner, const double *params, const double *faults, int64_t step_ns) {
    for (int64_t m = 0; m < runner->batch->model_count; m++) {
        Slave *slave = &runner->slaves[m];
        slave->due = 1;
        slave->model->start(slave->memory, params);
        params += slave->model->param_count;
        fetch(slave);
    }
    for (int64_t k = 0; k < runner->batch->fault_count; k++)
        if (fault_begin(&runner->faults[k], faults + k * FAULT_NUMBERS, step_ns)) return -1;
    hand_over(runner);
    return 0;
}

/* Outputs of the models that are due go to the inputs of the same name; what is disturbed is seen otherwise. */
static void exchange(const Runner *runner, const Course *course) {
    for (int64_t m = 0; m < runner->batch->model_count; m++) {
        Slave *slave = &runner->slaves[m];
        slave->due = slave->every == 1 || course->count % slave->every == 0 || course->count == course->last;
        if (slave->due) fetch(slave);
    }
    hand_over(runner);
    for (int64_t k = 0; k < runner->batch->fault_count; k++) {
        Fault *fault = &runner->faults[k];
        if (runner->slaves[fault->plan->model].due) fault_apply(fault, time_of(course));
    }
}

static int is_over(const Runner *runner, Course *course, End *end) {
    const Batch *batch = runner->batch;
    const int64_t now = time_of(course);
    course->since = batch->final == 0 || !stands(runner) ? -1 : course->since < 0 ? now : course->since;
    *end = course->since >= 0 && now - course->since >= batch->still_ns ? STANDSTILL : STOP_TIME;
    return *end == STANDSTILL || course->count == course->last;
}

/* No step goes beyond the stop time. */
static void advance(const Runner *runner, Course *course) {
    const int64_t rest = course->stop_ns - time_of(course);
    for (int64_t m = 0; m < runner->batch->model_count; m++) {
        const Slave *slave = &runner->slaves[m];
        const int64_t length = slave->every * course->step_ns;
        if (slave->due) slave->model->step(slave->memory, length < rest ? length : rest);
    }
    course->count++;
}

/* Fills row: the end, its time [ns], what is kept. Returns 0, or -1 if there is no memory. */
static int run(const Runner *runner, const double *params, const double *faults, const int64_t *time, double *row) {
    Course course = course_to(time[0], time[1]);
    End end = STOP_TIME;
    if (initialize(runner, params, faults, course.step_ns)) return -1;
    begin_notes(runner, row + 2);
    for (int over = 0; !over;) {
        exchange(runner, &course);
        over = is_over(runner, &course, &end);
        note(runner, &course, row + 2, over);
        if (!over) advance(runner, &course);
    }
    row[0] = (double)end;
    row[1] = (double)time_of(&course);
    return 0;
}

static int follows(const Wire *before, const Wire *next) {
    const int64_t length = before->count * NUMBER;
    return before->source.kind != LIBRARY_BOOLEAN && next->source.kind != LIBRARY_BOOLEAN &&
           next->source.at == before->source.at + length && next->target == before->target + length &&
           next->due == before->due;
}

/* A model that is due at each exchange has the same outputs from one step to the next: they are seen where they are.
 * Those of another one have gone on since they were seen last. */
static void connect(Runner *runner, const int64_t *every) {
    const Batch *batch = runner->batch;
    for (int64_t m = 0; m < batch->model_count; m++) {
        Slave *slave = &runner->slaves[m];
        slave->every = every[m];
        slave->fetched = every[m] == 1 ? outputs_of(slave) : slave->copy;
    }
    runner->wire_count = 0;
    for (int64_t k = 0; k < batch->link_count; k++) {
        const Link *link = &batch->links[k];
        const Signal from = {link->source, link->source_place, 0};
        const Slave *target = &runner->slaves[link->target];
        const int64_t offset = target->model->inputs[link->target_place].offset;
        const Wire wire = {place_of(runner->slaves, from), target->memory + offset, 1, &target->due};
        if (k && follows(&runner->wires[runner->wire_count - 1], &wire))
            runner->wires[runner->wire_count - 1].count++;
        else
            runner->wires[runner->wire_count++] = wire;
    }
    for (int64_t k = 0; k < batch->kept_count; k++) {
        runner->kept[k] = place_of(runner->slaves, batch->kept[k].signal);
        if (batch->kept[k].values) runner->when[k] = place_of(runner->slaves, batch->kept[k].when);
    }
    for (int64_t k = 0; k < batch->fault_count; k++) {
        const Fault *fault = &runner->faults[k];
        for (int64_t i = 0; i < fault->plan->count; i++) {
            const Signal input = {fault->plan->model, batch->places[fault->plan->first + i], 1};
            const Place place = place_of(runner->slaves, input);
            fault->at[i] = (unsigned char *)place.at;
            fault->kinds[i] = place.kind;
        }
    }
    if (batch->final) {
        runner->mode = place_of(runner->slaves, batch->mode);
        runner->speed = place_of(runner->slaves, batch->speed);
    }
}

/* Lay out everything in `memory`, or in nothing if it is NULL; returns how many bytes it takes. */
static size_t lay_out(Runner *runner, unsigned char *memory) {
    const Batch *batch = runner->batch;
    size_t taken = 0;
    runner->slaves = part(memory, &taken, (size_t)batch->model_count * sizeof(Slave));
    runner->wires = part(memory, &taken, (size_t)batch->link_count * sizeof(Wire));
    runner->kept = part(memory, &taken, (size_t)batch->kept_count * sizeof(Place));
    runner->when = part(memory, &taken, (size_t)batch->kept_count * sizeof(Place));
    runner->before = part(memory, &taken, (size_t)batch->kept_count * sizeof(double));
    runner->noted = part(memory, &taken, (size_t)batch->kept_count);
    for (int64_t m = 0; m < batch->model_count; m++) {
        const Library *model = batch->models[m];
        unsigned char *own = part(memory, &taken, (size_t)model->size);
        const Slave slave = {.model = model, .memory = own, .copy = part(memory, &taken, (size_t)model->outputs_size)};
        if (memory) runner->slaves[m] = slave;
    }
    runner->faults = part(memory, &taken, (size_t)batch->fault_count * sizeof(Fault));
    for (int64_t k = 0; k < batch->fault_count; k++) {
        const size_t count = (size_t)batch->faults[k].count;
        unsigned char **at = part(memory, &taken, count * sizeof(unsigned char *));
        double *held = part(memory, &taken, count * sizeof(double));
        uint32_t *kinds = part(memory, &taken, count * sizeof(uint32_t));
        const Fault fault = {.plan = &batch->faults[k], .at = at, .held = held, .kinds = kinds};
        if (memory) runner->faults[k] = fault;
    }
    return taken;
}

/* times: for each run the step [ns], the stop [ns] and the decimation of each model; params: for each run those of
 * all models; faults: for each run the numbers of each; out: 2 + kept_count numbers for each run. Returns 0, or -1 if
 * there is no memory. */
LIBRARY_EXPORT int64_t batch_rows(const Batch *batch, int64_t rows, const double *params, const int64_t *times,
                                  const double *faults, double *out) {
    Runner runner = {.batch = batch};
    unsigned char *memory = calloc(1, lay_out(&runner, NULL) + 1);
    int64_t width = 0, failed = 0;
    if (!memory) return -1;
    lay_out(&runner, memory);
    for (int64_t m = 0; m < batch->model_count; m++) width += batch->models[m]->param_count;
    for (int64_t r = 0; r < rows && !failed; r++) {
        const int64_t *time = times + r * (2 + batch->model_count);
        connect(&runner, time + 2);
        failed = run(&runner, params + r * width, faults + r * batch->fault_count * FAULT_NUMBERS, time,
                     out + r * (2 + batch->kept_count));
    }
    for (int64_t k = 0; k < batch->fault_count; k++) free(runner.faults[k].line);
    free(memory);
    return failed;
}

/* Runs that a caller takes on by some exchanges at a time, with inputs of its own: episodes of a learner. */
typedef struct {
    const Batch *batch;
    const Signal *given; /* inputs that the caller sets */
    const Signal *seen;  /* signals that the caller sees */
    int64_t given_count, seen_count;
    Signal broken; /* a run is broken off where bit n of values is set for its value n */
    uint64_t values;
} Access;

typedef enum { GOES_ON, AT_STOP_TIME, AT_STANDSTILL, BROKEN_OFF } Progress;

typedef struct {
    Runner runner;
    Course course;
    Place *given, *seen;
    Place broken;
} Episode;

typedef struct {
    const Access *access;
    int64_t count;
    unsigned char *memory;
    size_t size; /* of one episode's part of the memory */
    Episode *episodes;
} Episodes;

static void connect_episode(const Access *access, Episode *episode, const int64_t *every) {
    connect(&episode->runner, every);
    for (int64_t k = 0; k < access->given_count; k++)
        episode->given[k] = place_of(episode->runner.slaves, access->given[k]);
    for (int64_t k = 0; k < access->seen_count; k++)
        episode->seen[k] = place_of(episode->runner.slaves, access->seen[k]);
    episode->broken = place_of(episode->runner.slaves, access->broken);
}

/* Lay out an episode in `memory`, or in nothing if it is NULL; returns how many bytes it takes. */
static size_t lay_out_episode(const Access *access, Episode *episode, unsigned char *memory) {
    size_t taken;
    episode->runner.batch = access->batch;
    taken = lay_out(&episode->runner, memory);
    episode->given = part(memory, &taken, (size_t)access->given_count * sizeof(Place));
    episode->seen = part(memory, &taken, (size_t)access->seen_count * sizeof(Place));
    return taken;
}

LIBRARY_EXPORT void episodes_close(Episodes *all) {
    if (!all) return;
    for (int64_t n = 0; all->episodes && n < all->count; n++)
        for (int64_t k = 0; k < all->access->batch->fault_count; k++) free(all->episodes[n].runner.faults[k].line);
    free(all->episodes);
    free(all->memory);
    free(all);
}

/* Returns room for `count` episodes, none of them begun; NULL if there is no memory. */
LIBRARY_EXPORT Episodes *episodes_open(const Access *access, int64_t count) {
    Episode none;
    Episodes *all = calloc(1, sizeof(Episodes));
    if (!all) return NULL;
    all->access = access;
    all->count = count;
    all->size = lay_out_episode(access, &none, NULL);
    all->memory = calloc((size_t)count, all->size);
    if (all->memory) all->episodes = calloc((size_t)count, sizeof(Episode));
    if (!all->episodes) {
        episodes_close(all);
        return NULL;
    }
    for (int64_t n = 0; n < count; n++)
        lay_out_episode(access, &all->episodes[n], all->memory + (size_t)n * all->size);
    return all;
}

/* One exchange: note what is kept; returns whether the run is over. */
static Progress look_at(const Access *access, Episode *episode, double *row) {
    Runner *runner = &episode->runner;
    Progress progress;
    End end;
    int over;
    exchange(runner, &episode->course);
    note(runner, &episode->course, row + 2, 1);
    over = is_over(runner, &episode->course, &end);
    progress = is_in(look(episode->broken), access->values) ? BROKEN_OFF
               : !over                                      ? GOES_ON
               : end == STANDSTILL                          ? AT_STANDSTILL
                                                            : AT_STOP_TIME;
    row[0] = (double)(progress == AT_STANDSTILL ? STANDSTILL : STOP_TIME);
    row[1] = (double)time_of(&episode->course);
    return progress;
}

static void show(const Access *access, const Episode *episode, double *seen) {
    for (int64_t k = 0; k < access->seen_count; k++) seen[k] = look(episode->seen[k]);
}

/* Begin the episodes `which` and take them on by one step, so that every model has seen what the others put out: numbers
 * of each as in batch_rows, in the order of `which`; rows, seen and progress are those of all. Returns 0, or -1 if there
 * is no memory. */
LIBRARY_EXPORT int64_t episodes_begin(Episodes *all, int64_t count, const int64_t *which, const double *params,
                                      const int64_t *times, const double *faults, double *rows, double *seen,
                                      int64_t *progress) {
    const Batch *batch = all->access->batch;
    int64_t width = 0;
    for (int64_t m = 0; m < batch->model_count; m++) width += batch->models[m]->param_count;
    for (int64_t i = 0; i < count; i++) {
        const int64_t n = which[i], *time = times + i * (2 + batch->model_count);
        Episode *episode = &all->episodes[n];
        double *row = rows + n * (2 + batch->kept_count);
        connect_episode(all->access, episode, time + 2);
        episode->course = course_to(time[0], time[1]);
        if (initialize(&episode->runner, params + i * width, faults + i * batch->fault_count * FAULT_NUMBERS, time[0]))
            return -1;
        begin_notes(&episode->runner, row + 2);
        progress[n] = look_at(all->access, episode, row);
        if (progress[n] == GOES_ON) {
            advance(&episode->runner, &episode->course);
            progress[n] = look_at(all->access, episode, row);
        }
        show(all->access, episode, seen + n * all->access->seen_count);
    }
    return 0;
}

/* Take the episodes from `first` up to `end` on by `period_ns`, with the inputs `given`, a line for each of all. One
 * whose progress says that it is over stays as it is. */
LIBRARY_EXPORT void episodes_advance(Episodes *all, int64_t first, int64_t end, int64_t period_ns, const double *given,
                                     double *rows, double *seen, int64_t *progress) {
    const Access *access = all->access;
    for (int64_t n = first; n < end; n++) {
        Episode *episode = &all->episodes[n];
        double *row = rows + n * (2 + access->batch->kept_count);
        const int64_t until = time_of(&episode->course) + period_ns;
        if (progress[n] != GOES_ON) continue;
        for (int64_t k = 0; k < access->given_count; k++)
            library_write((unsigned char *)episode->given[k].at, episode->given[k].kind,
                          given[n * access->given_count + k]);
        while (progress[n] == GOES_ON && time_of(&episode->course) < until) {
            advance(&episode->runner, &episode->course);
            progress[n] = look_at(access, episode, row);
        }
        show(access, episode, seen + n * access->seen_count);
    }
}
