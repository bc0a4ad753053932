/* Somebody's parking controller as an FMI 2.0 co-simulation FMU: two arcs in reverse. Names and units of its own. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#define FMI __declspec(dllexport)
#else
#define FMI __attribute__((visibility("default")))
#endif
typedef unsigned int ref;
enum { YAW, STEER, TARGET_SPEED, WHEEL_ANGLE, TURN_TIME, REALS };
enum { IDLE = 1, FIRST_ARC, SECOND_ARC, THERE };
typedef struct { double real[REALS]; int state, count, drives; double since; } Unit;

FMI const char *fmi2GetTypesPlatform(void) { return "default"; }
FMI const char *fmi2GetVersion(void) { return "2.0"; }
FMI void *fmi2Instantiate(const char *name, int type, const char *guid, const char *where, const void *f, int v, int l) {
    Unit *unit = calloc(1, sizeof *unit);
    if (strcmp(guid, "{two-arcs-1}") != 0) return NULL;
    unit->state = IDLE;
    unit->count = 1;
    unit->real[WHEEL_ANGLE] = 448.823;
    unit->real[TURN_TIME] = 2.0;
    return unit;
}
FMI void fmi2FreeInstance(void *c) { free(c); }
FMI int fmi2SetupExperiment(void *c, int d, double t, double s, int e, double x) { return 0; }
FMI int fmi2EnterInitializationMode(void *c) { return 0; }
FMI int fmi2ExitInitializationMode(void *c) { return 0; }
FMI int fmi2Terminate(void *c) { return 0; }
FMI int fmi2GetReal(void *c, const ref *r, size_t n, double *v) {
    for (size_t i = 0; i < n; i++) v[i] = ((Unit *)c)->real[r[i]];
    return 0;
}
FMI int fmi2SetReal(void *c, const ref *r, size_t n, const double *v) {
    for (size_t i = 0; i < n; i++) ((Unit *)c)->real[r[i]] = v[i];
    return 0;
}
FMI int fmi2GetInteger(void *c, const ref *r, size_t n, int *v) {
    for (size_t i = 0; i < n; i++) v[i] = r[i] == 10 ? ((Unit *)c)->state : ((Unit *)c)->count;
    return 0;
}
FMI int fmi2DoStep(void *c, double t, double h, int k) {
    Unit *u = c;
    int before = u->state, waited = u->since >= u->real[TURN_TIME];
    double yaw = -u->real[YAW]; /* clockwise positive, like its steering */
    if (u->state == IDLE && waited) u->state = FIRST_ARC;
    else if (u->state == FIRST_ARC && yaw >= 43.762) u->state = SECOND_ARC;
    else if (u->state == SECOND_ARC && waited && yaw <= 0.03) u->state = THERE;
    u->since = u->state == before ? u->since + h : 0.0;
    u->drives = u->state == FIRST_ARC || (u->state == SECOND_ARC && u->since >= u->real[TURN_TIME]);
    u->real[TARGET_SPEED] = u->drives ? -1.08 : 0.0;
    u->real[STEER] = u->state == THERE ? 0.0 : u->state == SECOND_ARC ? -u->real[WHEEL_ANGLE] : u->real[WHEEL_ANGLE];
    return 0;
}
