/* Runs of connected models for a host that is not in this memory, such as the script of a page: whole runs in one
 * call, and a run that goes on exchange by exchange while a user watches and sets inputs.
 *
 * Numbers come in and go out as arrays of doubles. The file that is compiled has defined LIVE_MODELS, the tables of
 * the models, LIVE_COUNT, how many there are, LIVE_LINKS, their connections, made of the models' types as all others
 * are, and LIVE_CHARTS, how many state machines they have, which call live_decides.
 */
#include "batch.c"

#define DECIDED 3

typedef struct {
    const Library *models[LIVE_COUNT];
    Batch batch;
    Runner runner;
    Course course;
    int64_t seen_count;
    Signal *seen; /* what is reported of each exchange */
    Place *places;
    double *row; /* the end, its time [ns], what is kept */
    End end;
    double decided[LIVE_CHARTS + 1][DECIDED]; /* of each chart: the exchange before it decided last, state, guards */
} Live;

static const Link live_links[] = {LIVE_LINKS};

static Live *deciding; /* the run that is a step on its way */

/* What the C of a chart says where it decides: `guards` has a bit for each that holds. */
void live_decides(int32_t chart, int64_t state, int64_t guards);
void live_decides(int32_t chart, int64_t state, int64_t guards) {
    if (!deciding) return;
    deciding->decided[chart][0] = (double)deciding->course.count;
    deciding->decided[chart][1] = (double)state;
    deciding->decided[chart][2] = (double)guards;
}

LIBRARY_EXPORT double *live_numbers(int32_t count) { return calloc((size_t)count, sizeof(double)); }

LIBRARY_EXPORT void live_free(void *memory) { free(memory); }

static const double *read_signal(const double *number, Signal *signal) {
    signal->model = (int64_t)*number++;
    signal->place = (int64_t)*number++;
    signal->input = (int64_t)*number++;
    return number;
}

static const double *read_kept(const double *number, Live *live) {
    Kept *kept = calloc((size_t)live->batch.kept_count + 1, sizeof(Kept));
    live->batch.kept = kept;
    for (int64_t k = 0; kept && k < live->batch.kept_count; k++) {
        kept[k].how = (int64_t)*number++;
        number = read_signal(number, &kept[k].signal);
        number = read_signal(number, &kept[k].when);
        kept[k].values = (uint64_t)*number++;
    }
    return number;
}

static const double *read_faults(const double *number, Live *live, int64_t place_count) {
    FaultPlan *faults = calloc((size_t)live->batch.fault_count + 1, sizeof(FaultPlan));
    int64_t *places = calloc((size_t)place_count + 1, sizeof(int64_t)), taken = 0;
    live->batch.faults = faults;
    live->batch.places = places;
    for (int64_t k = 0; faults && places && k < live->batch.fault_count; k++) {
        faults[k].kind = (int64_t)*number++;
        faults[k].model = (int64_t)*number++;
        faults[k].first = taken;
        faults[k].count = (int64_t)*number++;
        for (int64_t i = 0; i < faults[k].count; i++) places[taken++] = (int64_t)*number++;
    }
    return number;
}

/* set-up: final values of the mode as bits, largest speed that counts as standing, for how long [ns], mode, speed,
 * count of what is kept, of what is seen, of faults, of inputs that they disturb; for each kept: how, signal, when,
 * values as bits; for each seen: signal; for each fault: kind, model, count, inputs. A signal is a model, a place and
 * whether it is an input. Returns NULL if there is no memory. */
LIBRARY_EXPORT Live *live_open(const double *number) {
    const Library *const models[] = {LIVE_MODELS};
    Live *live = calloc(1, sizeof(Live));
    int64_t place_count;
    if (!live) return NULL;
    memcpy(live->models, models, sizeof models);
    live->batch.models = live->models;
    live->batch.model_count = LIVE_COUNT;
    live->batch.links = live_links;
    live->batch.link_count = sizeof live_links / sizeof *live_links;
    live->batch.final = (uint64_t)*number++;
    live->batch.still = *number++;
    live->batch.still_ns = (int64_t)*number++;
    number = read_signal(number, &live->batch.mode);
    number = read_signal(number, &live->batch.speed);
    live->batch.kept_count = (int64_t)*number++;
    live->seen_count = (int64_t)*number++;
    live->batch.fault_count = (int64_t)*number++;
    place_count = (int64_t)*number++;
    live->seen = calloc((size_t)live->seen_count + 1, sizeof(Signal));
    live->places = calloc((size_t)live->seen_count + 1, sizeof(Place));
    live->row = calloc((size_t)live->batch.kept_count + 2, sizeof(double));
    live->runner.batch = &live->batch;
    if (!live->seen || !live->places || !live->row) return NULL;
    number = read_kept(number, live);
    for (int64_t k = 0; k < live->seen_count; k++) number = read_signal(number, &live->seen[k]);
    read_faults(number, live, place_count);
    if (!live->batch.kept || !live->batch.faults || !live->batch.places) return NULL;
    return lay_out(&live->runner, calloc(1, lay_out(&live->runner, NULL) + 1)) ? live : NULL;
}

