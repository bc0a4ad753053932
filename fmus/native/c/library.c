/* The table of one model, and two functions over arrays of doubles for a host that calls step by step.
 *
 * The file that is compiled has included the model's C and defined LIBRARY_MODEL, and LIBRARY_MEMBERS: the file that
 * says how many parameters, inputs and outputs there are, with a line MEMBER(path, kind) for each. LIBRARY_STORE(model)
 * is where the model's step finds its work arrays, with a comma; left out if it has none.
 */
#include "library.h"

#include <string.h>

#ifndef LIBRARY_STORE
#define LIBRARY_STORE(model)
#endif

static void library_put(void *instance, const LibraryPlace *places, int64_t count, const double *values) {
    for (int64_t i = 0; i < count; i++)
        library_write((unsigned char *)instance + places[i].offset, places[i].kind, values[i]);
}

static void library_start(void *instance, const double *params) {
    LIBRARY_MODEL *model = instance;
    memset(instance, 0, sizeof(LIBRARY_MODEL));
    LIBRARY_CALL(defaults)(&model->params, &model->inputs);
    library_put(instance, library_places, LIBRARY_PARAMS, params);
    LIBRARY_CALL(initialize)(&model->params, &model->state, &model->outputs);
}

static void library_step(void *instance, int64_t dt_ns) {
    LIBRARY_MODEL *model = instance;
    LIBRARY_CALL(step)(LIBRARY_STORE(model) &model->state, &model->inputs, &model->params, dt_ns, &model->outputs);
}

static const Library library_table = {
    .size = sizeof(LIBRARY_MODEL),
    LIBRARY_SIGNALS,
    .start = library_start,
    .step = library_step,
};

LIBRARY_EXPORT const Library *model_library(void) { return &library_table; }

static void library_take(const unsigned char *instance, double *outputs) {
    for (int64_t i = 0; i < LIBRARY_OUTPUTS; i++) {
        const LibraryPlace place = library_table.outputs[i];
        outputs[i] = library_read(instance + place.offset, place.kind);
    }
}

/* Lay `params` into the memory of an instance, initialize it, and hand out its outputs. */
LIBRARY_EXPORT void model_start(unsigned char *instance, const double *params, double *outputs) {
    library_start(instance, params);
    library_take(instance, outputs);
}

/* Move an instance on by `dt_ns` with `inputs`, and hand out its outputs. */
LIBRARY_EXPORT void model_step(unsigned char *instance, const double *inputs, double *outputs, int64_t dt_ns) {
    library_put(instance, library_table.inputs, LIBRARY_INPUTS, inputs);
    library_step(instance, dt_ns);
    library_take(instance, outputs);
}
