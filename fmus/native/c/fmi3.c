/* The functions of FMI 3.0 for co-simulation. A variable may be an array of up to two dimensions. */
#include "fmi3.h"

typedef fmi3LogMessageCallback FmuLogger;
static const char *const FMU_KIND_NAMES[] = {"Float64", "Int32", "Enumeration", "Boolean"};
#define FMU_TOKEN_NAME "instantiation token"

#include "core.h"

static void fmu_log(const FmuHost *host, FmuStatus status, const char *category, const char *message) {
    host->logger(host->environment, (fmi3Status)status, category, message);
}

/* How many elements a variable has along two dimensions, and where the next along each is kept. */
typedef struct {
    uint32_t rows;
    uint32_t next_row;
    uint32_t columns;
    uint32_t next_column;
} FmuShape;

#define SCALAR {1, 0, 1, 0}
#define ARRAY(count, next) {count, (uint32_t)MODEL(next), 1, 0}
#define TABLE(rows, next_row, columns, next_column) \
    {rows, (uint32_t)MODEL(next_row), columns, (uint32_t)MODEL(next_column)}
#define VARIABLE(place, kind, role, name, least, greatest, shape) shape,
static const FmuShape fmu_shapes[] = {
#include FMU_VARIABLES
};
#undef VARIABLE

static size_t fmu_elements(fmi3ValueReference reference) {
    return (size_t)fmu_shapes[reference].rows * fmu_shapes[reference].columns;
}

/* Return where an element is kept in FmuSaved; they are counted row by row. */
static uint32_t fmu_offset(fmi3ValueReference reference, size_t number) {
    const FmuShape *shape = &fmu_shapes[reference];
    const uint32_t first = fmu_places[reference].offset;
    const uint32_t row = (uint32_t)(number / shape->columns), column = (uint32_t)(number % shape->columns);
    return number ? first + row * (shape->next_row - first) + column * (shape->next_column - first) : first;
}

#include "core.c"
#include "state.c"

#define FMU_NULL(fmu, function) (fmi3Status) fmu_report(fmu, FMU_ERROR, "%s: null pointer", function)

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging_on, fmi3Boolean event_mode, fmi3Boolean early_return,
                                         const fmi3ValueReference intermediate[], size_t intermediate_count,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update) {
    (void)resources, (void)visible, (void)early_return, (void)intermediate, (void)update;
    const FmuHost host = {"", log, environment, logging_on};
    if (event_mode) return fmu_tell(&host, FMU_ERROR, "this FMU has no event mode"), NULL;
    if (intermediate_count) return fmu_tell(&host, FMU_ERROR, "this FMU has no intermediate update"), NULL;
    return fmu_new(&host, name, token);
}

void fmi3FreeInstance(fmi3Instance c) { fmu_free(c); }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[]) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi3SetDebugLogging");
    return (fmi3Status)fmu_set_logging(fmu, on, count, categories, "fmi3SetDebugLogging");
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                       fmi3Float64 start_time, fmi3Boolean stop_time_defined, fmi3Float64 stop_time) {
    (void)tolerance_defined, (void)tolerance;
    FmuInstance *fmu = fmu_in(c, FMU_INSTANTIATED, "fmi3EnterInitializationMode");
    if (!fmu || fmu_set_times(fmu, start_time, stop_time_defined, stop_time)) return fmi3Error;
    return (fmi3Status)fmu_enter(fmu, FMU_INITIALIZATION);
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    return (fmi3Status)fmu_enter(fmu_in(c, FMU_INITIALIZATION, "fmi3ExitInitializationMode"), FMU_STEPPING);
}

fmi3Status fmi3Terminate(fmi3Instance c) {
    return (fmi3Status)fmu_enter(fmu_in(c, FMU_STEPPING, "fmi3Terminate"), FMU_TERMINATED);
}

fmi3Status fmi3Reset(fmi3Instance c) {
    return (fmi3Status)fmu_reset(fmu_in(c, FMU_ANY_PHASE, "fmi3Reset"));
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_rollback,
                      fmi3Boolean *event_handling_needed, fmi3Boolean *terminate, fmi3Boolean *early_return,
                      fmi3Float64 *last_time) {
    (void)no_rollback;
    FmuInstance *fmu = fmu_in(c, FMU_STEPPING, "fmi3DoStep");
    if (!fmu) return fmi3Error;
    const FmuStatus status = fmu_step(fmu, time, step, "fmi3DoStep");
    if (event_handling_needed) *event_handling_needed = false;
    if (terminate) *terminate = false;
    if (early_return) *early_return = false;
    if (last_time) *last_time = fmu->saved.time;
    return (fmi3Status)status;
}

/* True if all are variables of `kind` and have `value_count` elements together; reports the call if not. */
static bool fmu_fits(FmuInstance *fmu, const fmi3ValueReference references[], size_t count, FmuKind kind,
                     size_t value_count, const char *function) {
    size_t elements = 0;
    for (size_t i = 0; i < count; i++) {
        if (!fmu_is(references[i], kind)) return fmu_unknown(fmu, references[i], function), false;
        elements += fmu_elements(references[i]);
    }
    if (elements == value_count) return true;
    fmu_report(fmu, FMU_ERROR, "%s: %zu values for variables of %zu elements", function, value_count, elements);
    return false;
}

