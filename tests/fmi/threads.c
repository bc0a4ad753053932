/* Several threads, each with instances of its own, linked with the FMU and made with ThreadSanitizer: threads TOKEN */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#if FMI == 3
#include "fmi3.h"
#else
#include "fmi2.h"
#endif

enum { THREADS = 4, INSTANCES = 4, STEPS = 200 };
static const char *token;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static long messages;

static void count(void) {
    pthread_mutex_lock(&lock);
    messages++;
    pthread_mutex_unlock(&lock);
}

#if FMI == 3
typedef fmi3Instance Slave;
static void logger(fmi3InstanceEnvironment e, fmi3Status s, fmi3String c, fmi3String m) {
    (void)e, (void)s, (void)c, (void)m;
    count();
}
static Slave create(const char *name) {
    return fmi3InstantiateCoSimulation(name, token, NULL, false, true, false, false, NULL, 0, NULL, logger, NULL);
}
static int begin(Slave slave) {
    return fmi3EnterInitializationMode(slave, false, 0, 0, false, 0) || fmi3ExitInitializationMode(slave);
}
static int step(Slave slave, int k) {
    bool event, end, early;
    double time, value;
    const fmi3ValueReference none = 1000000;
    if (fmi3GetFloat64(slave, &none, 1, &value, 1) != fmi3Error) return 1;
    return fmi3DoStep(slave, k * 0.01, 0.01, true, &event, &end, &early, &time);
}
static int state(Slave slave) {
    fmi3FMUState saved = NULL;
    return fmi3GetFMUState(slave, &saved) || fmi3SetFMUState(slave, saved) || fmi3FreeFMUState(slave, &saved);
}
#define FREE fmi3FreeInstance
#else
typedef fmi2Component Slave;
static void logger(fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String c, fmi2String m, ...) {
    (void)e, (void)n, (void)s, (void)c, (void)m;
    count();
}
static const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};
static Slave create(const char *name) {
    return fmi2Instantiate(name, fmi2CoSimulation, token, NULL, &callbacks, 0, 1);
}
static int begin(Slave slave) {
    return fmi2SetupExperiment(slave, 0, 0, 0, 0, 0) || fmi2EnterInitializationMode(slave) ||
           fmi2ExitInitializationMode(slave);
}
static int step(Slave slave, int k) {
    double value;
    const fmi2ValueReference none = 1000000;
    if (fmi2GetReal(slave, &none, 1, &value) != fmi2Error) return 1;
    return fmi2DoStep(slave, k * 0.01, 0.01, 1);
}
static int state(Slave slave) {
    fmi2FMUstate saved = NULL;
    return fmi2GetFMUstate(slave, &saved) || fmi2SetFMUstate(slave, saved) || fmi2FreeFMUstate(slave, &saved);
}
#define FREE fmi2FreeInstance
#endif

static void *drive(void *failed) {
    Slave slaves[INSTANCES];
    for (int i = 0; i < INSTANCES; i++)
        if (!(slaves[i] = create("one")) || begin(slaves[i])) *(int *)failed = 1;
    for (int k = 0; k < STEPS && !*(int *)failed; k++)
        for (int i = 0; i < INSTANCES; i++)
            if (step(slaves[i], k) || (k % 10 == 0 && state(slaves[i]))) *(int *)failed = 1;
    for (int i = 0; i < INSTANCES; i++) FREE(slaves[i]);
    return NULL;
}

int main(int words, char **word) {
    pthread_t threads[THREADS];
    int failed[THREADS] = {0}, any = words < 2;
    token = word[1];
    for (int t = 0; t < THREADS; t++) any |= pthread_create(&threads[t], NULL, drive, &failed[t]);
    for (int t = 0; t < THREADS; t++) any |= pthread_join(threads[t], NULL) || failed[t];
    printf("%ld messages\n", messages);
    return any || messages != THREADS * INSTANCES * STEPS;
}
