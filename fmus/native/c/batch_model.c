/* Shows a model's two compiled functions to batch.c, without what only their compiler's calling convention needs. */
#include <stdint.h>

int32_t model_initialize(void **result, void **unused, double *state, const double *parameters, double *outputs);
int32_t model_step(void **result, void **unused, double *state, const double *inputs, const double *parameters,
                   double *outputs, int64_t dt_ns);

__attribute__((visibility("default"))) int32_t
batch_initialize(double *state, const double *parameters, double *outputs) {
    void *result, *unused;
    return model_initialize(&result, &unused, state, parameters, outputs);
}

__attribute__((visibility("default"))) int32_t
batch_step(double *state, const double *inputs, const double *parameters, double *outputs, int64_t dt_ns) {
    void *result, *unused;
    return model_step(&result, &unused, state, inputs, parameters, outputs, dt_ns);
}
