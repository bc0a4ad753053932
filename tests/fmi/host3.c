/* Random calls of all functions with random arguments on a co-simulation FMU of FMI 3.0: host3 LIBRARY TOKEN SEED CALLS */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3.h"
#include "host.h"

enum { MOST = 4, ROOM = 64, STATES = 3 };

static long messages;

static void logger(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
    (void)environment, (void)category;
    messages += status >= fmi3Error && strlen(message) > 0;
}

/* xorshift64 */
static uint64_t word = 1;
static uint64_t any(uint64_t below) {
    word ^= word << 13, word ^= word >> 7, word ^= word << 17;
    return word % below;
}

static double number(void) {
    static const double odd[] = {0.0, -0.0, 1.0, -1.0, 1e-9, 1e9, 1e300, -1e300, 5e-324, INFINITY, NAN};
    return any(3) ? (double)any(2000000) / 1e5 - 10.0 : odd[any(sizeof odd / sizeof *odd)];
}

static int values(fmi3Instance fmu) {
    static fmi3ValueReference references[MOST];
    static double reals[ROOM];
    static int64_t longs[ROOM];
    static int32_t integers[ROOM];
    static bool flags[ROOM];
    const size_t count = any(MOST + 1), size = any(3) ? any(2) ? count : any(ROOM) : 16;
    for (size_t i = 0; i < MOST; i++) references[i] = any(20) ? (uint32_t)any(300) : (uint32_t)any(4294967296);
    for (size_t i = 0; i < ROOM; i++) {
        reals[i] = number();
        longs[i] = (int64_t)any(UINT64_MAX);
        integers[i] = (int32_t)any(4294967296);
        flags[i] = any(2);
    }
    const fmi3ValueReference *from = any(30) ? references : NULL;
    switch (any(10)) {
    case 0: return CALL(fmi3GetFloat64)(fmu, from, count, any(30) ? reals : NULL, size);
    case 1: return CALL(fmi3GetInt32)(fmu, from, count, any(30) ? integers : NULL, size);
    case 2: return CALL(fmi3GetInt64)(fmu, from, count, any(30) ? longs : NULL, size);
    case 3: return CALL(fmi3GetBoolean)(fmu, from, count, any(30) ? flags : NULL, size);
    case 4: return CALL(fmi3SetInt32)(fmu, from, count, any(30) ? integers : NULL, size);
    case 5: return CALL(fmi3SetInt64)(fmu, from, count, any(30) ? longs : NULL, size);
    case 6: return CALL(fmi3SetBoolean)(fmu, from, count, any(30) ? flags : NULL, size);
    case 7: return CALL(fmi3GetString)(fmu, from, count, NULL, size);
    default: return CALL(fmi3SetFloat64)(fmu, from, count, any(30) ? reals : NULL, size);
    }
}

static int state_call(fmi3Instance fmu, fmi3FMUState *states) {
    static uint8_t bytes[1 << 22];
    fmi3FMUState *state = &states[any(STATES)];
    size_t size = 0;
    switch (any(6)) {
    case 0: return CALL(fmi3GetFMUState)(fmu, any(20) ? state : NULL);
    case 1: return CALL(fmi3SetFMUState)(fmu, *state);
    case 2: return CALL(fmi3FreeFMUState)(fmu, state);
    case 3: return CALL(fmi3SerializedFMUStateSize)(fmu, *state, &size);
    case 4: return CALL(fmi3SerializeFMUState)(fmu, *state, bytes, any(20) ? sizeof bytes : any(100));
    default: return CALL(fmi3DeserializeFMUState)(fmu, bytes, any(20) ? sizeof bytes : any(100), state);
    }
}

/* What the FMU declares that it cannot do: whatever the arguments, the call is refused. */
static const char *const ABSENT[] = {
    "fmi3GetFloat32", "fmi3SetFloat32", "fmi3GetInt8", "fmi3SetInt8", "fmi3GetUInt8", "fmi3SetUInt8", "fmi3GetInt16",
    "fmi3SetInt16", "fmi3GetUInt16", "fmi3SetUInt16", "fmi3GetUInt32", "fmi3SetUInt32", "fmi3GetUInt64",
    "fmi3SetUInt64", "fmi3SetString", "fmi3GetBinary", "fmi3SetBinary", "fmi3GetClock", "fmi3SetClock",
    "fmi3EnterConfigurationMode", "fmi3ExitConfigurationMode", "fmi3EvaluateDiscreteStates",
    "fmi3EnterContinuousTimeMode", "fmi3EnterStepMode", "fmi3UpdateDiscreteStates",
    "fmi3GetNumberOfVariableDependencies", "fmi3GetVariableDependencies", "fmi3GetDirectionalDerivative",
    "fmi3GetAdjointDerivative", "fmi3GetOutputDerivatives", "fmi3GetIntervalDecimal", "fmi3GetIntervalFraction",
    "fmi3GetShiftDecimal", "fmi3GetShiftFraction", "fmi3SetIntervalDecimal", "fmi3SetIntervalFraction",
    "fmi3SetShiftDecimal", "fmi3SetShiftFraction", "fmi3CompletedIntegratorStep", "fmi3SetTime",
    "fmi3SetContinuousStates", "fmi3GetContinuousStateDerivatives", "fmi3GetEventIndicators",
    "fmi3GetContinuousStates", "fmi3GetNominalsOfContinuousStates", "fmi3GetNumberOfEventIndicators",
    "fmi3GetNumberOfContinuousStates", "fmi3ActivateModelPartition",
};
typedef int Absent(fmi3Instance, const fmi3ValueReference[], size_t, void *, size_t, void *, size_t, void *);

