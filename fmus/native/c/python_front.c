/* What a host calls of a PythonFMU: it mends what PythonFMU's own library, beside it, cannot take, and passes on.
 *
 * Refused: a wrong GUID, calls without an instance. Done here: URIs of all forms and any character, a host without
 * logger, calls with no references, the end of the process (PythonFMU's library would free its interpreter twice).
 * Linked with -z nodelete: what is to be done at the end of the process must still be there then.
 */
#define _GNU_SOURCE

#include "fmi2.h"

#include <dlfcn.h>
#include <limits.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define BEHIND "pythonfmu-export.so" /* PythonFMU's library, in the folder of this one */
#define SCRIPT "slavemodule.txt"     /* what is in every right folder of resources */
#define GUID_FILE "guid.txt"         /* in it too */

static void silent(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...) {
    (void)environment, (void)name, (void)status, (void)category, (void)message;
}

static const fmi2CallbackFunctions without_logger = {.logger = silent};

/* Write the path of a file beside this library, or below the folder above that of all libraries. */
static bool own_path(char path[PATH_MAX], const char *format) {
    Dl_info found;
    char folder[PATH_MAX];
    if (!dladdr((void *)&without_logger, &found) || !realpath(found.dli_fname, folder)) return false;
    char *end = strrchr(folder, '/');
    if (!end) return false;
    *end = '\0';
    return snprintf(path, PATH_MAX, format, folder) < PATH_MAX;
}

static void *behind;

/* Before PythonFMU's library ends itself: then it has nothing left to free. */
static void finish(void) {
    void (*finalize)(void);
    *(void **)&finalize = dlsym(behind, "finalizePythonInterpreter");
    if (finalize) finalize();
}

/* Find a function of PythonFMU's library, which is loaded once and stays. */
static bool found(const char *name, void **call) {
    static int ending;
    void *library = __atomic_load_n(&behind, __ATOMIC_ACQUIRE);
    if (!library) {
        char path[PATH_MAX];
        if (!own_path(path, "%s/" BEHIND)) return false;
        library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
        if (!library) return false;
        __atomic_store_n(&behind, library, __ATOMIC_RELEASE);
        if (!__atomic_exchange_n(&ending, 1, __ATOMIC_ACQ_REL)) atexit(finish);
    }
    if (!*call) *call = dlsym(library, name);
    return *call != NULL;
}

/* True if the folder is that of the FMU's resources, and one that PythonFMU finds: it takes %20 for a blank. */
static bool is_resources(const char *folder) {
    char path[PATH_MAX];
    if (strstr(folder, "%20") || snprintf(path, sizeof path, "%s/" SCRIPT, folder) >= (int)sizeof path) return false;
    FILE *file = fopen(path, "r");
    if (file) fclose(file);
    return file != NULL;
}

static int hex(char digit) {
    const char *digits = "0123456789abcdef", *at = digit ? strchr(digits, digit | 32) : NULL;
    return at ? (int)(at - digits) : -1;
}

/* Write the path in a URI file:/..., file:///... or file://localhost/..., or what is none as it is. */
static void path_of(const char *uri, char path[PATH_MAX], bool escaped) {
    bool is_uri = !strncasecmp(uri, "file:", 5);
    if (is_uri && !strncmp(uri += 5, "//", 2)) {
        uri += 2;
        if (!strncasecmp(uri, "localhost/", 10)) uri += 9;
    }
    size_t count = 0;
    for (; *uri && count < PATH_MAX - 1; uri++) {
        const bool two = is_uri && escaped && *uri == '%' && hex(uri[1]) >= 0 && hex(uri[2]) >= 0;
        path[count++] = two ? (char)(hex(uri[1]) * 16 + hex(uri[2])) : *uri;
        if (two) uri += 2;
    }
    while (count > 1 && path[count - 1] == '/') count--;
    path[count] = '\0';
}

/* Find the resources: as the host says, escaped or not, or else where this library lies. */
static bool find_resources(const char *uri, char path[PATH_MAX]) {
    char own[PATH_MAX];
    for (int escaped = 1; uri && escaped >= 0; escaped--) {
        path_of(uri, path, escaped);
        if (is_resources(path)) return true;
    }
    return own_path(own, "%s/../../resources") && realpath(own, path) && is_resources(path);
}

static bool is_guid(const char *guid, const char *resources) {
    char path[PATH_MAX], own[64] = "";
    if (snprintf(path, sizeof path, "%s/" GUID_FILE, resources) >= (int)sizeof path) return false;
    FILE *file = fopen(path, "r");
    if (!file) return false;
    const size_t count = fread(own, 1, sizeof own - 1, file);
    fclose(file);
    own[count] = '\0';
    return guid && !strcmp(guid, own);
}

FMI2_EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

