/* Types and functions of FMI 2.0 for co-simulation, as the standard names them.
 *
 * With FMI2_FUNCTION_PREFIX defined, as `Model_`, all functions carry it and are not exported: for several FMUs
 * linked into one image. FMI2_OVERRIDE_FUNCTION_PREFIX undoes that.
 */
#ifndef FMI2_H
#define FMI2_H

#include <stddef.h>

#if defined(FMI2_FUNCTION_PREFIX) && !defined(FMI2_OVERRIDE_FUNCTION_PREFIX)
#define FMI2_PASTE(a, b) a##b
#define FMI2_JOIN(a, b) FMI2_PASTE(a, b)
#define FMI2_NAME(name) FMI2_JOIN(FMI2_FUNCTION_PREFIX, name)
#define FMI2_EXPORT
#define fmi2GetTypesPlatform FMI2_NAME(fmi2GetTypesPlatform)
#define fmi2GetVersion FMI2_NAME(fmi2GetVersion)
#define fmi2SetDebugLogging FMI2_NAME(fmi2SetDebugLogging)
#define fmi2Instantiate FMI2_NAME(fmi2Instantiate)
#define fmi2FreeInstance FMI2_NAME(fmi2FreeInstance)
#define fmi2SetupExperiment FMI2_NAME(fmi2SetupExperiment)
#define fmi2EnterInitializationMode FMI2_NAME(fmi2EnterInitializationMode)
#define fmi2ExitInitializationMode FMI2_NAME(fmi2ExitInitializationMode)
#define fmi2Terminate FMI2_NAME(fmi2Terminate)
#define fmi2Reset FMI2_NAME(fmi2Reset)
#define fmi2GetReal FMI2_NAME(fmi2GetReal)
#define fmi2GetInteger FMI2_NAME(fmi2GetInteger)
#define fmi2GetBoolean FMI2_NAME(fmi2GetBoolean)
#define fmi2GetString FMI2_NAME(fmi2GetString)
#define fmi2SetReal FMI2_NAME(fmi2SetReal)
#define fmi2SetInteger FMI2_NAME(fmi2SetInteger)
#define fmi2SetBoolean FMI2_NAME(fmi2SetBoolean)
#define fmi2SetString FMI2_NAME(fmi2SetString)
#define fmi2GetFMUstate FMI2_NAME(fmi2GetFMUstate)
#define fmi2SetFMUstate FMI2_NAME(fmi2SetFMUstate)
#define fmi2FreeFMUstate FMI2_NAME(fmi2FreeFMUstate)
#define fmi2SerializedFMUstateSize FMI2_NAME(fmi2SerializedFMUstateSize)
#define fmi2SerializeFMUstate FMI2_NAME(fmi2SerializeFMUstate)
#define fmi2DeSerializeFMUstate FMI2_NAME(fmi2DeSerializeFMUstate)
#define fmi2GetDirectionalDerivative FMI2_NAME(fmi2GetDirectionalDerivative)
#define fmi2SetRealInputDerivatives FMI2_NAME(fmi2SetRealInputDerivatives)
#define fmi2GetRealOutputDerivatives FMI2_NAME(fmi2GetRealOutputDerivatives)
#define fmi2DoStep FMI2_NAME(fmi2DoStep)
#define fmi2CancelStep FMI2_NAME(fmi2CancelStep)
#define fmi2GetStatus FMI2_NAME(fmi2GetStatus)
#define fmi2GetRealStatus FMI2_NAME(fmi2GetRealStatus)
#define fmi2GetIntegerStatus FMI2_NAME(fmi2GetIntegerStatus)
#define fmi2GetBooleanStatus FMI2_NAME(fmi2GetBooleanStatus)
#define fmi2GetStringStatus FMI2_NAME(fmi2GetStringStatus)
#elif defined(_WIN32)
#define FMI2_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI2_EXPORT __attribute__((visibility("default")))
#else
#define FMI2_EXPORT
#endif

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;

#define fmi2True 1
#define fmi2False 0

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef void (*fmi2CallbackLogger)(fmi2ComponentEnvironment, fmi2String instance, fmi2Status, fmi2String category,
                                   fmi2String message, ...);
typedef void *(*fmi2CallbackAllocateMemory)(size_t count, size_t size);
typedef void (*fmi2CallbackFreeMemory)(void *);
typedef void (*fmi2StepFinished)(fmi2ComponentEnvironment, fmi2Status);

