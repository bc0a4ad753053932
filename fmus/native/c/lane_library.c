/* The table of one model in lanes.
 *
 * The file that is compiled has included the model's C in lanes and defined LIBRARY_MODEL and LIBRARY_MEMBERS, as for
 * library.c.
 */
#include "lane_library.h"

typedef struct {
    LIBRARY_MODEL model;
    LaneCall calls[LANE_CALLS];
} LaneInstance;

/* Lay the parameters of one lane in, and initialize it; nothing of what it was remains. */
static void lanes_start(void *instance, int lane, const double *params) {
    LaneInstance *own = instance;
    LIBRARY_MODEL *model = &own->model;
    lane_i *vectors = instance, live = LANE_NONE;
    for (size_t i = 0; i < sizeof(LIBRARY_MODEL) / sizeof(lane_i); i++) vectors[i][lane] = 0;
    for (size_t i = 0; i < LANE_CALLS; i++) {
        LaneCall *call = &own->calls[i];
        call->x[lane] = call->result[lane] = call->other[lane] = NAN;
    }
    live[lane] = -1;
    LIBRARY_CALL(defaults)(own->calls, live, &model->params, &model->inputs);
    for (int64_t i = 0; i < LIBRARY_PARAMS; i++) {
        unsigned char *at = (unsigned char *)instance + library_places[i].offset + lane * (int64_t)sizeof(double);
        if (library_places[i].kind == LIBRARY_BOOLEAN)
            *(int64_t *)(void *)at = params[i] != 0.0 ? -1 : 0;
        else
            library_write(at, library_places[i].kind, params[i]);
    }
    LIBRARY_CALL(initialize)(own->calls, live, &model->params, &model->state, &model->outputs);
}

static void lanes_step(void *instance, const lane_i *live, const lane_i *dt_ns) {
    LaneInstance *own = instance;
    LIBRARY_MODEL *model = &own->model;
    LIBRARY_CALL(step)(own->calls, *live, &model->state, &model->inputs, &model->params, *dt_ns, &model->outputs);
}

static const LaneLibrary lane_table = {
    .table =
        {
            .size = sizeof(LaneInstance),
            LIBRARY_SIGNALS,
        },
    .lanes = LANES,
    .start = lanes_start,
    .step = lanes_step,
};

LIBRARY_EXPORT const LaneLibrary *lane_library(void) { return &lane_table; }
