/* The functions of FMI 2.0 for co-simulation. */
#include "fmi2.h"

typedef fmi2CallbackLogger FmuLogger;
static const char *const FMU_KIND_NAMES[] = {"Real", "Integer", "Enumeration", "Boolean"};
#define FMU_TOKEN_NAME "GUID"

#include "core.h"

/* The host takes the text as a printf format: what it would take for a directive is doubled. */
static void fmu_log(const FmuHost *host, FmuStatus status, const char *category, const char *message) {
    char escaped[1024], *to = escaped;
    for (const char *from = message; *from; from++) {
        if (*from == '%') *to++ = '%';
        *to++ = *from;
    }
    *to = '\0';
    host->logger(host->environment, host->name, (fmi2Status)status, category, escaped);
}

/* Each variable is one value. */
#define fmu_elements(reference) 1
#define fmu_offset(reference, number) (fmu_places[reference].offset)

#include "core.c"
#include "state.c"

#define FMU_NULL(fmu, function) (fmi2Status) fmu_report(fmu, FMU_ERROR, "%s: null pointer", function)

const char *fmi2GetTypesPlatform(void) { return "default"; }

const char *fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging_on) {
    (void)resources, (void)visible;
    if (!functions) return NULL;
    const FmuHost host = {"", functions->logger, functions->componentEnvironment, logging_on != fmi2False};
    if (type != fmi2CoSimulation) return fmu_tell(&host, FMU_ERROR, "this FMU is for co-simulation only"), NULL;
    return fmu_new(&host, name, guid);
}

void fmi2FreeInstance(fmi2Component c) { fmu_free(c); }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[]) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi2SetDebugLogging");
    return (fmi2Status)fmu_set_logging(fmu, on != fmi2False, count, categories, "fmi2SetDebugLogging");
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start_time,
                               fmi2Boolean stop_time_defined, fmi2Real stop_time) {
    (void)tolerance_defined, (void)tolerance;
    FmuInstance *fmu = fmu_in(c, FMU_INSTANTIATED, "fmi2SetupExperiment");
    return fmu ? (fmi2Status)fmu_set_times(fmu, start_time, stop_time_defined != fmi2False, stop_time) : fmi2Error;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    return (fmi2Status)fmu_enter(fmu_in(c, FMU_INSTANTIATED, "fmi2EnterInitializationMode"), FMU_INITIALIZATION);
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    return (fmi2Status)fmu_enter(fmu_in(c, FMU_INITIALIZATION, "fmi2ExitInitializationMode"), FMU_STEPPING);
}

fmi2Status fmi2Terminate(fmi2Component c) {
    return (fmi2Status)fmu_enter(fmu_in(c, FMU_STEPPING, "fmi2Terminate"), FMU_TERMINATED);
}

fmi2Status fmi2Reset(fmi2Component c) {
    return (fmi2Status)fmu_reset(fmu_in(c, FMU_ANY_PHASE, "fmi2Reset"));
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_rollback) {
    (void)no_rollback;
    FmuInstance *fmu = fmu_in(c, FMU_STEPPING, "fmi2DoStep");
    return fmu ? (fmi2Status)fmu_step(fmu, time, step, "fmi2DoStep") : fmi2Error;
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi2CancelStep");
    return fmu ? (fmi2Status)fmu_report(fmu, FMU_ERROR, "fmi2CancelStep: no step is ever pending") : fmi2Error;
}

#define FMU_IS_REAL(reference) fmu_is(reference, FMU_REAL)
#define FMU_IS_INTEGER(reference) (fmu_is(reference, FMU_INTEGER) || fmu_is(reference, FMU_ENUMERATION))
#define FMU_IS_BOOLEAN(reference) fmu_is(reference, FMU_BOOLEAN)
#define FMU_TRUTH(value) ((value) != fmi2False)

