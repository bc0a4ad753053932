/* Types and functions of FMI 3.0 for co-simulation, as the standard names them, and of its other interfaces the
 * functions that a library must have.
 *
 * With FMI3_FUNCTION_PREFIX defined, as `Model_`, all functions carry it and are not exported: for several FMUs
 * linked into one image. FMI3_OVERRIDE_FUNCTION_PREFIX undoes that.
 */
#ifndef FMI3_H
#define FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(FMI3_FUNCTION_PREFIX) && !defined(FMI3_OVERRIDE_FUNCTION_PREFIX)
#define FMI3_PASTE(a, b) a##b
#define FMI3_JOIN(a, b) FMI3_PASTE(a, b)
#define FMI3_NAME(name) FMI3_JOIN(FMI3_FUNCTION_PREFIX, name)
#define FMI3_EXPORT
#define fmi3GetVersion FMI3_NAME(fmi3GetVersion)
#define fmi3SetDebugLogging FMI3_NAME(fmi3SetDebugLogging)
#define fmi3InstantiateModelExchange FMI3_NAME(fmi3InstantiateModelExchange)
#define fmi3InstantiateCoSimulation FMI3_NAME(fmi3InstantiateCoSimulation)
#define fmi3InstantiateScheduledExecution FMI3_NAME(fmi3InstantiateScheduledExecution)
#define fmi3FreeInstance FMI3_NAME(fmi3FreeInstance)
#define fmi3EnterInitializationMode FMI3_NAME(fmi3EnterInitializationMode)
#define fmi3ExitInitializationMode FMI3_NAME(fmi3ExitInitializationMode)
#define fmi3EnterEventMode FMI3_NAME(fmi3EnterEventMode)
#define fmi3Terminate FMI3_NAME(fmi3Terminate)
#define fmi3Reset FMI3_NAME(fmi3Reset)
#define fmi3GetFloat32 FMI3_NAME(fmi3GetFloat32)
#define fmi3GetFloat64 FMI3_NAME(fmi3GetFloat64)
#define fmi3GetInt8 FMI3_NAME(fmi3GetInt8)
#define fmi3GetUInt8 FMI3_NAME(fmi3GetUInt8)
#define fmi3GetInt16 FMI3_NAME(fmi3GetInt16)
#define fmi3GetUInt16 FMI3_NAME(fmi3GetUInt16)
#define fmi3GetInt32 FMI3_NAME(fmi3GetInt32)
#define fmi3GetUInt32 FMI3_NAME(fmi3GetUInt32)
#define fmi3GetInt64 FMI3_NAME(fmi3GetInt64)
#define fmi3GetUInt64 FMI3_NAME(fmi3GetUInt64)
#define fmi3GetBoolean FMI3_NAME(fmi3GetBoolean)
#define fmi3GetString FMI3_NAME(fmi3GetString)
#define fmi3GetBinary FMI3_NAME(fmi3GetBinary)
#define fmi3GetClock FMI3_NAME(fmi3GetClock)
#define fmi3SetFloat32 FMI3_NAME(fmi3SetFloat32)
#define fmi3SetFloat64 FMI3_NAME(fmi3SetFloat64)
#define fmi3SetInt8 FMI3_NAME(fmi3SetInt8)
#define fmi3SetUInt8 FMI3_NAME(fmi3SetUInt8)
#define fmi3SetInt16 FMI3_NAME(fmi3SetInt16)
#define fmi3SetUInt16 FMI3_NAME(fmi3SetUInt16)
#define fmi3SetInt32 FMI3_NAME(fmi3SetInt32)
#define fmi3SetUInt32 FMI3_NAME(fmi3SetUInt32)
#define fmi3SetInt64 FMI3_NAME(fmi3SetInt64)
#define fmi3SetUInt64 FMI3_NAME(fmi3SetUInt64)
#define fmi3SetBoolean FMI3_NAME(fmi3SetBoolean)
#define fmi3SetString FMI3_NAME(fmi3SetString)
#define fmi3SetBinary FMI3_NAME(fmi3SetBinary)
#define fmi3SetClock FMI3_NAME(fmi3SetClock)
#define fmi3GetNumberOfVariableDependencies FMI3_NAME(fmi3GetNumberOfVariableDependencies)
#define fmi3GetVariableDependencies FMI3_NAME(fmi3GetVariableDependencies)
#define fmi3GetFMUState FMI3_NAME(fmi3GetFMUState)
#define fmi3SetFMUState FMI3_NAME(fmi3SetFMUState)
#define fmi3FreeFMUState FMI3_NAME(fmi3FreeFMUState)
#define fmi3SerializedFMUStateSize FMI3_NAME(fmi3SerializedFMUStateSize)
#define fmi3SerializeFMUState FMI3_NAME(fmi3SerializeFMUState)
#define fmi3DeserializeFMUState FMI3_NAME(fmi3DeserializeFMUState)
#define fmi3GetDirectionalDerivative FMI3_NAME(fmi3GetDirectionalDerivative)
#define fmi3GetAdjointDerivative FMI3_NAME(fmi3GetAdjointDerivative)
#define fmi3EnterConfigurationMode FMI3_NAME(fmi3EnterConfigurationMode)
#define fmi3ExitConfigurationMode FMI3_NAME(fmi3ExitConfigurationMode)
#define fmi3GetIntervalDecimal FMI3_NAME(fmi3GetIntervalDecimal)
#define fmi3GetIntervalFraction FMI3_NAME(fmi3GetIntervalFraction)
#define fmi3GetShiftDecimal FMI3_NAME(fmi3GetShiftDecimal)
#define fmi3GetShiftFraction FMI3_NAME(fmi3GetShiftFraction)
#define fmi3SetIntervalDecimal FMI3_NAME(fmi3SetIntervalDecimal)
#define fmi3SetIntervalFraction FMI3_NAME(fmi3SetIntervalFraction)
#define fmi3SetShiftDecimal FMI3_NAME(fmi3SetShiftDecimal)
#define fmi3SetShiftFraction FMI3_NAME(fmi3SetShiftFraction)
#define fmi3EvaluateDiscreteStates FMI3_NAME(fmi3EvaluateDiscreteStates)
#define fmi3UpdateDiscreteStates FMI3_NAME(fmi3UpdateDiscreteStates)
#define fmi3EnterContinuousTimeMode FMI3_NAME(fmi3EnterContinuousTimeMode)
#define fmi3CompletedIntegratorStep FMI3_NAME(fmi3CompletedIntegratorStep)
#define fmi3SetTime FMI3_NAME(fmi3SetTime)
#define fmi3SetContinuousStates FMI3_NAME(fmi3SetContinuousStates)
#define fmi3GetContinuousStateDerivatives FMI3_NAME(fmi3GetContinuousStateDerivatives)
#define fmi3GetEventIndicators FMI3_NAME(fmi3GetEventIndicators)
#define fmi3GetContinuousStates FMI3_NAME(fmi3GetContinuousStates)
#define fmi3GetNominalsOfContinuousStates FMI3_NAME(fmi3GetNominalsOfContinuousStates)
#define fmi3GetNumberOfEventIndicators FMI3_NAME(fmi3GetNumberOfEventIndicators)
#define fmi3GetNumberOfContinuousStates FMI3_NAME(fmi3GetNumberOfContinuousStates)
#define fmi3EnterStepMode FMI3_NAME(fmi3EnterStepMode)
#define fmi3GetOutputDerivatives FMI3_NAME(fmi3GetOutputDerivatives)
#define fmi3DoStep FMI3_NAME(fmi3DoStep)
#define fmi3ActivateModelPartition FMI3_NAME(fmi3ActivateModelPartition)
#elif defined(_WIN32)
#define FMI3_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI3_EXPORT __attribute__((visibility("default")))
#else
#define FMI3_EXPORT
#endif

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef char fmi3Char;
typedef const fmi3Char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum {
    fmi3Independent,
    fmi3Constant,
    fmi3Fixed,
    fmi3Tunable,
    fmi3Discrete,
    fmi3Dependent
} fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String category, fmi3String message);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64 time, fmi3Boolean set_requested,
                                               fmi3Boolean get_allowed, fmi3Boolean step_finished,
                                               fmi3Boolean can_return_early, fmi3Boolean *return_requested,
                                               fmi3Float64 *return_time);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

