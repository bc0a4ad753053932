/* A model as a table: its memory and its functions, for a host that knows no model by name. */
#ifndef LIBRARY_H
#define LIBRARY_H

#include <stdbool.h>
#include <stdint.h>

#ifdef LIBRARY_EXPORT /* said before: several models are linked into one file */
#elif defined(_WIN32)
#define LIBRARY_EXPORT __declspec(dllexport)
#else
#define LIBRARY_EXPORT __attribute__((visibility("default")))
#endif

typedef enum { LIBRARY_REAL, LIBRARY_INTEGER, LIBRARY_BOOLEAN } LibraryKind;

/* Where a variable is kept: double, int64_t or bool. */
typedef struct {
    uint32_t offset;
    uint32_t kind;
} LibraryPlace;

typedef struct {
    int64_t size; /* of an instance [bytes] */
    int64_t outputs_offset;
    int64_t outputs_size;
    int64_t param_count, input_count, output_count;
    const LibraryPlace *params, *inputs, *outputs;
    void (*start)(void *instance, const double *params); /* lays them in and initializes */
    void (*step)(void *instance, int64_t dt_ns);
} Library;

static inline double library_read(const unsigned char *at, uint32_t kind) {
    return kind == LIBRARY_REAL      ? *(const double *)(const void *)at
           : kind == LIBRARY_INTEGER ? (double)*(const int64_t *)(const void *)at
                                     : (double)*(const bool *)(const void *)at;
}

static inline void library_write(unsigned char *at, uint32_t kind, double value) {
    if (kind == LIBRARY_REAL)
        *(double *)(void *)at = value;
    else if (kind == LIBRARY_INTEGER)
        *(int64_t *)(void *)at = (int64_t)value;
    else
        *(bool *)(void *)at = value != 0.0;
}

#ifdef LIBRARY_MEMBERS /* a file that has one model: LIBRARY_MODEL, see library.c */
#include LIBRARY_MEMBERS

#include <stddef.h>

#define LIBRARY_PASTE(a, b) a##b
#define LIBRARY_JOIN(a, b) LIBRARY_PASTE(a, b)
#define LIBRARY_CALL(function) LIBRARY_JOIN(LIBRARY_MODEL, _##function)

#define MEMBER(path, kind) {(uint32_t)offsetof(LIBRARY_MODEL, path), LIBRARY_##kind},
static const LibraryPlace library_places[] = {
#include LIBRARY_MEMBERS
};
#undef MEMBER

#define LIBRARY_SIGNALS                                                \
    .outputs_offset = offsetof(LIBRARY_MODEL, outputs),                \
    .outputs_size = sizeof((LIBRARY_MODEL *)0)->outputs,               \
    .param_count = LIBRARY_PARAMS,                                     \
    .input_count = LIBRARY_INPUTS,                                     \
    .output_count = LIBRARY_OUTPUTS,                                   \
    .params = library_places,                                          \
    .inputs = library_places + LIBRARY_PARAMS,                         \
    .outputs = library_places + LIBRARY_PARAMS + LIBRARY_INPUTS
#endif

#endif