#define FMU_GET(Type, Kept, kind, convert)                                                               \
    fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference references[], size_t count,        \
                             fmi3##Type values[], size_t value_count) {                                  \
        FmuInstance *fmu = fmu_in(c, FMU_READABLE, "fmi3Get" #Type);                                     \
        if (!fmu) return fmi3Error;                                                                      \
        if (count && (!references || !values)) return FMU_NULL(fmu, "fmi3Get" #Type);                    \
        FmuList *list = &fmu->got[kind];                                                                 \
        const FmuStretch *stretches = fmu_listed(list, references, count);                               \
        if (!stretches || value_count != list->size) {                                                   \
            if (!fmu_fits(fmu, references, count, kind, value_count, "fmi3Get" #Type)) return fmi3Error; \
            stretches = fmu_list(list, references, count, sizeof(Kept));                                 \
        }                                                                                                \
        fmu_refresh(fmu);                                                                                \
        if (stretches)                                                                                   \
            FMU_EACH(fmu, Kept, stretches, values, values[i] = convert(kept[i]))                         \
        else                                                                                             \
            for (size_t i = 0; i < count; i++)                                                           \
                for (size_t k = 0; k < fmu_elements(references[i]); k++)                                 \
                    *values++ = convert(FMU_KEPT(fmu, Kept, fmu_offset(references[i], k)));              \
        return fmi3OK;                                                                                   \
    }

/* All values to be set are checked before the first is taken: a refused call changes nothing. */
#define FMU_SET(Type, Kept, kind)                                                                                \
    fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference references[], size_t count,                \
                             const fmi3##Type values[], size_t value_count) {                                    \
        FmuInstance *fmu = fmu_in(c, FMU_SETTING_UP | FMU_STEPPING, "fmi3Set" #Type);                            \
        const fmi3##Type *value = values;                                                                        \
        bool parameters = false;                                                                                 \
        if (!fmu) return fmi3Error;                                                                              \
        if (count && (!references || !values)) return FMU_NULL(fmu, "fmi3Set" #Type);                            \
        FmuList *list = &fmu->given[kind];                                                                       \
        const FmuStretch *stretches = fmu_listed(list, references, count);                                       \
        if (!stretches || value_count != list->size) {                                                           \
            if (!fmu_fits(fmu, references, count, kind, value_count, "fmi3Set" #Type)) return fmi3Error;         \
            for (size_t i = 0; i < count; i++)                                                                   \
                for (size_t k = 0; k < fmu_elements(references[i]); k++, value++) {                              \
                    if (fmu_places[references[i]].role == FMU_INPUT) continue;                                   \
                    if (!fmu_is_settable(fmu, references[i], (double)*value, "fmi3Set" #Type)) return fmi3Error; \
                    parameters = true;                                                                           \
                }                                                                                                \
            stretches = parameters ? NULL : fmu_list(list, references, count, sizeof(Kept));                     \
        }                                                                                                        \
        if (stretches)                                                                                           \
            FMU_EACH(fmu, Kept, stretches, values, kept[i] = values[i])                                          \
        else                                                                                                     \
            for (size_t i = 0; i < count; i++)                                                                   \
                for (size_t k = 0; k < fmu_elements(references[i]); k++)                                         \
                    FMU_KEPT(fmu, Kept, fmu_offset(references[i], k)) = *values++;                               \
        if (parameters) fmu_parameters_changed(fmu);                                                             \
        return fmi3OK;                                                                                           \
    }

FMU_GET(Float64, double, FMU_REAL, FMU_SAME)
FMU_GET(Int32, int64_t, FMU_INTEGER, fmu_int32)
FMU_GET(Int64, int64_t, FMU_ENUMERATION, FMU_SAME)
FMU_GET(Boolean, bool, FMU_BOOLEAN, FMU_SAME)
FMU_SET(Float64, double, FMU_REAL)
FMU_SET(Int32, int64_t, FMU_INTEGER)
FMU_SET(Int64, int64_t, FMU_ENUMERATION)
FMU_SET(Boolean, bool, FMU_BOOLEAN)

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi3GetFMUState");
    return fmu ? (fmi3Status)fmu_save(fmu, state, "fmi3GetFMUState") : fmi3Error;
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi3SetFMUState");
    return fmu ? (fmi3Status)fmu_restore(fmu, state, "fmi3SetFMUState") : fmi3Error;
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi3FreeFMUState");
    return fmu ? (fmi3Status)fmu_forget(state) : fmi3Error;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi3SerializedFMUStateSize");
    return fmu ? (fmi3Status)fmu_size(fmu, state, size, "fmi3SerializedFMUStateSize") : fmi3Error;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi3SerializeFMUState");
    return fmu ? (fmi3Status)fmu_serialize(fmu, state, bytes, size, "fmi3SerializeFMUState") : fmi3Error;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, "fmi3DeserializeFMUState");
    return fmu ? (fmi3Status)fmu_deserialize(fmu, bytes, size, state, "fmi3DeserializeFMUState") : fmi3Error;
}

#include "fmi3_absent.c"