#define FMI3(result) FMI3_EXPORT result
#define FMI3_REFERENCES fmi3Instance, const fmi3ValueReference references[], size_t count

FMI3(const char *) fmi3GetVersion(void);
FMI3(fmi3Status) fmi3SetDebugLogging(fmi3Instance, fmi3Boolean on, size_t count, const fmi3String categories[]);

FMI3(fmi3Instance) fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                fmi3Boolean visible, fmi3Boolean logging_on, fmi3InstanceEnvironment,
                                                fmi3LogMessageCallback);
FMI3(fmi3Instance) fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging_on, fmi3Boolean event_mode,
                                               fmi3Boolean early_return, const fmi3ValueReference intermediate[],
                                               size_t intermediate_count, fmi3InstanceEnvironment,
                                               fmi3LogMessageCallback, fmi3IntermediateUpdateCallback);
FMI3(fmi3Instance) fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                     fmi3Boolean visible, fmi3Boolean logging_on,
                                                     fmi3InstanceEnvironment, fmi3LogMessageCallback,
                                                     fmi3ClockUpdateCallback, fmi3LockPreemptionCallback,
                                                     fmi3UnlockPreemptionCallback);
FMI3(void) fmi3FreeInstance(fmi3Instance);
FMI3(fmi3Status) fmi3EnterInitializationMode(fmi3Instance, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                             fmi3Float64 start_time, fmi3Boolean stop_time_defined,
                                             fmi3Float64 stop_time);