#define FMU_GET(Type, Kept, kind, is_known, convert)                                                               \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference references[], size_t count,                 \
                             fmi2##Type values[]) {                                                                \
        FmuInstance *fmu = fmu_in(c, FMU_READABLE, "fmi2Get" #Type);                                               \
        if (!fmu) return fmi2Error;                                                                                \
        if (count && (!references || !values)) return FMU_NULL(fmu, "fmi2Get" #Type);                              \
        fmu_refresh(fmu);                                                                                          \
        const FmuStretch *stretches = fmu_listed(&fmu->got[kind], references, count);                              \
        if (!stretches) {                                                                                          \
            for (size_t i = 0; i < count; i++)                                                                     \
                if (!is_known(references[i])) return (fmi2Status)fmu_unknown(fmu, references[i], "fmi2Get" #Type); \
            stretches = fmu_list(&fmu->got[kind], references, count, sizeof(Kept));                                \
        }                                                                                                          \
        if (stretches)                                                                                             \
            FMU_EACH(fmu, Kept, stretches, values, values[i] = convert(kept[i]))                                   \
        else                                                                                                       \
            for (size_t i = 0; i < count; i++)                                                                     \
                values[i] = convert(FMU_KEPT(fmu, Kept, fmu_offset(references[i], 0)));                            \
        return fmi2OK;                                                                                             \
    }

/* All values to be set are checked before the first is taken: a refused call changes nothing. */
#define FMU_SET(Type, Kept, kind, is_known, convert)                                                               \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference references[], size_t count,                 \
                             const fmi2##Type values[]) {                                                          \
        FmuInstance *fmu = fmu_in(c, FMU_SETTING_UP | FMU_STEPPING, "fmi2Set" #Type);                              \
        bool parameters = false;                                                                                   \
        if (!fmu) return fmi2Error;                                                                                \
        if (count && (!references || !values)) return FMU_NULL(fmu, "fmi2Set" #Type);                              \
        const FmuStretch *stretches = fmu_listed(&fmu->given[kind], references, count);                            \
        if (!stretches) {                                                                                          \
            for (size_t i = 0; i < count; i++) {                                                                   \
                if (!is_known(references[i])) return (fmi2Status)fmu_unknown(fmu, references[i], "fmi2Set" #Type); \
                if (fmu_places[references[i]].role == FMU_INPUT) continue;                                         \
                if (!fmu_is_settable(fmu, references[i], (double)convert(values[i]), "fmi2Set" #Type))             \
                    return fmi2Error;                                                                              \
                parameters = true;                                                                                 \
            }                                                                                                      \
            stretches = parameters ? NULL : fmu_list(&fmu->given[kind], references, count, sizeof(Kept));          \
        }                                                                                                          \
        if (stretches)                                                                                             \
            FMU_EACH(fmu, Kept, stretches, values, kept[i] = convert(values[i]))                                   \
        else                                                                                                       \
            for (size_t i = 0; i < count; i++)                                                                     \
                FMU_KEPT(fmu, Kept, fmu_offset(references[i], 0)) = convert(values[i]);                            \
        if (parameters) fmu_parameters_changed(fmu);                                                               \
        return fmi2OK;                                                                                             \
    }

FMU_GET(Real, double, FMU_REAL, FMU_IS_REAL, FMU_SAME)
FMU_GET(Integer, int64_t, FMU_INTEGER, FMU_IS_INTEGER, fmu_int32)
FMU_GET(Boolean, bool, FMU_BOOLEAN, FMU_IS_BOOLEAN, FMU_SAME)
FMU_SET(Real, double, FMU_REAL, FMU_IS_REAL, FMU_SAME)
FMU_SET(Integer, int64_t, FMU_INTEGER, FMU_IS_INTEGER, FMU_SAME)
FMU_SET(Boolean, bool, FMU_BOOLEAN, FMU_IS_BOOLEAN, FMU_TRUTH)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi2GetFMUstate");
    return fmu ? (fmi2Status)fmu_save(fmu, state, "fmi2GetFMUstate") : fmi2Error;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi2SetFMUstate");
    return fmu ? (fmi2Status)fmu_restore(fmu, state, "fmi2SetFMUstate") : fmi2Error;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi2FreeFMUstate");
    return fmu ? (fmi2Status)fmu_forget(state) : fmi2Error;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi2SerializedFMUstateSize");
    return fmu ? (fmi2Status)fmu_size(fmu, state, size, "fmi2SerializedFMUstateSize") : fmi2Error;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi2SerializeFMUstate");
    if (!fmu) return fmi2Error;
    return (fmi2Status)fmu_serialize(fmu, state, (unsigned char *)bytes, size, "fmi2SerializeFMUstate");
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi2DeSerializeFMUstate");
    if (!fmu) return fmi2Error;
    return (fmi2Status)fmu_deserialize(fmu, (const unsigned char *)bytes, size, state, "fmi2DeSerializeFMUstate");
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2String values[]) {
    (void)references, (void)values;
    return (fmi2Status)fmu_refuse(c, count, "fmi2GetString: this FMU has no strings");
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference references[], size_t count,
                         const fmi2String values[]) {
    (void)references, (void)values;
    return (fmi2Status)fmu_refuse(c, count, "fmi2SetString: this FMU has no strings");
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                        const fmi2ValueReference given[], size_t givens, const fmi2Real seed[],
                                        fmi2Real derivative[]) {
    (void)unknown, (void)given, (void)givens, (void)seed, (void)derivative;
    return (fmi2Status)fmu_refuse(c, unknowns, "fmi2GetDirectionalDerivative: not provided");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                       const fmi2Integer order[], const fmi2Real values[]) {
    (void)references, (void)order, (void)values;
    return (fmi2Status)fmu_refuse(c, count, "fmi2SetRealInputDerivatives: inputs are held, not interpolated");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                        const fmi2Integer order[], fmi2Real values[]) {
    (void)references, (void)order, (void)values;
    return (fmi2Status)fmu_refuse(c, count, "fmi2GetRealOutputDerivatives: not provided");
}

/* Steps are never pending, so most questions about them have no answer: fmi2Discard. */
static fmi2Status fmu_no_status(fmi2Component c, const void *value) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi2GetStatus");
    if (!fmu) return fmi2Error;
    return (fmi2Status)fmu_report(fmu, value ? FMU_DISCARD : FMU_ERROR,
                                  "no such status: every step is complete when it returns");
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    (void)kind;
    return fmu_no_status(c, value);
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    if (!c || !value || kind != fmi2LastSuccessfulTime) return fmu_no_status(c, value);
    *value = ((FmuInstance *)c)->saved.time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    (void)kind;
    return fmu_no_status(c, value);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    if (!c || !value || kind != fmi2Terminated) return fmu_no_status(c, value);
    *value = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    (void)kind;
    return fmu_no_status(c, value);
}
