/* What the FMI side must know of one model: its tables and its two functions.
 *
 * Every scalar is a double, in the order of the value references: parameters, inputs, outputs,
 * then time. A value reference is the place in this list.
 */
#ifndef MODEL_H
#define MODEL_H

#include <stdint.h>

#include "model_sizes.h" /* MODEL_PARAMETERS, MODEL_INPUTS, MODEL_OUTPUTS, MODEL_STATES */

#define MODEL_VARIABLES (MODEL_PARAMETERS + MODEL_INPUTS + MODEL_OUTPUTS + 1)
#define MODEL_TIME (MODEL_VARIABLES - 1)

typedef enum { REAL, INTEGER, BOOLEAN } Kind;

extern const char model_guid[];
extern const unsigned char model_kinds[MODEL_VARIABLES];
extern const double model_starts[MODEL_PARAMETERS + MODEL_INPUTS + 1];
extern const double model_limits[MODEL_PARAMETERS + 1][2]; /* a parameter outside is refused */
extern const uint32_t model_name_places[MODEL_VARIABLES];
extern const char model_names[]; /* one after the other: no pointers to be relocated */

/* Compiled from the Python source. They return 0 if all went well; the first two arguments belong
 * to the calling convention of the compiler and carry nothing here. */
int32_t model_initialize(void **result, void **unused, double *state, const double *parameters, double *outputs);
int32_t model_step(void **result, void **unused, double *state, const double *inputs, const double *parameters,
                   double *outputs, int64_t dt_ns);

#endif