FMI3(fmi3Status) fmi3ExitInitializationMode(fmi3Instance);
FMI3(fmi3Status) fmi3EnterEventMode(fmi3Instance);
FMI3(fmi3Status) fmi3Terminate(fmi3Instance);
FMI3(fmi3Status) fmi3Reset(fmi3Instance);

#define FMI3_GET_AND_SET(Type)                                                                  \
    FMI3(fmi3Status) fmi3Get##Type(FMI3_REFERENCES, fmi3##Type values[], size_t value_count);     \
    FMI3(fmi3Status) fmi3Set##Type(FMI3_REFERENCES, const fmi3##Type values[], size_t value_count)

FMI3_GET_AND_SET(Float32);
FMI3_GET_AND_SET(Float64);
FMI3_GET_AND_SET(Int8);
FMI3_GET_AND_SET(UInt8);
FMI3_GET_AND_SET(Int16);
FMI3_GET_AND_SET(UInt16);
FMI3_GET_AND_SET(Int32);
FMI3_GET_AND_SET(UInt32);
FMI3_GET_AND_SET(Int64);
FMI3_GET_AND_SET(UInt64);
FMI3_GET_AND_SET(Boolean);
FMI3_GET_AND_SET(String);
FMI3(fmi3Status) fmi3GetBinary(FMI3_REFERENCES, size_t sizes[], fmi3Binary values[], size_t value_count);
FMI3(fmi3Status) fmi3SetBinary(FMI3_REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t value_count);
FMI3(fmi3Status) fmi3GetClock(FMI3_REFERENCES, fmi3Clock values[]);
FMI3(fmi3Status) fmi3SetClock(FMI3_REFERENCES, const fmi3Clock values[]);

FMI3(fmi3Status) fmi3GetNumberOfVariableDependencies(fmi3Instance, fmi3ValueReference, size_t *count);
FMI3(fmi3Status) fmi3GetVariableDependencies(fmi3Instance, fmi3ValueReference dependent, size_t dependent_elements[],
                                             fmi3ValueReference independents[], size_t independent_elements[],
                                             fmi3DependencyKind kinds[], size_t count);

FMI3(fmi3Status) fmi3GetFMUState(fmi3Instance, fmi3FMUState *);
FMI3(fmi3Status) fmi3SetFMUState(fmi3Instance, fmi3FMUState);
FMI3(fmi3Status) fmi3FreeFMUState(fmi3Instance, fmi3FMUState *);
FMI3(fmi3Status) fmi3SerializedFMUStateSize(fmi3Instance, fmi3FMUState, size_t *);
FMI3(fmi3Status) fmi3SerializeFMUState(fmi3Instance, fmi3FMUState, fmi3Byte[], size_t);
FMI3(fmi3Status) fmi3DeserializeFMUState(fmi3Instance, const fmi3Byte[], size_t, fmi3FMUState *);

