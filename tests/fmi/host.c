/* A host without Python: loads a co-simulation FMU, steps it, prints its outputs; or fuzzes it.
 *
 *     host run   LIBRARY GUID STEPS SIZE WORD...        one line of Real outputs per step, in hexadecimal;
 *                                                       a word is a value reference, or an input held all the
 *                                                       time: real:REFERENCE=VALUE, int:..., bool:..., or
 *                                                       file:NAME with a line of such words to set before
 *                                                       initialization, and a line to set before each step
 *     host many  LIBRARY GUID COUNT                     instantiate, step and free COUNT times; resident kB before, after
 *     host fuzz  LIBRARY GUID SEED CALLS                random calls of all functions with random arguments
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2.h"
#include "host.h"

static long messages;

static void logger(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                   fmi2String message, ...) {
    char text[1024];
    va_list arguments;
    (void)environment, (void)instance, (void)category;
    va_start(arguments, message);
    vsnprintf(text, sizeof text, message, arguments);
    va_end(arguments);
    messages += status >= fmi2Error;
}

static const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};

static int hold(fmi2Component slave, const char *text) {
    fmi2ValueReference reference;
    double value;
    if (sscanf(text, "%*[a-z]:%u=%lf", &reference, &value) != 2) return 1;
    int integer = (int)value;
    return *text == 'r'   ? CALL(fmi2SetReal)(slave, &reference, 1, &value)
           : *text == 'i' ? CALL(fmi2SetInteger)(slave, &reference, 1, &integer)
                          : CALL(fmi2SetBoolean)(slave, &reference, 1, &integer);
}

static FILE *script;

static int hold_line(fmi2Component slave) {
    static char line[65536];
    if (!script || !fgets(line, sizeof line, script)) return 0;
    for (char *text = strtok(line, " \r\n"); text; text = strtok(NULL, " \r\n"))
        if (hold(slave, text)) return 1;
    return 0;
}

static fmi2Component start(const char *guid) {
    fmi2Component slave = CALL(fmi2Instantiate)("slave", fmi2CoSimulation, guid, "", &callbacks, 0, 1);
    if (!slave) exit(3);
    if (hold_line(slave)) exit(7);
    if (CALL(fmi2SetupExperiment)(slave, 0, 0, 0, 0, 0) || CALL(fmi2EnterInitializationMode)(slave) ||
        CALL(fmi2ExitInitializationMode)(slave))
        exit(4);
    return slave;
}

static int run(const char *guid, int steps, double size, int words, char **texts) {
    fmi2ValueReference references[256];
    double values[256];
    for (int i = 0; i < words; i++)
        if (!strncmp(texts[i], "file:", 5) && !(script = fopen(texts[i] + 5, "r"))) return 8;
    fmi2Component slave = start(guid);
    int count = 0;
    for (int i = 0; i < words; i++) {
        if (!strncmp(texts[i], "file:", 5)) continue;
        if (!strchr(texts[i], ':'))
            references[count++] = (unsigned)atoi(texts[i]);
        else if (hold(slave, texts[i]))
            return 7;
    }
    for (int k = 0; k < steps; k++) {
        if (hold_line(slave)) return 7;
        if (CALL(fmi2DoStep)(slave, k * size, size, 1)) return 5;
        if (CALL(fmi2GetReal)(slave, references, (size_t)count, values)) return 6;
        for (int i = 0; i < count; i++) printf("%a ", values[i]);
        putchar('\n');
    }
    CALL(fmi2Terminate)(slave);
    CALL(fmi2FreeInstance)(slave);
    return 0;
}

static long resident(void) {
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%*d %ld", &pages) != 1) exit(7);
    fclose(file);
    return pages * 4;
}

static int many(const char *guid, int count) {
    long before = 0;
    for (int k = 0; k < count; k++) {
        fmi2FMUstate state = NULL;
        fmi2Component slave = start(guid);
        if (CALL(fmi2DoStep)(slave, 0.0, 0.01, 1) || CALL(fmi2GetFMUstate)(slave, &state) ||
            CALL(fmi2FreeFMUstate)(slave, &state))
            return 5;
        CALL(fmi2FreeInstance)(slave);
        if (k == count / 10) before = resident();
    }
    printf("%ld %ld\n", before, resident());
    return 0;
}

/* xorshift64 */
static uint64_t word = 1;
static uint64_t any(uint64_t below) {
    word ^= word << 13, word ^= word >> 7, word ^= word << 17;
    return word % below;
}