static int absent(fmi3Instance fmu) {
    static const fmi3ValueReference references[MOST] = {0};
    const char *name = ABSENT[any(sizeof ABSENT / sizeof *ABSENT)];
    static double room[ROOM];
    return ((Absent *)find(name))(fmu, references, 1 + any(MOST), room, MOST, room, MOST, room);
}

/* Other kinds of instance, of which this FMU has none. */
static int no_instance(const char *token) {
    void *exchange = CALL(fmi3InstantiateModelExchange)("x", token, NULL, false, true, NULL, logger);
    void *scheduled =
        CALL(fmi3InstantiateScheduledExecution)("x", token, NULL, false, true, NULL, logger, NULL, NULL, NULL);
    return exchange || scheduled || strcmp(CALL(fmi3GetVersion)(), "3.0") ? fmi3OK : fmi3Error;
}

static int call(fmi3Instance fmu, const char *token, fmi3FMUState *states, double *time) {
    bool a, b, c;
    switch (any(14)) {
    case 12: return absent(fmu);
    case 13: return any(20) ? absent(fmu) : no_instance(token);
    case 0: return CALL(fmi3EnterInitializationMode)(fmu, false, 0, any(4) ? 0.0 : number(), any(2), number());
    case 1: return CALL(fmi3ExitInitializationMode)(fmu);
    case 2: return any(20) ? 0 : CALL(fmi3Terminate)(fmu);
    case 3: return any(20) ? 0 : (*time = 0.0, (int)CALL(fmi3Reset)(fmu));
    case 4: return CALL(fmi3SetDebugLogging)(fmu, any(2), any(2), NULL);
    case 5: return state_call(fmu, states);
    case 6: return CALL(fmi3EnterEventMode)(fmu);
    case 7:
    case 8: return CALL(fmi3DoStep)(fmu, any(20) ? *time : number(), any(4) ? 0.01 : number(), true, any(9) ? &a : NULL,
                                    &b, &c, any(9) ? time : NULL);
    default: return values(fmu);
    }
}

static int own_main(int count, char **words) {
    fmi3Instance fmus[2] = {NULL, NULL};
    fmi3FMUState states[2][STATES] = {{NULL}};
    double times[2] = {0.0};
    long refused = 0;
    if (count < 5 || !(library = dlopen(words[1], RTLD_NOW | RTLD_LOCAL))) return 1;
    word = strtoull(words[3], NULL, 10) * 2654435761u + 1;
    const long calls = atol(words[4]);
    for (long k = 0; k < calls; k++) {
        const size_t i = any(2);
        if (!fmus[i])
            fmus[i] = CALL(fmi3InstantiateCoSimulation)("fuzz", any(9) ? words[2] : "x", NULL, false, true, !any(9), false,
                                                        NULL, 0, NULL, any(9) ? logger : NULL, NULL);
        refused += call(any(200) ? fmus[i] : NULL, words[2], states[i], &times[i]) > fmi3Discard;
        if (any(2000) == 0) {
            for (int s = 0; s < STATES; s++) CALL(fmi3FreeFMUState)(fmus[i], &states[i][s]);
            CALL(fmi3FreeInstance)(fmus[i]);
            if (fmus[i]) memset(states[i], 0, sizeof states[i]);
            fmus[i] = NULL;
        }
    }
    for (size_t i = 0; i < 2; i++) {
        for (int s = 0; s < STATES; s++) CALL(fmi3FreeFMUState)(fmus[i], &states[i][s]);
        CALL(fmi3FreeInstance)(fmus[i]);
    }
    printf("%ld calls, %ld refused, %ld messages, %d functions\n", calls, refused, messages, function_count);
    return 0;
}

int main(int count, char **words) { return in_thread(own_main, count, words); }
