/* Life of an instance: instantiate, initialise, step, terminate, reset, free. FMI 2.0 co-simulation. */
#include "slave.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NANOSECONDS 1e9
#define LATEST 4e9            /* s; as nanoseconds still far from the end of 64 bits */
#define LONGEST_STEP 3600.0   /* s */
#define CLOCK_TOLERANCE 1000  /* ns between the master's clock and the FMU's */

static const char *const CATEGORIES[] = {"logAll", "logStatusWarning", "logStatusDiscard", "logStatusError",
                                         "logStatusFatal"};

fmi2Status report(const Slave *slave, fmi2Status status, const char *format, ...) {
    static const char *const category[] = {"logAll",         "logStatusWarning", "logStatusDiscard",
                                           "logStatusError", "logStatusFatal",   "logAll"};
    char message[512], escaped[2 * sizeof message]; /* the host takes the text as a printf format */
    va_list arguments;
    if (!slave->logger || (!slave->logging && status < fmi2Error)) return status;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    char *to = escaped;
    for (const char *from = message; *from; from++) {
        if (*from == '%') *to++ = '%';
        *to++ = *from;
    }
    *to = '\0';
    slave->logger(slave->environment, slave->name, status, category[status], escaped);
    return status;
}

Slave *slave_in(fmi2Component component, int phases, const char *function) {
    Slave *slave = component;
    if (!slave) return NULL;
    if (slave->saved.phase & phases) return slave;
    const char *now = slave->saved.phase == INSTANTIATED     ? "after instantiation"
                      : slave->saved.phase == INITIALIZATION ? "in initialization mode"
                      : slave->saved.phase == STEPPING       ? "between steps"
                      : slave->saved.phase == FAILED         ? "after a failed step"
                                                             : "after fmi2Terminate";
    report(slave, fmi2Error, "%s is not allowed %s", function, now);
    return NULL;
}

int refresh(Slave *slave) {
    Saved *saved = &slave->saved;
    void *result = NULL, *unused = NULL;
    if (!saved->stale) return 1;
    if (model_initialize(&result, &unused, saved->state, saved->values,
                         saved->values + MODEL_PARAMETERS + MODEL_INPUTS)) {
        saved->phase = FAILED;
        report(slave, fmi2Error, "the model failed to initialize");
        return 0;
    }
    saved->stale = 0;
    return 1;
}

static void start_values(Slave *slave) {
    memset(&slave->saved, 0, sizeof slave->saved);
    memcpy(slave->saved.values, model_starts, (MODEL_PARAMETERS + MODEL_INPUTS) * sizeof *model_starts);
    slave->saved.phase = INSTANTIATED;
    slave->saved.stale = 1;
}

const char *fmi2GetTypesPlatform(void) { return "default"; }

const char *fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging_on) {
    (void)resources, (void)visible;
    if (!functions) return NULL;
    Slave probe = {.name = (char *)(name ? name : ""),
                   .logger = functions->logger,
                   .environment = functions->componentEnvironment,
                   .logging = logging_on != 0};
    if (!name || !*name) return report(&probe, fmi2Error, "an instance needs a name"), NULL;
    if (type != fmi2CoSimulation) return report(&probe, fmi2Error, "this FMU is for co-simulation only"), NULL;
    if (!guid || strcmp(guid, model_guid))
        return report(&probe, fmi2Error, "GUID %s is not that of this binary, %s", guid ? guid : "(null)", model_guid),
               NULL;
    Slave *slave = malloc(sizeof *slave);
    char *copy = malloc(strlen(name) + 1);
    if (!slave || !copy) return free(slave), free(copy), report(&probe, fmi2Error, "out of memory"), NULL;
    *slave = probe;
    slave->name = strcpy(copy, name);
    start_values(slave);
    return slave;
}

