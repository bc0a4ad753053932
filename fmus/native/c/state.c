/* Saving, restoring and serializing the whole state of an instance. */
#include "core.h"

#include <stdlib.h>
#include <string.h>

/* A stretch of memory without padding: what a serialized state is made of. */
typedef struct {
    uint32_t offset;
    uint32_t size;
} FmuRun;

#define RUN(first, last) \
    {(uint32_t)MODEL(first), (uint32_t)(MODEL(last) + sizeof((FMU_MODEL *)0)->last - MODEL(first))},
static const FmuRun fmu_runs[] = {
#include FMU_RUNS
    {(uint32_t)offsetof(FmuSaved, time),
     (uint32_t)(offsetof(FmuSaved, stale) + sizeof(int32_t) - offsetof(FmuSaved, time))},
};
#undef RUN

/* Serialized form: this header, then the runs. For the same binary only. */
typedef struct {
    char magic[8];
    uint64_t model; /* hash of the token */
    uint64_t check; /* hash of the runs */
    uint64_t size;  /* of the runs */
} FmuHeader;

/* FNV-1a, 64 bit. */
static uint64_t fmu_hash(const void *data, size_t size) {
    uint64_t value = 14695981039346656037u;
    for (size_t i = 0; i < size; i++) value = (value ^ ((const unsigned char *)data)[i]) * 1099511628211u;
    return value;
}

static size_t fmu_runs_size(void) {
    size_t size = 0;
    for (size_t i = 0; i < sizeof fmu_runs / sizeof *fmu_runs; i++) size += fmu_runs[i].size;
    return size;
}

static size_t fmu_serialized_size(void) { return sizeof(FmuHeader) + fmu_runs_size(); }

static FmuHeader fmu_header(const unsigned char *runs) {
    FmuHeader header = {.magic = "APAFMU2",
                        .model = fmu_hash(FMU_TOKEN, sizeof FMU_TOKEN),
                        .check = fmu_hash(runs, fmu_runs_size()),
                        .size = fmu_runs_size()};
    return header;
}

static FmuStatus fmu_save(const FmuInstance *fmu, void **state, const char *function) {
    if (!state) return fmu_report(fmu, FMU_ERROR, "%s: null pointer", function);
    if (!*state) *state = malloc(sizeof fmu->saved);
    if (!*state) return fmu_report(fmu, FMU_ERROR, "%s: out of memory", function);
    memcpy(*state, &fmu->saved, sizeof fmu->saved);
    return FMU_OK;
}

static FmuStatus fmu_restore(FmuInstance *fmu, const void *state, const char *function) {
    if (!state) return fmu_report(fmu, FMU_ERROR, "%s: null pointer", function);
    memcpy(&fmu->saved, state, sizeof fmu->saved);
    return FMU_OK;
}

static FmuStatus fmu_forget(void **state) {
    if (!state) return FMU_OK;
    free(*state);
    *state = NULL;
    return FMU_OK;
}

static FmuStatus fmu_size(const FmuInstance *fmu, const void *state, size_t *size, const char *function) {
    if (!state || !size) return fmu_report(fmu, FMU_ERROR, "%s: null pointer", function);
    *size = fmu_serialized_size();
    return FMU_OK;
}

static FmuStatus fmu_serialize(const FmuInstance *fmu, const void *state, unsigned char *bytes, size_t size,
                               const char *function) {
    if (!state || !bytes) return fmu_report(fmu, FMU_ERROR, "%s: null pointer", function);
    if (size < fmu_serialized_size())
        return fmu_report(fmu, FMU_ERROR, "%s: %zu bytes are too few", function, size);
    unsigned char *to = bytes + sizeof(FmuHeader);
    for (size_t i = 0; i < sizeof fmu_runs / sizeof *fmu_runs; i++) {
        memcpy(to, (const unsigned char *)state + fmu_runs[i].offset, fmu_runs[i].size);
        to += fmu_runs[i].size;
    }
    const FmuHeader header = fmu_header(bytes + sizeof header);
    memcpy(bytes, &header, sizeof header);
    return FMU_OK;
}

static FmuStatus fmu_deserialize(const FmuInstance *fmu, const unsigned char *bytes, size_t size, void **state,
                                 const char *function) {
    if (!state || !bytes) return fmu_report(fmu, FMU_ERROR, "%s: null pointer", function);
    if (size < fmu_serialized_size())
        return fmu_report(fmu, FMU_ERROR, "%s: %zu bytes are too few", function, size);
    const unsigned char *from = bytes + sizeof(FmuHeader);
    const FmuHeader header = fmu_header(from);
    if (memcmp(&header, bytes, sizeof header))
        return fmu_report(fmu, FMU_ERROR, "%s: not a state of this FMU, or damaged", function);
    if (!*state) *state = calloc(1, sizeof(FmuSaved));
    if (!*state) return fmu_report(fmu, FMU_ERROR, "%s: out of memory", function);
    for (size_t i = 0; i < sizeof fmu_runs / sizeof *fmu_runs; i++) {
        memcpy((unsigned char *)*state + fmu_runs[i].offset, from, fmu_runs[i].size);
        from += fmu_runs[i].size;
    }
    return FMU_OK;
}
