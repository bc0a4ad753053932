/* Whole runs in lanes: as batch.c, step by step, for as many runs at a time as a vector has elements.
 *
 * Lanes that begin together take mostly the same branches. They wait for the last of them while that leaves fewer than
 * one idle; where runs differ more in length, a lane whose run is over begins the next one. So each lane has an
 * exchange count of its own. A model without a form in lanes has an instance for each of them. Holds no lock and no
 * static data.
 */
#include "lane_library.h"
#include "lane_math.h"

#define BATCH_ALIGNMENT sizeof(lane_d)
#include "batch.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    const Library *model;
    const LaneLibrary *lanes; /* NULL: an instance for each lane */
    unsigned char *memory;
    unsigned char *copy;
    unsigned char *fetched; /* outputs as they are seen: in memory, or a copy that stays until the model is due */
    lane_i every, due;
} Slave;

/* Where a signal is in memory, and how far the next lane's is [bytes]. */
typedef struct {
    unsigned char *at;
    int64_t stride;
    uint32_t kind;
} Place;

typedef struct {
    Place source, target;
    const lane_i *due;
} Wire;

/* A number that is a vector at both ends. */
typedef struct {
    const lane_i *from;
    lane_i *to;
    const lane_i *due;
} VectorWire;

/* What is noted of a number that is kept. */
typedef struct {
    lane_d value, before;
    lane_i noted;
} Note;

typedef struct {
    lane_i step_ns, stop_ns, last, count, since, row;
    lane_i length; /* of the run before [steps] */
    lane_i busy;
} Courses;

typedef struct {
    const Batch *batch;
    Slave *slaves;
    Wire *wires;
    VectorWire *vector_wires;
    int64_t wire_count, vector_wire_count;
    Place *kept, *when;
    Note *notes;
    int64_t *noted; /* which of the numbers kept are noted at each exchange */
    int64_t noted_count;
    Place mode, speed;
    Courses courses;
} Runner;

static int is_vector(Place place) { return place.stride == NUMBER; }

static int64_t stride_of(const Slave *slave, int64_t size) { return slave->lanes ? NUMBER : size; }

static Place place_of(const Slave *slaves, Signal signal) {
    const Slave *slave = &slaves[signal.model];
    const Library *model = slave->model;
    const LibraryPlace there = signal.input ? model->inputs[signal.place] : model->outputs[signal.place];
    const int is_copy = !signal.input && slave->fetched == slave->copy;
    unsigned char *base = signal.input ? slave->memory : slave->fetched - model->outputs_offset;
    const int64_t size = is_copy ? model->outputs_size : model->size;
    const Place place = {base + there.offset, stride_of(slave, size), there.kind};
    return place;
}

static lane_d look(Place place) {
    lane_d r;
    if (is_vector(place)) {
        if (place.kind == LIBRARY_REAL) return *(const lane_d *)(const void *)place.at;
        const lane_i number = *(const lane_i *)(const void *)place.at;
        return __builtin_convertvector(place.kind == LIBRARY_INTEGER ? number : -number, lane_d);
    }
    LANE_EACH(l) r[l] = library_read(place.at + l * place.stride, place.kind);
    return r;
}

/* Truth values are masks in vectors, bytes elsewhere. */
static void hand_over_boolean(const Wire *wire) {
    const Place source = wire->source, target = wire->target;
    LANE_EACH(l) {
        const unsigned char *from = source.at + l * source.stride;
        unsigned char *to = target.at + l * target.stride;
        if (!(*wire->due)[l]) continue;
        const int holds =
            is_vector(source) ? *(const int64_t *)(const void *)from != 0 : *(const bool *)(const void *)from;
        if (is_vector(target))
            *(int64_t *)(void *)to = -holds;
        else
            *(bool *)(void *)to = holds != 0;
    }
}

static void hand_over(const Runner *runner) {
    for (int64_t k = 0; k < runner->vector_wire_count; k++) {
        const VectorWire *wire = &runner->vector_wires[k];
        *wire->to = lane_pick_i(*wire->due, *wire->from, *wire->to);
    }
    for (int64_t k = 0; k < runner->wire_count; k++) {
        const Wire *wire = &runner->wires[k];
        const Place source = wire->source, target = wire->target;
        if (source.kind == LIBRARY_BOOLEAN) {
            hand_over_boolean(wire);
        } else {
            LANE_EACH(l)
            if ((*wire->due)[l]) memcpy(target.at + l * target.stride, source.at + l * source.stride, sizeof(double));
        }
    }
}

