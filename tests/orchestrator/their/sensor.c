/* Somebody's position sensor as an FMI 3.0 co-simulation FMU: a pose with an error along x, late by one step. */
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
typedef struct { double in[3], out[3], bias; int32_t samples; bool valid, on; int64_t quality; } Sensor;

FMI const char *fmi3GetVersion(void) { return "3.0"; }
FMI void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *where, bool v, bool l, bool e,
        bool early, const ref *needed, size_t n, void *environment, void *log, void *update) {
    Sensor *sensor = calloc(1, sizeof *sensor);
    sensor->on = true;
    sensor->quality = 1;
    return strcmp(token, "sensor-3") == 0 ? sensor : NULL;
}
FMI void fmi3FreeInstance(void *c) { free(c); }
FMI int fmi3EnterInitializationMode(void *c, bool d, double t, double s, bool e, double x) { return 0; }
FMI int fmi3ExitInitializationMode(void *c) { return 0; }
FMI int fmi3Terminate(void *c) { return 0; }
FMI int fmi3SetFloat64(void *c, const ref *r, size_t n, const double *v, size_t m) {
    Sensor *s = c;
    for (size_t i = 0; i < n; i++) {
        if (r[i] == 1) { memcpy(s->in, v, sizeof s->in); v += 3; } else s->bias = *v++;
    }
    return 0;
}
FMI int fmi3GetFloat64(void *c, const ref *r, size_t n, double *v, size_t m) {
    for (size_t i = 0; i < n; i++, v += 3) memcpy(v, ((Sensor *)c)->out, 3 * sizeof *v);
    return m == 3 * n ? 0 : 3;
}
FMI int fmi3GetInt32(void *c, const ref *r, size_t n, int32_t *v, size_t m) { *v = ((Sensor *)c)->samples; return 0; }
FMI int fmi3GetInt64(void *c, const ref *r, size_t n, int64_t *v, size_t m) { *v = ((Sensor *)c)->quality; return 0; }
FMI int fmi3GetBoolean(void *c, const ref *r, size_t n, bool *v, size_t m) { *v = ((Sensor *)c)->valid; return 0; }
FMI int fmi3SetBoolean(void *c, const ref *r, size_t n, const bool *v, size_t m) { ((Sensor *)c)->on = *v; return 0; }
FMI int fmi3DoStep(void *c, double t, double h, bool no, bool *event, bool *end, bool *early, double *last) {
    Sensor *s = c;
    s->valid = s->on;
    s->samples++;
    s->quality = s->samples > 10 ? 3 : 2;
    memcpy(s->out, s->in, sizeof s->out);
    s->out[0] += s->bias;
    *event = *end = *early = false;
    *last = t + h;
    return 0;
}
