/* One instance of the FMU, shared by the files that make up the FMI side. */
#ifndef SLAVE_H
#define SLAVE_H

#include <stdint.h>

#include "fmi2.h"
#include "model.h"

typedef enum {
    INSTANTIATED = 1,
    INITIALIZATION = 2,
    STEPPING = 4,
    FAILED = 8, /* the model gave up in a step: read, reset or free */
    TERMINATED = 16
} Phase;

#define ANY_PHASE (INSTANTIATED | INITIALIZATION | STEPPING | FAILED | TERMINATED)
#define READABLE (INITIALIZATION | STEPPING | FAILED | TERMINATED)

/* All that a saved FMU state holds: plain numbers, no pointers. */
typedef struct {
    double values[MODEL_VARIABLES];
    double state[MODEL_STATES + 1]; /* never of length zero */
    int64_t now_ns;                 /* time on the master's clock */
    int64_t start_ns;
    int32_t phase;
    int32_t stale; /* a parameter has changed since model_initialize ran */
} Saved;

typedef struct {
    Saved saved;
    char *name;
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    int logging;
} Slave;

/* Return the slave if the call is allowed in one of `phases`, else report it and return NULL. */
Slave *slave_in(fmi2Component component, int phases, const char *function);

/* Report a message of up to 500 characters and return `status`. */
fmi2Status report(const Slave *slave, fmi2Status status, const char *format, ...);

/* Run model_initialize if a parameter has changed since it last ran; false if it failed. */
int refresh(Slave *slave);

#endif