static double number(void) {
    static const double odd[] = {0.0, -0.0, 1.0, -1.0, 1e-9, 1e9, 1e300, -1e300, 5e-324};
    switch (any(6)) {
    case 0: return NAN;
    case 1: return any(2) ? INFINITY : -INFINITY;
    case 2: return odd[any(sizeof odd / sizeof *odd)];
    default: return (double)any(2000000) / 1e5 - 10.0;
    }
}

static fmi2ValueReference reference(void) {
    return any(20) ? (unsigned)any(400) : (unsigned)any(4294967296);
}

enum { MOST = 5, STATES = 4 };

static int fuzz_values(fmi2Component slave) {
    fmi2ValueReference references[MOST];
    double reals[MOST];
    int integers[MOST];
    size_t count = any(MOST + 1);
    for (size_t i = 0; i < MOST; i++) {
        references[i] = reference();
        reals[i] = number();
        integers[i] = (int)any(4294967296);
    }
    const fmi2ValueReference *from = any(30) ? references : NULL;
    double *real = any(30) ? reals : NULL;
    int *integer = any(30) ? integers : NULL;
    switch (any(12)) {
    case 8: return CALL(fmi2SetString)(slave, from, count, NULL);
    case 9: return CALL(fmi2GetDirectionalDerivative)(slave, from, count, from, count, real, real);
    case 10: return CALL(fmi2SetRealInputDerivatives)(slave, from, count, integer, real);
    case 11: return CALL(fmi2GetRealOutputDerivatives)(slave, from, count, integer, real);
    case 0: return CALL(fmi2GetReal)(slave, from, count, real);
    case 1: return CALL(fmi2GetInteger)(slave, from, count, integer);
    case 2: return CALL(fmi2GetBoolean)(slave, from, count, integer);
    case 3: return CALL(fmi2GetString)(slave, from, count, NULL);
    case 4: return CALL(fmi2SetInteger)(slave, from, count, integer);
    case 5: return CALL(fmi2SetBoolean)(slave, from, count, integer);
    default: return CALL(fmi2SetReal)(slave, from, count, real);
    }
}

static int fuzz_state(fmi2Component slave, fmi2FMUstate *states) {
    static char bytes[1 << 22];
    fmi2FMUstate *state = &states[any(STATES)];
    size_t size = 0;
    switch (any(6)) {
    case 0: return CALL(fmi2GetFMUstate)(slave, any(20) ? state : NULL);
    case 1: return CALL(fmi2SetFMUstate)(slave, *state);
    case 2: return CALL(fmi2FreeFMUstate)(slave, state);
    case 3: return CALL(fmi2SerializedFMUstateSize)(slave, *state, &size);
    case 4: return CALL(fmi2SerializeFMUstate)(slave, *state, bytes, any(20) ? sizeof bytes : any(100));
    default: return CALL(fmi2DeSerializeFMUstate)(slave, bytes, any(20) ? sizeof bytes : any(100), state);
    }
}

