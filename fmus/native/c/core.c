/* Life of an instance: made, initialized, stepped, ended; its clock; what may be set when; messages. */
#include "core.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FMU_NANOSECONDS 1e9
#define FMU_LATEST 4e9           /* s; as nanoseconds still far from the end of 64 bits */
#define FMU_LONGEST_STEP 3600.0  /* s */
#define FMU_CLOCK_TOLERANCE 1000 /* ns between the master's clock and the FMU's */

static const char *const FMU_CATEGORIES[] = {"logAll", "logStatusWarning", "logStatusDiscard", "logStatusError",
                                             "logStatusFatal"};
#define FMU_CATEGORY_COUNT (sizeof FMU_CATEGORIES / sizeof *FMU_CATEGORIES)

/* Hand a message of up to 500 characters to the host's logger and return `status`. */
static FmuStatus fmu_tell(const FmuHost *host, FmuStatus status, const char *format, ...) {
    char message[512];
    va_list arguments;
    if (!host->logger || (!host->logging && status < FMU_ERROR)) return status;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    fmu_log(host, status, FMU_CATEGORIES[status], message);
    return status;
}

#define fmu_report(fmu, ...) fmu_tell(&(fmu)->host, __VA_ARGS__)

/* Return the instance if the call is allowed in one of `phases`, else report it and return NULL. */
static FmuInstance *fmu_in(void *instance, int phases, const char *function) {
    FmuInstance *fmu = instance;
    if (!fmu || fmu->saved.phase & phases) return fmu;
    const char *now = fmu->saved.phase == FMU_INSTANTIATED     ? "after instantiation"
                      : fmu->saved.phase == FMU_INITIALIZATION ? "in initialization mode"
                      : fmu->saved.phase == FMU_STEPPING       ? "between steps"
                                                               : "after termination";
    fmu_report(fmu, FMU_ERROR, "%s is not allowed %s", function, now);
    return NULL;
}

/* Initialize the model if a parameter has changed since it last was. */
static void fmu_refresh(FmuInstance *fmu) {
    FMU_MODEL *model = &fmu->saved.model;
    if (!fmu->saved.stale) return;
    FMU_CALL(initialize)(&model->params, &model->state, &model->outputs);
    fmu->saved.stale = 0;
}

static void fmu_start_values(FmuInstance *fmu) {
    memset(&fmu->saved, 0, sizeof fmu->saved);
    fmu->stop_ns = INT64_MAX;
    FMU_CALL(defaults)(&fmu->saved.model.params, &fmu->saved.model.inputs);
    fmu->saved.phase = FMU_INSTANTIATED;
    fmu->saved.stale = 1;
}

/* Return a new instance for `host`, whose name is copied; NULL if the token is another FMU's. */
static FmuInstance *fmu_new(const FmuHost *host, const char *name, const char *token) {
    if (!name || !*name) return fmu_tell(host, FMU_ERROR, "an instance needs a name"), NULL;
    if (!token || strcmp(token, FMU_TOKEN)) {
        fmu_tell(host, FMU_ERROR, FMU_TOKEN_NAME " %s is not that of this binary, %s", token ? token : "(null)",
                 FMU_TOKEN);
        return NULL;
    }
    FmuInstance *fmu = calloc(1, sizeof *fmu);
    char *copy = malloc(strlen(name) + 1);
    if (!fmu || !copy) return free(fmu), free(copy), fmu_tell(host, FMU_ERROR, "out of memory"), NULL;
    fmu->host = *host;
    fmu->host.name = strcpy(copy, name);
    fmu_start_values(fmu);
    return fmu;
}

static void fmu_free(void *instance) {
    FmuInstance *fmu = instance;
    if (!fmu) return;
    free((void *)fmu->host.name);
    free(fmu);
}

/* Put the instance into another phase; it is NULL if the call is not allowed. */
static FmuStatus fmu_enter(FmuInstance *fmu, FmuPhase phase) {
    if (!fmu) return FMU_ERROR;
    if (phase == FMU_STEPPING) fmu_refresh(fmu);
    fmu->saved.phase = (int32_t)phase;
    return FMU_OK;
}

static FmuStatus fmu_reset(FmuInstance *fmu) {
    if (!fmu) return FMU_ERROR;
    fmu_start_values(fmu);
    return FMU_OK;
}

static FmuStatus fmu_set_logging(FmuInstance *fmu, bool on, size_t count, const char *const categories[],
                                 const char *function) {
    if (!fmu) return FMU_ERROR;
    if (count && !categories) return fmu_report(fmu, FMU_ERROR, "%s: null pointer", function);
    for (size_t i = 0; i < count; i++) {
        const char *name = categories[i] ? categories[i] : "(null)";
        size_t k = 0;
        while (k < FMU_CATEGORY_COUNT && strcmp(name, FMU_CATEGORIES[k])) k++;
        if (k == FMU_CATEGORY_COUNT) return fmu_report(fmu, FMU_ERROR, "no log category %s", name);
    }
    fmu->host.logging = on;
    return FMU_OK;
}

