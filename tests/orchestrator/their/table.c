/* A lookup table whose file's name is a text: FMI 2.0 and 3.0. The output is the sum of the letters of all its texts. */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#define FMI __declspec(dllexport)
#else
#define FMI __attribute__((visibility("default")))
#endif
typedef uint32_t ref;
typedef struct { double file, parts; } Table;

static double sum(const char *text) {
    double s = 0;
    for (const unsigned char *p = (const unsigned char *)text; *p; p++) s += *p;
    return s;
}
static void set(Table *t, const ref *r, size_t n, const char *const *v, size_t m) {
    for (size_t i = 0; i < n; i++) {
        if (r[i] == 1) t->file = sum(*v++);
        else for (t->parts = 0; m > 0; v++, m--) t->parts += sum(*v);
    }
}
FMI const char *fmi2GetTypesPlatform(void) { return "default"; }
FMI const char *fmi2GetVersion(void) { return "2.0"; }
FMI void *fmi2Instantiate(const char *n, int t, const char *g, const char *w, const void *f, int v, int l) {
    return calloc(1, sizeof(Table));
}
FMI void fmi2FreeInstance(void *c) { free(c); }
FMI int fmi2SetupExperiment(void *c, int d, double t, double s, int e, double x) { return 0; }
FMI int fmi2EnterInitializationMode(void *c) { return 0; }
FMI int fmi2ExitInitializationMode(void *c) { return 0; }
FMI int fmi2Terminate(void *c) { return 0; }
FMI int fmi2GetReal(void *c, const ref *r, size_t n, double *v) { *v = ((Table *)c)->file; return 0; }
FMI int fmi2SetString(void *c, const ref *r, size_t n, const char *const *v) { set(c, r, n, v, 0); return 0; }
FMI int fmi2DoStep(void *c, double t, double h, int k) { return 0; }
FMI const char *fmi3GetVersion(void) { return "3.0"; }
FMI void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *where, bool v, bool l, bool e,
        bool early, const ref *needed, size_t n, void *environment, void *log, void *update) {
    return calloc(1, sizeof(Table));
}
FMI void fmi3FreeInstance(void *c) { free(c); }
FMI int fmi3EnterInitializationMode(void *c, bool d, double t, double s, bool e, double x) { return 0; }
FMI int fmi3ExitInitializationMode(void *c) { return 0; }
FMI int fmi3Terminate(void *c) { return 0; }
FMI int fmi3GetFloat64(void *c, const ref *r, size_t n, double *v, size_t m) {
    *v = ((Table *)c)->file + 10000 * ((Table *)c)->parts;
    return 0;
}
FMI int fmi3SetString(void *c, const ref *r, size_t n, const char *const *v, size_t m) {
    for (size_t i = 0; i < n; i++) set(c, r + i, 1, v + i, r[i] == 1 ? 1 : m - i);
    return 0;
}
FMI int fmi3DoStep(void *c, double t, double h, bool no, bool *event, bool *end, bool *early, double *last) {
    *event = *end = *early = false;
    *last = t + h;
    return 0;
}