FMI3(fmi3Status) fmi3GetDirectionalDerivative(fmi3Instance, const fmi3ValueReference unknowns[], size_t unknown_count,
                                              const fmi3ValueReference knowns[], size_t known_count,
                                              const fmi3Float64 seed[], size_t seed_count, fmi3Float64 sensitivity[],
                                              size_t sensitivity_count);
FMI3(fmi3Status) fmi3GetAdjointDerivative(fmi3Instance, const fmi3ValueReference unknowns[], size_t unknown_count,
                                          const fmi3ValueReference knowns[], size_t known_count,
                                          const fmi3Float64 seed[], size_t seed_count, fmi3Float64 sensitivity[],
                                          size_t sensitivity_count);

FMI3(fmi3Status) fmi3EnterConfigurationMode(fmi3Instance);
FMI3(fmi3Status) fmi3ExitConfigurationMode(fmi3Instance);
FMI3(fmi3Status) fmi3GetIntervalDecimal(FMI3_REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier[]);
FMI3(fmi3Status) fmi3GetIntervalFraction(FMI3_REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                         fmi3IntervalQualifier[]);
FMI3(fmi3Status) fmi3GetShiftDecimal(FMI3_REFERENCES, fmi3Float64 manoeuvres[]);
FMI3(fmi3Status) fmi3GetShiftFraction(FMI3_REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[]);
FMI3(fmi3Status) fmi3SetIntervalDecimal(FMI3_REFERENCES, const fmi3Float64 intervals[]);
FMI3(fmi3Status) fmi3SetIntervalFraction(FMI3_REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]);
FMI3(fmi3Status) fmi3SetShiftDecimal(FMI3_REFERENCES, const fmi3Float64 manoeuvres[]);
FMI3(fmi3Status) fmi3SetShiftFraction(FMI3_REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]);
FMI3(fmi3Status) fmi3EvaluateDiscreteStates(fmi3Instance);
FMI3(fmi3Status) fmi3UpdateDiscreteStates(fmi3Instance, fmi3Boolean *again, fmi3Boolean *terminate,
                                          fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                          fmi3Boolean *next_defined, fmi3Float64 *next_time);

FMI3(fmi3Status) fmi3EnterContinuousTimeMode(fmi3Instance);
FMI3(fmi3Status) fmi3CompletedIntegratorStep(fmi3Instance, fmi3Boolean no_rollback, fmi3Boolean *enter_event_mode,
                                             fmi3Boolean *terminate);
FMI3(fmi3Status) fmi3SetTime(fmi3Instance, fmi3Float64 time);
FMI3(fmi3Status) fmi3SetContinuousStates(fmi3Instance, const fmi3Float64 states[], size_t count);
FMI3(fmi3Status) fmi3GetContinuousStateDerivatives(fmi3Instance, fmi3Float64 derivatives[], size_t count);
FMI3(fmi3Status) fmi3GetEventIndicators(fmi3Instance, fmi3Float64 indicators[], size_t count);
FMI3(fmi3Status) fmi3GetContinuousStates(fmi3Instance, fmi3Float64 states[], size_t count);
FMI3(fmi3Status) fmi3GetNominalsOfContinuousStates(fmi3Instance, fmi3Float64 nominals[], size_t count);
FMI3(fmi3Status) fmi3GetNumberOfEventIndicators(fmi3Instance, size_t *count);
FMI3(fmi3Status) fmi3GetNumberOfContinuousStates(fmi3Instance, size_t *count);

FMI3(fmi3Status) fmi3EnterStepMode(fmi3Instance);
FMI3(fmi3Status) fmi3GetOutputDerivatives(FMI3_REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[],
                                          size_t value_count);
FMI3(fmi3Status) fmi3DoStep(fmi3Instance, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_rollback,
                            fmi3Boolean *event_handling_needed, fmi3Boolean *terminate, fmi3Boolean *early_return,
                            fmi3Float64 *last_time);
FMI3(fmi3Status) fmi3ActivateModelPartition(fmi3Instance, fmi3ValueReference clock, fmi3Float64 time);

#endif