static void fetch(const Slave *slave) {
    const Library *model = slave->model;
    const unsigned char *outputs = slave->memory + model->outputs_offset;
    if (slave->fetched != slave->copy) return;
    if (slave->lanes) {
        const lane_i *from = (const lane_i *)(const void *)outputs;
        lane_i *to = (lane_i *)(void *)slave->copy;
        for (int64_t i = 0; i < model->outputs_size / (int64_t)sizeof(lane_i); i++)
            to[i] = lane_pick_i(slave->due, from[i], to[i]);
        return;
    }
    LANE_EACH(l)
    if (slave->due[l])
        memcpy(slave->copy + l * model->outputs_size, outputs + l * model->size, (size_t)model->outputs_size);
}

static lane_i is_in(lane_d mode, uint64_t values) {
    const lane_i inside = (mode >= 0.0) & (mode < 64.0);
    const lane_i bit = __builtin_convertvector(lane_pick_d(inside, mode, LANE_DOUBLE(0.0)), lane_i);
    return inside & -((LANE_INT(values) >> bit) & 1);
}

static lane_i time_of(const Courses *courses) {
    return lane_int_min(courses->count * courses->step_ns, courses->stop_ns);
}

/* Of the values noted: NaN is the worst there is; once seen, it stays. None noted: NaN. */
static void note(const Runner *runner) {
    const Courses *courses = &runner->courses;
    for (int64_t n = 0; n < runner->noted_count; n++) {
        const int64_t k = runner->noted[n];
        const Kept *wanted = &runner->batch->kept[k];
        Note *note = &runner->notes[k];
        const lane_i counts = wanted->values ? is_in(look(runner->when[k]), wanted->values) : LANE_INT(-1);
        const lane_i where = courses->busy & counts;
        const lane_d now = look(runner->kept[k]), kept = note->value;
        const lane_i nan = now != now;
        lane_d first = now, next = kept;
        switch ((How)wanted->how) {
        case LAST: next = now; break;
        case LARGEST: next = lane_pick_d((lane_fabs(now) > lane_fabs(kept)) | nan, now, kept); break;
        case GREATEST: next = lane_pick_d((now > kept) | nan, now, kept); break;
        case SMALLEST: next = lane_pick_d((now < kept) | nan, now, kept); break;
        case TRAVEL:
            first = lane_pick_d(nan, now, LANE_DOUBLE(0.0));
            next = kept + lane_fabs(now - note->before);
            break;
        case FIRST: break;
        case TIME: first = __builtin_convertvector(time_of(courses), lane_d) / 1e9; break;
        }
        note->value = lane_pick_d(where, lane_pick_d(note->noted, next, first), kept);
        note->before = lane_pick_d(where, now, note->before);
        note->noted |= where;
    }
}

/* The run of one lane: the numbers of a row of parameters, and when it takes place. */
static void begin(Runner *runner, int lane, int64_t row, const double *params, const int64_t *time) {
    Courses *courses = &runner->courses;
    for (int64_t m = 0; m < runner->batch->model_count; m++) {
        Slave *slave = &runner->slaves[m];
        slave->every[lane] = time[2 + m];
        if (slave->lanes)
            slave->lanes->start(slave->memory, lane, params);
        else
            slave->model->start(slave->memory + lane * slave->model->size, params);
        params += slave->model->param_count;
    }
    for (int64_t k = 0; k < runner->batch->kept_count; k++) {
        runner->notes[k].value[lane] = NAN;
        runner->notes[k].noted[lane] = 0;
    }
    courses->row[lane] = row;
    courses->step_ns[lane] = time[0];
    courses->stop_ns[lane] = time[1];
    courses->last[lane] = (time[1] + time[0] - 1) / time[0];
    courses->count[lane] = 0;
    courses->since[lane] = -1;
    courses->busy[lane] = -1;
}

static void exchange(const Runner *runner) {
    const Courses *courses = &runner->courses;
    for (int64_t m = 0; m < runner->batch->model_count; m++) {
        Slave *slave = &runner->slaves[m];
        slave->due = courses->busy;
        if (lane_any(slave->every != 1))
            LANE_EACH(l)
            if (courses->count[l] % slave->every[l] != 0 && courses->count[l] != courses->last[l]) slave->due[l] = 0;
        fetch(slave);
    }
    hand_over(runner);
}

