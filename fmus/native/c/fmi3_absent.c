/* The functions of FMI 3.0 that every library has and this FMU declares that it cannot do: refused by name. */

/* A type that no variable of this FMU has: the message names the one that was meant. */
static fmi3Status fmu_no_such_type(fmi3Instance c, const fmi3ValueReference references[], size_t count,
                                   const char *function) {
    FmuInstance *fmu = fmu_in(c, FMU_ANY_PHASE, function);
    if (!fmu) return fmi3Error;
    if (!count) return fmi3OK;
    if (!references) return FMU_NULL(fmu, function);
    return (fmi3Status)fmu_unknown(fmu, references[0], function);
}

#define FMU_REFERENCES fmi3Instance c, const fmi3ValueReference references[], size_t count

#define FMU_ABSENT_TYPE(Type)                                                                                     \
    fmi3Status fmi3Get##Type(FMU_REFERENCES, fmi3##Type values[], size_t value_count) {                           \
        (void)values, (void)value_count;                                                                          \
        return fmu_no_such_type(c, references, count, "fmi3Get" #Type);                                           \
    }                                                                                                             \
    fmi3Status fmi3Set##Type(FMU_REFERENCES, const fmi3##Type values[], size_t value_count) {                     \
        (void)values, (void)value_count;                                                                          \
        return fmu_no_such_type(c, references, count, "fmi3Set" #Type);                                           \
    }

FMU_ABSENT_TYPE(Float32)
FMU_ABSENT_TYPE(Int8)
FMU_ABSENT_TYPE(UInt8)
FMU_ABSENT_TYPE(Int16)
FMU_ABSENT_TYPE(UInt16)
FMU_ABSENT_TYPE(UInt32)
FMU_ABSENT_TYPE(UInt64)
FMU_ABSENT_TYPE(String)

fmi3Status fmi3GetBinary(FMU_REFERENCES, size_t sizes[], fmi3Binary values[], size_t value_count) {
    (void)sizes, (void)values, (void)value_count;
    return fmu_no_such_type(c, references, count, "fmi3GetBinary");
}

fmi3Status fmi3SetBinary(FMU_REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t value_count) {
    (void)sizes, (void)values, (void)value_count;
    return fmu_no_such_type(c, references, count, "fmi3SetBinary");
}

fmi3Status fmi3GetClock(FMU_REFERENCES, fmi3Clock values[]) {
    (void)values;
    return fmu_no_such_type(c, references, count, "fmi3GetClock");
}

fmi3Status fmi3SetClock(FMU_REFERENCES, const fmi3Clock values[]) {
    (void)values;
    return fmu_no_such_type(c, references, count, "fmi3SetClock");
}

static fmi3Instance fmu_no_interface(fmi3String name, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    (void)name;
    const FmuHost host = {"", log, environment, true};
    return fmu_tell(&host, FMU_ERROR, "this FMU is for co-simulation only"), NULL;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging_on, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log) {
    (void)token, (void)resources, (void)visible, (void)logging_on;
    return fmu_no_interface(name, environment, log);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging_on,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock) {
    (void)token, (void)resources, (void)visible, (void)logging_on, (void)update, (void)lock, (void)unlock;
    return fmu_no_interface(name, environment, log);
}

#define FMU_ABSENT_MODE(function)                                                     \
    fmi3Status function(fmi3Instance c) {                                             \
        return (fmi3Status)fmu_refuse(c, 1, #function ": this FMU has no such mode"); \
    }

FMU_ABSENT_MODE(fmi3EnterEventMode)
FMU_ABSENT_MODE(fmi3EnterConfigurationMode)
FMU_ABSENT_MODE(fmi3ExitConfigurationMode)
FMU_ABSENT_MODE(fmi3EvaluateDiscreteStates)
FMU_ABSENT_MODE(fmi3EnterContinuousTimeMode)
FMU_ABSENT_MODE(fmi3EnterStepMode)

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate,
                                    fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                    fmi3Boolean *next_defined, fmi3Float64 *next_time) {
    (void)again, (void)terminate, (void)nominals_changed, (void)values_changed, (void)next_defined, (void)next_time;
    return (fmi3Status)fmu_refuse(c, 1, "fmi3UpdateDiscreteStates: this FMU has no event mode");
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference reference, size_t *count) {
    (void)reference, (void)count;
    return (fmi3Status)fmu_refuse(c, 1, "fmi3GetNumberOfVariableDependencies: not provided");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent, size_t dependent_elements[],
                                       fmi3ValueReference independents[], size_t independent_elements[],
                                       fmi3DependencyKind kinds[], size_t count) {
    (void)dependent, (void)dependent_elements, (void)independents, (void)independent_elements, (void)kinds;
    return (fmi3Status)fmu_refuse(c, count, "fmi3GetVariableDependencies: not provided");
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t unknown_count,
                                        const fmi3ValueReference knowns[], size_t known_count,
                                        const fmi3Float64 seed[], size_t seed_count, fmi3Float64 sensitivity[],
                                        size_t sensitivity_count) {
    (void)unknowns, (void)knowns, (void)known_count, (void)seed, (void)seed_count, (void)sensitivity;
    (void)sensitivity_count;
    return (fmi3Status)fmu_refuse(c, unknown_count, "fmi3GetDirectionalDerivative: not provided");
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t unknown_count,
                                    const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[],
                                    size_t seed_count, fmi3Float64 sensitivity[], size_t sensitivity_count) {
    (void)unknowns, (void)knowns, (void)known_count, (void)seed, (void)seed_count, (void)sensitivity;
    (void)sensitivity_count;
    return (fmi3Status)fmu_refuse(c, unknown_count, "fmi3GetAdjointDerivative: not provided");
}