static FmuStatus fmu_set_times(FmuInstance *fmu, double start, bool has_stop, double stop) {
    if (!(fabs(start) <= FMU_LATEST)) return fmu_report(fmu, FMU_ERROR, "start time %g s is no time", start);
    if (has_stop && !(stop >= start))
        return fmu_report(fmu, FMU_ERROR, "stop time %g s is not after start time %g s", stop, start);
    fmu->saved.start_ns = fmu->saved.now_ns = (int64_t)llrint(start * FMU_NANOSECONDS);
    fmu->saved.time = start;
    fmu->stop_ns = has_stop && stop <= FMU_LATEST ? (int64_t)llrint(stop * FMU_NANOSECONDS) : INT64_MAX;
    return FMU_OK;
}

/* The end of the step is rounded to whole nanoseconds, not its length: nothing adds up over many steps. A step
 * that is over before the clock's next nanosecond does nothing: a master that adds up t += h makes one at the end. */
static FmuStatus fmu_step(FmuInstance *fmu, double time, double step, const char *function) {
    FmuSaved *saved = &fmu->saved;
    FMU_MODEL *model = &saved->model;
    if (!(fabs(time) <= FMU_LATEST)) return fmu_report(fmu, FMU_ERROR, "%s: %g s is no time", function, time);
    if (!(step > 0.0 && step <= FMU_LONGEST_STEP))
        return fmu_report(fmu, FMU_ERROR, "%s: step size %g s is not in (0, %g] s", function, step, FMU_LONGEST_STEP);
    const int64_t here = (int64_t)llrint(time * FMU_NANOSECONDS);
    if (here > saved->now_ns + FMU_CLOCK_TOLERANCE || here < saved->now_ns - FMU_CLOCK_TOLERANCE)
        return fmu_report(fmu, FMU_ERROR, "%s: called at %.9f s, but the FMU is at %.9f s", function, time,
                          (double)saved->now_ns / FMU_NANOSECONDS);
    const int64_t end = (int64_t)llrint((time + step) * FMU_NANOSECONDS);
    if (end - FMU_CLOCK_TOLERANCE > fmu->stop_ns)
        return fmu_report(fmu, FMU_ERROR, "%s: the step to %.9f s is beyond the stop time %.9f s", function, time + step,
                          (double)fmu->stop_ns / FMU_NANOSECONDS);
    if (end <= saved->now_ns) return FMU_OK;
    const int64_t length = end - saved->now_ns;
    FMU_CALL(step)(FMU_STORE(model) &model->state, &model->inputs, &model->params, length, &model->outputs);
    saved->now_ns = end;
    saved->time = time + step;
    return FMU_OK;
}

/* Report a value reference that is not known as a variable of the type that `function` is for. */
static FmuStatus fmu_unknown(const FmuInstance *fmu, uint32_t reference, const char *function) {
    if (reference >= FMU_COUNT)
        return fmu_report(fmu, FMU_ERROR, "%s: no value reference %u; the last is %u", function, (unsigned)reference,
                          (unsigned)FMU_COUNT - 1);
    return fmu_report(fmu, FMU_ERROR, "%s: %s (value reference %u) is %s", function, fmu_name(reference),
                      (unsigned)reference, FMU_KIND_NAMES[fmu_places[reference].kind]);
}

/* Note what a call that is in order is about, numbers of `width` bytes. Returns where its values are kept, or NULL if
 * they are too many. */
static const FmuStretch *fmu_list(FmuList *list, const uint32_t references[], size_t count, size_t width) {
    FmuStretch *next = list->stretches;
    list->count = list->size = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < fmu_elements(references[i]); k++) {
            const uint32_t offset = fmu_offset(references[i], k);
            if (list->size++ == FMU_LISTED) return NULL;
            list->references[i] = references[i];
            if (next > list->stretches && offset == next[-1].first + next[-1].count * width)
                next[-1].count++;
            else
                *next++ = (FmuStretch){offset, 1};
        }
    next->count = 0;
    list->count = count;
    return list->stretches;
}

/* Refuse a call that the FMU declares it cannot do, unless it asks for nothing. */
static FmuStatus fmu_refuse(void *instance, size_t count, const char *message) {
    const FmuInstance *fmu = fmu_in(instance, FMU_ANY_PHASE, message);
    if (!fmu) return FMU_ERROR;
    return count ? fmu_report(fmu, FMU_ERROR, "%s", message) : FMU_OK;
}

/* True if the variable, which is no input, may be set now, and to this value; reports the call if not. */
static bool fmu_is_settable(const FmuInstance *fmu, uint32_t reference, double value, const char *function) {
    const FmuLabel *label = &fmu_labels[reference];
    const bool before = fmu->saved.phase & FMU_SETTING_UP;
    if (fmu_places[reference].role == FMU_CALCULATED)
        fmu_report(fmu, FMU_ERROR, "%s: %s is calculated by the FMU", function, label->name);
    else if (fmu_places[reference].role == FMU_FIXED && !before)
        fmu_report(fmu, FMU_ERROR, "%s: parameter %s is fixed after initialization", function, label->name);
    else if (!(label->least <= value && value <= label->greatest))
        fmu_report(fmu, FMU_ERROR, "%s: %s = %.17g is not in [%g, %g]", function, label->name, value, label->least,
                   label->greatest);
    else
        return true;
    return false;
}

/* After parameters were set: before the first step the model is initialized with them, later it goes on with them. */
static void fmu_parameters_changed(FmuInstance *fmu) {
    if (fmu->saved.phase & FMU_SETTING_UP) fmu->saved.stale = 1;
}