/* Take the lanes whose runs are over out of those that are busy, and write their rows. */
static void finish(Runner *runner, double *out) {
    const Batch *batch = runner->batch;
    Courses *courses = &runner->courses;
    const lane_i now = time_of(courses);
    lane_i stands = LANE_NONE, still, over;
    if (batch->final)
        stands = is_in(look(runner->mode), batch->final) & ~(lane_fabs(look(runner->speed)) > batch->still);
    courses->since = lane_pick_i(stands, lane_pick_i(courses->since < 0, now, courses->since), LANE_INT(-1));
    still = (courses->since >= 0) & (now - courses->since >= batch->still_ns);
    over = courses->busy & (still | (courses->count == courses->last));
    if (!lane_any(over)) return;
    LANE_EACH(l) {
        double *row = out + courses->row[l] * (2 + batch->kept_count);
        if (!over[l]) continue;
        row[0] = (double)(still[l] ? STANDSTILL : STOP_TIME);
        row[1] = (double)now[l];
        for (int64_t k = 0; k < batch->kept_count; k++)
            row[2 + k] = is_at_end(&batch->kept[k]) ? look(runner->kept[k])[l] : runner->notes[k].value[l];
        courses->length[l] = courses->count[l];
    }
    courses->busy &= ~over;
}

/* Whether lanes whose runs are over wait for the others, as far as the lengths of their last runs tell. All wait for the
 * first runs: no length is known yet. */
static int is_waiting(const Courses *courses) {
    int64_t sum = 0, longest = 0, shortest = INT64_MAX;
    LANE_EACH(l) {
        sum += courses->length[l];
        longest = courses->length[l] > longest ? courses->length[l] : longest;
        shortest = courses->length[l] < shortest ? courses->length[l] : shortest;
    }
    return lane_any(courses->busy) && (shortest == 0 || LANES * longest - sum < longest);
}

/* No step goes beyond the stop time. */
static void advance(Runner *runner) {
    Courses *courses = &runner->courses;
    const lane_i rest = courses->stop_ns - time_of(courses);
    for (int64_t m = 0; m < runner->batch->model_count; m++) {
        const Slave *slave = &runner->slaves[m];
        const lane_i live = slave->due & courses->busy;
        const lane_i dt_ns = lane_int_min(slave->every * courses->step_ns, rest);
        if (slave->lanes)
            slave->lanes->step(slave->memory, &live, &dt_ns);
        else
            LANE_EACH(l) if (live[l]) slave->model->step(slave->memory + l * slave->model->size, dt_ns[l]);
    }
    courses->count -= courses->busy;
}

static void connect(Runner *runner, int is_every_step) {
    const Batch *batch = runner->batch;
    for (int64_t m = 0; m < batch->model_count; m++) {
        Slave *slave = &runner->slaves[m];
        slave->fetched = is_every_step ? slave->memory + slave->model->outputs_offset : slave->copy;
    }
    for (int64_t k = 0; k < batch->link_count; k++) {
        const Link *link = &batch->links[k];
        const Signal from = {link->source, link->source_place, 0}, to = {link->target, link->target_place, 1};
        const Wire wire = {
            place_of(runner->slaves, from),
            place_of(runner->slaves, to),
            &runner->slaves[link->target].due,
        };
        if (is_vector(wire.source) && is_vector(wire.target)) {
            const VectorWire same = {(const lane_i *)(const void *)wire.source.at, (lane_i *)(void *)wire.target.at,
                                     wire.due};
            runner->vector_wires[runner->vector_wire_count++] = same;
        } else {
            runner->wires[runner->wire_count++] = wire;
        }
    }
    for (int64_t k = 0; k < batch->kept_count; k++) {
        if (!is_at_end(&batch->kept[k])) runner->noted[runner->noted_count++] = k;
        runner->kept[k] = place_of(runner->slaves, batch->kept[k].signal);
        if (batch->kept[k].values) runner->when[k] = place_of(runner->slaves, batch->kept[k].when);
    }
    if (batch->final) {
        runner->mode = place_of(runner->slaves, batch->mode);
        runner->speed = place_of(runner->slaves, batch->speed);
    }
}