FMI2_EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String uri,
                                          const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                                          fmi2Boolean logging_on) {
    static fmi2Component (*call)(fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions *,
                                 fmi2Boolean, fmi2Boolean);
    char resources[PATH_MAX];
    const char *wrong = NULL;
    if (!functions || !functions->logger) functions = &without_logger;
    if (!name || !*name)
        wrong = "an instance needs a name";
    else if (type != fmi2CoSimulation)
        wrong = "this FMU is for co-simulation only";
    else if (!find_resources(uri, resources))
        wrong = "the folder of the FMU's resources is not found, or its path has %%20 in it, which PythonFMU misreads";
    else if (!is_guid(guid, resources))
        wrong = "the GUID is not that of this FMU";
    else if (!found("fmi2Instantiate", (void **)&call))
        wrong = BEHIND " cannot be loaded: the host must have the library of Python 3 loaded";
    if (!wrong) return call(name, type, guid, resources, functions, visible, logging_on);
    functions->logger(functions->componentEnvironment, name ? name : "", fmi2Error, "logStatusError", wrong);
    return NULL;
}

FMI2_EXPORT void fmi2FreeInstance(fmi2Component instance) {
    static void (*call)(fmi2Component);
    if (instance && found("fmi2FreeInstance", (void **)&call)) call(instance);
}

/* A function that is passed on, unless its arguments are wrong or ask for nothing. */
#define PASS_ON_UNLESS(wrong, nothing, name, parameters, arguments)              \
    FMI2_EXPORT fmi2Status fmi2##name parameters {                               \
        static fmi2Status(*call) parameters;                                     \
        if (!instance || !found("fmi2" #name, (void **)&call)) return fmi2Error; \
        if (nothing) return fmi2OK;                                              \
        return (wrong) ? fmi2Error : call arguments;                             \
    }
#define PASS_ON(name, parameters, arguments) PASS_ON_UNLESS(false, false, name, parameters, arguments)
#define REFERENCES fmi2Component instance, const fmi2ValueReference references[], size_t count
#define VALUES(name, type)                                                                      \
    PASS_ON_UNLESS(!references || !values, !count, name, (REFERENCES, type values[]), \
                   (instance, references, count, values))
#define GET(Type) VALUES(Get##Type, fmi2##Type)
#define SET(Type) VALUES(Set##Type, const fmi2##Type)

GET(Real)
GET(Integer)
GET(Boolean)
GET(String)
SET(Real)
SET(Integer)
SET(Boolean)
SET(String)

PASS_ON(SetDebugLogging, (fmi2Component instance, fmi2Boolean on, size_t count, const fmi2String categories[]),
        (instance, on, count, categories))
PASS_ON(SetupExperiment,
        (fmi2Component instance, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start,
         fmi2Boolean stop_defined, fmi2Real stop),
        (instance, tolerance_defined, tolerance, start, stop_defined, stop))
PASS_ON(EnterInitializationMode, (fmi2Component instance), (instance))
PASS_ON(ExitInitializationMode, (fmi2Component instance), (instance))
PASS_ON(Terminate, (fmi2Component instance), (instance))
PASS_ON(Reset, (fmi2Component instance), (instance))
PASS_ON(DoStep, (fmi2Component instance, fmi2Real time, fmi2Real step, fmi2Boolean no_rollback),
        (instance, time, step, no_rollback))
PASS_ON(CancelStep, (fmi2Component instance), (instance))
PASS_ON_UNLESS(!state, false, GetFMUstate, (fmi2Component instance, fmi2FMUstate *state), (instance, state))
PASS_ON_UNLESS(!state, false, SetFMUstate, (fmi2Component instance, fmi2FMUstate state), (instance, state))
PASS_ON_UNLESS(false, !state || !*state, FreeFMUstate, (fmi2Component instance, fmi2FMUstate *state),
               (instance, state))
PASS_ON_UNLESS(!state || !size, false, SerializedFMUstateSize,
               (fmi2Component instance, fmi2FMUstate state, size_t *size), (instance, state, size))
PASS_ON_UNLESS(!state || !bytes, false, SerializeFMUstate,
               (fmi2Component instance, fmi2FMUstate state, fmi2Byte bytes[], size_t size),
               (instance, state, bytes, size))
PASS_ON_UNLESS(!state || !bytes, false, DeSerializeFMUstate,
               (fmi2Component instance, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state),
               (instance, bytes, size, state))
PASS_ON(GetDirectionalDerivative,
        (fmi2Component instance, const fmi2ValueReference unknown[], size_t unknowns,
         const fmi2ValueReference given[], size_t givens, const fmi2Real seed[], fmi2Real derivative[]),
        (instance, unknown, unknowns, given, givens, seed, derivative))
PASS_ON(SetRealInputDerivatives, (REFERENCES, const fmi2Integer order[], const fmi2Real values[]),
        (instance, references, count, order, values))
PASS_ON(GetRealOutputDerivatives, (REFERENCES, const fmi2Integer order[], fmi2Real values[]),
        (instance, references, count, order, values))
PASS_ON(GetStatus, (fmi2Component instance, const fmi2StatusKind kind, fmi2Status *value), (instance, kind, value))
PASS_ON(GetRealStatus, (fmi2Component instance, const fmi2StatusKind kind, fmi2Real *value), (instance, kind, value))
PASS_ON(GetIntegerStatus, (fmi2Component instance, const fmi2StatusKind kind, fmi2Integer *value),
        (instance, kind, value))
PASS_ON(GetBooleanStatus, (fmi2Component instance, const fmi2StatusKind kind, fmi2Boolean *value),
        (instance, kind, value))
PASS_ON(GetStringStatus, (fmi2Component instance, const fmi2StatusKind kind, fmi2String *value),
        (instance, kind, value))