fmi3Status fmi3GetOutputDerivatives(FMU_REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[],
                                    size_t value_count) {
    (void)references, (void)orders, (void)values, (void)value_count;
    return (fmi3Status)fmu_refuse(c, count, "fmi3GetOutputDerivatives: not provided");
}

fmi3Status fmi3GetIntervalDecimal(FMU_REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]) {
    (void)intervals, (void)qualifiers;
    return fmu_no_such_type(c, references, count, "fmi3GetIntervalDecimal");
}

fmi3Status fmi3GetIntervalFraction(FMU_REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                   fmi3IntervalQualifier qualifiers[]) {
    (void)counters, (void)resolutions, (void)qualifiers;
    return fmu_no_such_type(c, references, count, "fmi3GetIntervalFraction");
}

fmi3Status fmi3GetShiftDecimal(FMU_REFERENCES, fmi3Float64 manoeuvres[]) {
    (void)manoeuvres;
    return fmu_no_such_type(c, references, count, "fmi3GetShiftDecimal");
}

fmi3Status fmi3GetShiftFraction(FMU_REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[]) {
    (void)counters, (void)resolutions;
    return fmu_no_such_type(c, references, count, "fmi3GetShiftFraction");
}

fmi3Status fmi3SetIntervalDecimal(FMU_REFERENCES, const fmi3Float64 intervals[]) {
    (void)intervals;
    return fmu_no_such_type(c, references, count, "fmi3SetIntervalDecimal");
}

fmi3Status fmi3SetIntervalFraction(FMU_REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]) {
    (void)counters, (void)resolutions;
    return fmu_no_such_type(c, references, count, "fmi3SetIntervalFraction");
}

fmi3Status fmi3SetShiftDecimal(FMU_REFERENCES, const fmi3Float64 manoeuvres[]) {
    (void)manoeuvres;
    return fmu_no_such_type(c, references, count, "fmi3SetShiftDecimal");
}

fmi3Status fmi3SetShiftFraction(FMU_REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]) {
    (void)counters, (void)resolutions;
    return fmu_no_such_type(c, references, count, "fmi3SetShiftFraction");
}

#define FMU_NO_EXCHANGE(function) (fmi3Status)fmu_refuse(c, 1, #function ": this FMU is for co-simulation only")

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean no_rollback, fmi3Boolean *enter_event_mode,
                                       fmi3Boolean *terminate) {
    (void)no_rollback, (void)enter_event_mode, (void)terminate;
    return FMU_NO_EXCHANGE(fmi3CompletedIntegratorStep);
}

fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time) {
    (void)time;
    return FMU_NO_EXCHANGE(fmi3SetTime);
}

fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 states[], size_t count) {
    (void)states, (void)count;
    return FMU_NO_EXCHANGE(fmi3SetContinuousStates);
}

#define FMU_NO_ARRAY(function)                                                  \
    fmi3Status function(fmi3Instance c, fmi3Float64 values[], size_t count) {   \
        (void)values, (void)count;                                              \
        return FMU_NO_EXCHANGE(function);                                       \
    }

FMU_NO_ARRAY(fmi3GetContinuousStateDerivatives)
FMU_NO_ARRAY(fmi3GetEventIndicators)
FMU_NO_ARRAY(fmi3GetContinuousStates)
FMU_NO_ARRAY(fmi3GetNominalsOfContinuousStates)

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *count) {
    (void)count;
    return FMU_NO_EXCHANGE(fmi3GetNumberOfEventIndicators);
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *count) {
    (void)count;
    return FMU_NO_EXCHANGE(fmi3GetNumberOfContinuousStates);
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time) {
    (void)clock, (void)time;
    return FMU_NO_EXCHANGE(fmi3ActivateModelPartition);
}