/* Lay out everything in `memory`, or in nothing if it is NULL; returns how many bytes it takes. */
static size_t lay_out(Runner *runner, const LaneLibrary *const *lanes, unsigned char *memory) {
    const Batch *batch = runner->batch;
    size_t taken = 0;
    runner->slaves = part(memory, &taken, (size_t)batch->model_count * sizeof(Slave));
    runner->wires = part(memory, &taken, (size_t)batch->link_count * sizeof(Wire));
    runner->vector_wires = part(memory, &taken, (size_t)batch->link_count * sizeof(VectorWire));
    runner->noted = part(memory, &taken, (size_t)batch->kept_count * sizeof(int64_t));
    runner->kept = part(memory, &taken, (size_t)batch->kept_count * sizeof(Place));
    runner->when = part(memory, &taken, (size_t)batch->kept_count * sizeof(Place));
    runner->notes = part(memory, &taken, (size_t)batch->kept_count * sizeof(Note));
    for (int64_t m = 0; m < batch->model_count; m++) {
        const Library *model = lanes[m] ? &lanes[m]->table : batch->models[m];
        const size_t count = lanes[m] ? 1 : LANES;
        unsigned char *own = part(memory, &taken, count * (size_t)model->size);
        unsigned char *copy = part(memory, &taken, count * (size_t)model->outputs_size);
        const Slave slave = {.model = model, .lanes = lanes[m], .memory = own, .copy = copy, .every = LANE_INT(1)};
        if (memory) runner->slaves[m] = slave;
    }
    return taken;
}

/* Return whether the functions in lanes have the bits of this platform's, for 30,000 arguments of all sizes. */
LIBRARY_EXPORT int64_t lanes_agree(void) {
    int64_t differing = 0;
    for (double size = 1e-9; size < 1e8; size *= 1.01) {
        LaneCall turn = {.x = LANE_DOUBLE(NAN)}, tangent = turn, arc = turn;
        lane_d x;
        LANE_EACH(l) x[l] = size * (1.0 + 1e-3 * l) * (l % 2 ? -1.0 : 1.0);
        lane_sincos_of(&turn, LANE_INT(-1), x);
        lane_tan_of(&tangent, LANE_INT(-1), x);
        lane_atan_of(&arc, LANE_INT(-1), x);
        LANE_EACH(l) {
            differing += turn.result[l] != sin(x[l]) || turn.other[l] != cos(x[l]);
            differing += tangent.result[l] != tan(x[l]) || arc.result[l] != atan(x[l]);
        }
    }
    return differing == 0;
}

/* As batch_rows, without faults; lanes: for each model its form in lanes, or NULL. Returns 0, or -1 if there is no
 * memory. */
LIBRARY_EXPORT int64_t lane_rows(const Batch *batch, const LaneLibrary *const *lanes, int64_t rows,
                                 const double *params, const int64_t *times, double *out) {
    Runner runner = {.batch = batch};
    const int64_t time_width = 2 + batch->model_count;
    const size_t size = lay_out(&runner, lanes, NULL);
    unsigned char *memory = calloc(1, size + sizeof(lane_d));
    int64_t width = 0, next = 0;
    int is_every_step = 1;
    if (!memory) return -1;
    lay_out(&runner, lanes, memory + (sizeof(lane_d) - (uintptr_t)memory % sizeof(lane_d)) % sizeof(lane_d));
    for (int64_t m = 0; m < batch->model_count; m++) width += batch->models[m]->param_count;
    for (int64_t r = 0; r < rows; r++)
        for (int64_t m = 0; m < batch->model_count; m++) is_every_step &= times[r * time_width + 2 + m] == 1;
    connect(&runner, is_every_step);
    for (;;) {
        if (next < rows && lane_any(~runner.courses.busy) && !is_waiting(&runner.courses)) {
            for (int l = 0; l < LANES && next < rows; l++) {
                if (runner.courses.busy[l]) continue;
                begin(&runner, l, next, params + next * width, times + next * time_width);
                next++;
            }
        }
        if (!lane_any(runner.courses.busy)) break;
        exchange(&runner);
        note(&runner);
        finish(&runner, out);
        advance(&runner);
    }
    free(memory);
    return 0;
}
