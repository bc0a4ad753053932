/* Loops over functions of the controller's C, for bench_controllers.py. */
#include "Controller.c"

#define LIBRARY_MODEL Controller
#define LIBRARY_MEMBERS "Controller_members.h"
#include "library.c"

static const double peaks5[5] = {-3.0, -1.5, 0.0, 1.5, 3.0};
static const double peaks7[7] = {-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0};

/* Lay rows of inputs, as doubles, into structs. */
LIBRARY_EXPORT void bench_inputs(const double *values, int64_t rows, ControllerInput *inputs) {
    const size_t begin = offsetof(Controller, inputs);
    for (int64_t r = 0; r < rows; r++)
        for (int64_t i = 0; i < library_table.input_count; i++) {
            const LibraryPlace place = library_table.inputs[i];
            library_write((unsigned char *)&inputs[r] + place.offset - begin, place.kind, *values++);
        }
}

LIBRARY_EXPORT int64_t bench_inputs_size(void) { return sizeof(ControllerInput); }

/* Step a controller that model_start has begun through rows of inputs, and hand out its last outputs. */
LIBRARY_EXPORT void bench_replay(Controller *model, const ControllerInput *inputs, int64_t rows, int64_t step_ns,
                                 double *outputs) {
    for (int64_t r = 0; r < rows; r++)
        Controller_step(&model->state, &inputs[r], &model->params, step_ns, &model->outputs);
    library_take((const unsigned char *)model, outputs);
}

/* Return the sum of the outputs at all points, so that none can be left out. */
LIBRARY_EXPORT double bench_infer(const double *points, int64_t rows) {
    double total = 0.0;
    for (int64_t r = 0; r < rows; r++)
        total += infer(points[2 * r], points[2 * r + 1], peaks5, peaks5, peaks7, STEERING_SYMMETRIC);
    return total;
}

/* Return the sum of the first increments of `count` solutions of one problem; stages and weights are all doubles. */
LIBRARY_EXPORT double bench_solve(int64_t count, double e, double psi, double d, const void *stages,
                                  const void *weights) {
    double total = 0.0;
    Solution solution;
    for (int64_t k = 0; k < count; k++) {
        const Initial now = {e + 1e-9 * (double)k, psi, d};
        solve(&now, stages, weights, 1e-10, 40, &solution);
        total += solution.nodes[0].u;
    }
    return total;
}