LIBRARY_EXPORT void live_close(Live *live) {
    for (int64_t k = 0; k < live->batch.fault_count; k++) free(live->runner.faults[k].line);
    free(live->runner.slaves); /* where its memory begins */
    free((void *)live->batch.kept);
    free((void *)live->batch.faults);
    free((void *)live->batch.places);
    free(live->seen);
    free(live->places);
    free(live->row);
    free(live);
}

/* times: the step [ns], the stop [ns], the decimation of each model; params: those of all models; faults: the numbers
 * of each. Returns 0, or -1 if there is no memory. */
LIBRARY_EXPORT int32_t live_begin(Live *live, const double *params, const double *times, const double *faults) {
    int64_t every[LIVE_COUNT];
    live->course = course_to((int64_t)times[0], (int64_t)times[1]);
    for (int64_t m = 0; m < LIVE_COUNT; m++) every[m] = (int64_t)times[2 + m];
    connect(&live->runner, every);
    for (int64_t k = 0; k < live->seen_count; k++) live->places[k] = place_of(live->runner.slaves, live->seen[k]);
    if (initialize(&live->runner, params, faults, live->course.step_ns)) return -1;
    begin_notes(&live->runner, live->row + 2);
    for (int64_t k = 0; k < LIVE_CHARTS; k++) live->decided[k][0] = -1.0;
    return 0;
}

/* One exchange; fills what is seen. Returns whether the run is over. */
LIBRARY_EXPORT int32_t live_exchange(Live *live, double *seen) {
    exchange(&live->runner, &live->course);
    note(&live->runner, &live->course, live->row + 2, 1);
    for (int64_t k = 0; k < live->seen_count; k++) seen[k] = look(live->places[k]);
    const int over = is_over(&live->runner, &live->course, &live->end);
    live->row[0] = (double)live->end;
    live->row[1] = (double)time_of(&live->course);
    return over;
}

/* The step from this exchange to the next. */
LIBRARY_EXPORT void live_advance(Live *live) {
    deciding = live;
    advance(&live->runner, &live->course);
    deciding = NULL;
}

/* For each chart what it decided on last: the number of the exchange before, or -1 if it has not in this run; its
 * state then; the guards as bits. */
LIBRARY_EXPORT const double *live_decided(const Live *live) { return live->decided[0]; }

/* An input that nothing is connected to, from the next step on. */
LIBRARY_EXPORT void live_set(Live *live, int32_t model, int32_t input, double value) {
    const Slave *slave = &live->runner.slaves[model];
    library_write(slave->memory + slave->model->inputs[input].offset, slave->model->inputs[input].kind, value);
}

LIBRARY_EXPORT double live_look(const Live *live, int32_t model, int32_t place, int32_t input) {
    const Signal signal = {model, place, input};
    return look(place_of(live->runner.slaves, signal));
}

LIBRARY_EXPORT double *live_row(Live *live) { return live->row; }

/* A whole run; every n-th exchange, and the last one, fills a line of trace: time [s], what is seen. Returns how many
 * lines there are, `room` at most; 0 if there is no memory. The run ends as `row` says. */
LIBRARY_EXPORT int32_t live_run(Live *live, const double *params, const double *times, const double *faults,
                                double *trace, int32_t every, int32_t room) {
    int32_t lines = 0;
    if (live_begin(live, params, times, faults)) return 0;
    for (int over = 0; !over; live_advance(live)) {
        double *line = trace + (int64_t)(lines < room ? lines : room - 1) * (1 + live->seen_count);
        over = live_exchange(live, line + 1);
        line[0] = live->row[1] / 1e9;
        if (over || live->course.count % every == 0) lines += lines < room;
    }
    return lines;
}
