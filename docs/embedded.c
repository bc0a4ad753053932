/* What docs/embedded.py asks of a model: sizes of its memory, and the time of each step of a drive. */
#define _POSIX_C_SOURCE 199309L
#include EMBEDDED_SOURCE

#define LIBRARY_MODEL EMBEDDED_MODEL
#define LIBRARY_MEMBERS EMBEDDED_MEMBERS
#include "library.c"

#include <time.h>

LIBRARY_EXPORT void embedded_sizes(int64_t *sizes) {
    const EMBEDDED_MODEL *model = 0;
    sizes[0] = sizeof(model->params);
    sizes[1] = sizeof(model->inputs);
    sizes[2] = sizeof(model->outputs);
    sizes[3] = sizeof(model->state);
    sizes[4] = sizeof(*model);
}

/* Step an instance that model_start has begun through rows of inputs; `least` [ns] falls to each step's time. */
LIBRARY_EXPORT void embedded_drive(EMBEDDED_MODEL *model, const double *values, int64_t rows, int64_t step_ns,
                                   double *least) {
    for (int64_t r = 0; r < rows; r++) {
        for (int64_t i = 0; i < library_table.input_count; i++) {
            const LibraryPlace place = library_table.inputs[i];
            library_write((unsigned char *)model + place.offset, place.kind, *values++);
        }
        struct timespec begun, over;
        clock_gettime(CLOCK_MONOTONIC, &begun);
        library_step(model, step_ns);
        clock_gettime(CLOCK_MONOTONIC, &over);
        const double spent = 1e9 * (double)(over.tv_sec - begun.tv_sec) + (double)(over.tv_nsec - begun.tv_nsec);
        if (spent < least[r]) least[r] = spent;
    }
}