static int fuzz_call(fmi2Component slave, fmi2FMUstate *states, double *time) {
    double step = any(4) ? 0.01 : any(400) ? number() : 3600.0, value;
    int status, flag;
    fmi2String text;
    switch (any(20)) {
    case 16: return CALL(fmi2CancelStep)(slave);
    case 17: return CALL(fmi2GetIntegerStatus)(slave, (fmi2StatusKind)any(4), any(9) ? &flag : NULL);
    case 18: return strcmp(CALL(fmi2GetVersion)(), "2.0") ? fmi2Fatal : fmi2OK;
    case 19: return strcmp(CALL(fmi2GetTypesPlatform)(), "default") ? fmi2Fatal : fmi2OK;
    case 0: return CALL(fmi2SetupExperiment)(slave, (int)any(2), number(), any(4) ? 0.0 : number(), 0, number());
    case 1: return CALL(fmi2EnterInitializationMode)(slave);
    case 2: return CALL(fmi2ExitInitializationMode)(slave);
    case 3: return any(20) ? 0 : CALL(fmi2Terminate)(slave);
    case 4: return any(20) ? 0 : (*time = 0.0, (int)CALL(fmi2Reset)(slave));
    case 5: return CALL(fmi2SetDebugLogging)(slave, (int)any(2), any(2), NULL);
    case 6: return CALL(fmi2GetStatus)(slave, (fmi2StatusKind)any(4), (fmi2Status *)&flag);
    case 7: return CALL(fmi2GetRealStatus)(slave, (fmi2StatusKind)any(4), any(9) ? &value : NULL);
    case 8: return CALL(fmi2GetStringStatus)(slave, (fmi2StatusKind)any(4), &text);
    case 9: return CALL(fmi2GetBooleanStatus)(slave, (fmi2StatusKind)any(4), any(9) ? &flag : NULL);
    case 10: return fuzz_state(slave, states);
    case 11:
    case 12:
        CALL(fmi2GetRealStatus)(slave, fmi2LastSuccessfulTime, time);
        status = CALL(fmi2DoStep)(slave, any(20) ? *time : number(), step, (int)any(2));
        return status;
    default: return fuzz_values(slave);
    }
}

static int fuzz(const char *guid, uint64_t seed, long calls) {
    fmi2Component slaves[3] = {NULL, NULL, NULL};
    fmi2FMUstate states[3][STATES] = {{NULL}};
    double times[3] = {0.0};
    long refused = 0;
    word = seed * 2654435761u + 1;
    for (long k = 0; k < calls; k++) {
        size_t i = any(3);
        if (!slaves[i]) slaves[i] = CALL(fmi2Instantiate)("fuzz", any(9) ? 1 : 0, any(9) ? guid : "x", NULL, &callbacks, 0, 1);
        refused += fuzz_call(any(200) ? slaves[i] : NULL, states[i], &times[i]) > fmi2Discard;
        if (any(2000) == 0) {
            for (int s = 0; s < STATES; s++) CALL(fmi2FreeFMUstate)(slaves[i], &states[i][s]);
            CALL(fmi2FreeInstance)(slaves[i]);
            if (slaves[i]) memset(states[i], 0, sizeof states[i]);
            slaves[i] = NULL;
        }
    }
    for (size_t i = 0; i < 3; i++) {
        for (int s = 0; s < STATES; s++) CALL(fmi2FreeFMUstate)(slaves[i], &states[i][s]);
        CALL(fmi2FreeInstance)(slaves[i]);
    }
    printf("%ld calls, %ld refused, %ld messages, %d functions\n", calls, refused, messages, function_count);
    return refused ? 0 : 8;
}

static int own_main(int count, char **words) {
    if (count < 5 || !(library = dlopen(words[2], RTLD_NOW | RTLD_LOCAL))) {
        fprintf(stderr, "%s\n", count < 5 ? "usage: see the source" : dlerror());
        return 1;
    }
    if (!strcmp(words[1], "run")) return run(words[3], atoi(words[4]), atof(words[5]), count - 6, words + 6);
    if (!strcmp(words[1], "many")) return many(words[3], atoi(words[4]));
    return fuzz(words[3], strtoull(words[4], NULL, 10), atol(words[5]));
}

int main(int count, char **words) { return in_thread(own_main, count, words); }