typedef struct {
    fmi2CallbackLogger logger;
    fmi2CallbackAllocateMemory allocateMemory;
    fmi2CallbackFreeMemory freeMemory;
    fmi2StepFinished stepFinished;
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#define FMI2(result) FMI2_EXPORT result

FMI2(const char *) fmi2GetTypesPlatform(void);
FMI2(const char *) fmi2GetVersion(void);
FMI2(fmi2Status) fmi2SetDebugLogging(fmi2Component, fmi2Boolean on, size_t count, const fmi2String categories[]);

FMI2(fmi2Component) fmi2Instantiate(fmi2String name, fmi2Type, fmi2String guid, fmi2String resources,
                                    const fmi2CallbackFunctions *, fmi2Boolean visible, fmi2Boolean logging_on);
FMI2(void) fmi2FreeInstance(fmi2Component);
FMI2(fmi2Status) fmi2SetupExperiment(fmi2Component, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                     fmi2Real start_time, fmi2Boolean stop_time_defined, fmi2Real stop_time);
FMI2(fmi2Status) fmi2EnterInitializationMode(fmi2Component);
FMI2(fmi2Status) fmi2ExitInitializationMode(fmi2Component);
FMI2(fmi2Status) fmi2Terminate(fmi2Component);
FMI2(fmi2Status) fmi2Reset(fmi2Component);

FMI2(fmi2Status) fmi2GetReal(fmi2Component, const fmi2ValueReference[], size_t, fmi2Real[]);
FMI2(fmi2Status) fmi2GetInteger(fmi2Component, const fmi2ValueReference[], size_t, fmi2Integer[]);
FMI2(fmi2Status) fmi2GetBoolean(fmi2Component, const fmi2ValueReference[], size_t, fmi2Boolean[]);
FMI2(fmi2Status) fmi2GetString(fmi2Component, const fmi2ValueReference[], size_t, fmi2String[]);
FMI2(fmi2Status) fmi2SetReal(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Real[]);
FMI2(fmi2Status) fmi2SetInteger(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Integer[]);
FMI2(fmi2Status) fmi2SetBoolean(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Boolean[]);
FMI2(fmi2Status) fmi2SetString(fmi2Component, const fmi2ValueReference[], size_t, const fmi2String[]);

FMI2(fmi2Status) fmi2GetFMUstate(fmi2Component, fmi2FMUstate *);
FMI2(fmi2Status) fmi2SetFMUstate(fmi2Component, fmi2FMUstate);
FMI2(fmi2Status) fmi2FreeFMUstate(fmi2Component, fmi2FMUstate *);
FMI2(fmi2Status) fmi2SerializedFMUstateSize(fmi2Component, fmi2FMUstate, size_t *);
FMI2(fmi2Status) fmi2SerializeFMUstate(fmi2Component, fmi2FMUstate, fmi2Byte[], size_t);
FMI2(fmi2Status) fmi2DeSerializeFMUstate(fmi2Component, const fmi2Byte[], size_t, fmi2FMUstate *);

FMI2(fmi2Status) fmi2GetDirectionalDerivative(fmi2Component, const fmi2ValueReference[], size_t,
                                              const fmi2ValueReference[], size_t, const fmi2Real[], fmi2Real[]);
FMI2(fmi2Status) fmi2SetRealInputDerivatives(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Integer[],
                                             const fmi2Real[]);
FMI2(fmi2Status) fmi2GetRealOutputDerivatives(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Integer[],
                                              fmi2Real[]);

FMI2(fmi2Status) fmi2DoStep(fmi2Component, fmi2Real time, fmi2Real step, fmi2Boolean no_rollback);
FMI2(fmi2Status) fmi2CancelStep(fmi2Component);
FMI2(fmi2Status) fmi2GetStatus(fmi2Component, const fmi2StatusKind, fmi2Status *);
FMI2(fmi2Status) fmi2GetRealStatus(fmi2Component, const fmi2StatusKind, fmi2Real *);
FMI2(fmi2Status) fmi2GetIntegerStatus(fmi2Component, const fmi2StatusKind, fmi2Integer *);
FMI2(fmi2Status) fmi2GetBooleanStatus(fmi2Component, const fmi2StatusKind, fmi2Boolean *);
FMI2(fmi2Status) fmi2GetStringStatus(fmi2Component, const fmi2StatusKind, fmi2String *);

#endif