void fmi2FreeInstance(fmi2Component component) {
    Slave *slave = component;
    if (!slave) return;
    free(slave->name);
    free(slave);
}

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t count, const fmi2String categories[]) {
    Slave *slave = slave_in(component, ANY_PHASE, "fmi2SetDebugLogging");
    if (!slave) return fmi2Error;
    if (count && !categories) return report(slave, fmi2Error, "fmi2SetDebugLogging: null pointer");
    for (size_t i = 0; i < count; i++) {
        size_t k = 0;
        while (k < sizeof CATEGORIES / sizeof *CATEGORIES && categories[i] && strcmp(categories[i], CATEGORIES[k])) k++;
        if (!categories[i] || k == sizeof CATEGORIES / sizeof *CATEGORIES)
            return report(slave, fmi2Error, "no log category %s", categories[i] ? categories[i] : "(null)");
    }
    slave->logging = on != 0;
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                               fmi2Real start_time, fmi2Boolean stop_time_defined, fmi2Real stop_time) {
    (void)tolerance_defined, (void)tolerance;
    Slave *slave = slave_in(component, INSTANTIATED, "fmi2SetupExperiment");
    if (!slave) return fmi2Error;
    if (!(fabs(start_time) <= LATEST)) return report(slave, fmi2Error, "start time %g s is no time", start_time);
    if (stop_time_defined && !(stop_time >= start_time))
        return report(slave, fmi2Error, "stop time %g s is not after start time %g s", stop_time, start_time);
    slave->saved.start_ns = slave->saved.now_ns = (int64_t)rint(start_time * NANOSECONDS);
    slave->saved.values[MODEL_TIME] = start_time;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
    Slave *slave = slave_in(component, INSTANTIATED, "fmi2EnterInitializationMode");
    if (!slave) return fmi2Error;
    slave->saved.phase = INITIALIZATION;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
    Slave *slave = slave_in(component, INITIALIZATION, "fmi2ExitInitializationMode");
    if (!slave || !refresh(slave)) return fmi2Error;
    slave->saved.phase = STEPPING;
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component component) {
    Slave *slave = slave_in(component, STEPPING | FAILED, "fmi2Terminate");
    if (!slave) return fmi2Error;
    slave->saved.phase = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component component) {
    Slave *slave = slave_in(component, ANY_PHASE, "fmi2Reset");
    if (!slave) return fmi2Error;
    start_values(slave);
    return fmi2OK;
}

/* The end of the step is rounded to whole nanoseconds, not its length: nothing adds up over many steps. */
fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real step, fmi2Boolean no_rollback) {
    (void)no_rollback;
    Slave *slave = slave_in(component, STEPPING, "fmi2DoStep");
    if (!slave) return fmi2Error;
    Saved *saved = &slave->saved;
    void *result = NULL, *unused = NULL;
    if (!(fabs(time) <= LATEST)) return report(slave, fmi2Error, "fmi2DoStep: %g s is no time", time);
    if (!(step > 0.0 && step <= LONGEST_STEP))
        return report(slave, fmi2Error, "fmi2DoStep: step size %g s is not in (0, %g] s", step, LONGEST_STEP);
    int64_t here = (int64_t)rint(time * NANOSECONDS);
    if (here > saved->now_ns + CLOCK_TOLERANCE || here < saved->now_ns - CLOCK_TOLERANCE)
        return report(slave, fmi2Error, "fmi2DoStep: called at %.9f s, but the FMU is at %.9f s", time,
                      (double)saved->now_ns / NANOSECONDS);
    int64_t end = (int64_t)rint((time + step) * NANOSECONDS);
    if (end <= saved->now_ns) return report(slave, fmi2Error, "fmi2DoStep: step size %g s is under a nanosecond", step);
    if (model_step(&result, &unused, saved->state, saved->values + MODEL_PARAMETERS, saved->values,
                   saved->values + MODEL_PARAMETERS + MODEL_INPUTS, end - saved->now_ns)) {
        saved->phase = FAILED;
        return report(slave, fmi2Error, "fmi2DoStep: the model failed at %.9f s", time);
    }
    saved->now_ns = end;
    saved->values[MODEL_TIME] = time + step;
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component component) {
    Slave *slave = slave_in(component, ANY_PHASE, "fmi2CancelStep");
    return slave ? report(slave, fmi2Error, "fmi2CancelStep: no step is ever pending") : fmi2Error;
}
