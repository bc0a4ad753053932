/* Getting and setting variables by value reference, and the questions about a step. */
#include "slave.h"

#include <limits.h>
#include <math.h>

static const char *const KINDS[] = {"Real", "Integer", "Boolean"};

static const char *name_of(fmi2ValueReference reference) { return model_names + model_name_places[reference]; }

static int is_known(fmi2ValueReference reference, Kind kind) {
    return reference < MODEL_VARIABLES && model_kinds[reference] == kind;
}

static int is_input(fmi2ValueReference reference) { return reference - MODEL_PARAMETERS < MODEL_INPUTS; }

/* Report a value reference that is not known as a variable of this kind. */
static fmi2Status unknown(const Slave *slave, fmi2ValueReference reference, const char *function) {
    if (reference >= MODEL_VARIABLES)
        return report(slave, fmi2Error, "%s: no value reference %u; the last is %d", function, reference,
                      MODEL_VARIABLES - 1);
    return report(slave, fmi2Error, "%s: %s (value reference %u) is %s", function, name_of(reference), reference,
                  KINDS[model_kinds[reference]]);
}

/* True if the variable may be set now, and to this value; reports the call if not. */
static int settable(const Slave *slave, fmi2ValueReference reference, double value, const char *function) {
    if (reference >= MODEL_PARAMETERS + MODEL_INPUTS)
        return report(slave, fmi2Error, "%s: %s is calculated by the FMU", function, name_of(reference)), 0;
    const double *limits = model_limits[reference];
    if (!(slave->saved.phase & (INSTANTIATED | INITIALIZATION)))
        return report(slave, fmi2Error, "%s: parameter %s is fixed after initialization", function,
                      name_of(reference)),
               0;
    if (!(limits[0] <= value && value <= limits[1]))
        return report(slave, fmi2Error, "%s: %s = %.17g is not in [%g, %g]", function, name_of(reference), value,
                      limits[0], limits[1]),
               0;
    return 1;
}

static int as_integer(double value) {
    return value >= INT_MAX ? INT_MAX : value <= INT_MIN ? INT_MIN : value == value ? (int)value : 0;
}

/* All values to be set are checked before the first is taken: a refused call changes nothing. */
#define GET(Type, KIND, convert)                                                                                  \
    fmi2Status fmi2Get##Type(fmi2Component component, const fmi2ValueReference references[], size_t count,        \
                             fmi2##Type values[]) {                                                               \
        Slave *slave = slave_in(component, READABLE, "fmi2Get" #Type);                                            \
        if (!slave) return fmi2Error;                                                                             \
        if (count && (!references || !values)) return report(slave, fmi2Error, "fmi2Get" #Type ": null pointer"); \
        if (slave->saved.stale && !refresh(slave)) return fmi2Error;                                              \
        const double *const mine = slave->saved.values;                                                           \
        for (size_t i = 0; i < count; i++) {                                                                      \
            if (!is_known(references[i], KIND)) return unknown(slave, references[i], "fmi2Get" #Type);            \
            values[i] = convert(mine[references[i]]);                                                             \
        }                                                                                                         \
        return fmi2OK;                                                                                            \
    }

#define SET(Type, KIND, convert)                                                                                  \
    fmi2Status fmi2Set##Type(fmi2Component component, const fmi2ValueReference references[], size_t count,        \
                             const fmi2##Type values[]) {                                                         \
        Slave *slave = slave_in(component, INSTANTIATED | INITIALIZATION | STEPPING, "fmi2Set" #Type);            \
        if (!slave) return fmi2Error;                                                                             \
        if (count && (!references || !values)) return report(slave, fmi2Error, "fmi2Set" #Type ": null pointer"); \
        size_t parameters = 0;                                                                                    \
        for (size_t i = 0; i < count; i++) {                                                                      \
            if (!is_known(references[i], KIND)) return unknown(slave, references[i], "fmi2Set" #Type);            \
            if (is_input(references[i])) continue;                                                                \
            if (!settable(slave, references[i], convert(values[i]), "fmi2Set" #Type)) return fmi2Error;           \
            parameters++;                                                                                         \
        }                                                                                                         \
        double *const mine = slave->saved.values;                                                                 \
        for (size_t i = 0; i < count; i++) mine[references[i]] = convert(values[i]);                              \
        if (parameters) slave->saved.stale = 1;                                                                   \
        return fmi2OK;                                                                                            \
    }

#define SAME(value) (value)
#define TRUTH(value) ((value) != 0)

GET(Real, REAL, SAME)
GET(Integer, INTEGER, as_integer)
GET(Boolean, BOOLEAN, TRUTH)
SET(Real, REAL, SAME)
SET(Integer, INTEGER, SAME)
SET(Boolean, BOOLEAN, TRUTH)

/* Refuse a call this FMU declares that it cannot do, unless it asks for nothing. */
static fmi2Status refuse(fmi2Component component, size_t count, const char *message) {
    Slave *slave = slave_in(component, ANY_PHASE, message);
    if (!slave) return fmi2Error;
    return count ? report(slave, fmi2Error, "%s", message) : fmi2OK;
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2String values[]) {
    (void)references, (void)values;
    return refuse(c, count, "fmi2GetString: this FMU has no strings");
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference references[], size_t count,
                         const fmi2String values[]) {
    (void)references, (void)values;
    return refuse(c, count, "fmi2SetString: this FMU has no strings");
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                        const fmi2ValueReference given[], size_t givens, const fmi2Real seed[],
                                        fmi2Real derivative[]) {
    (void)unknown, (void)given, (void)givens, (void)seed, (void)derivative;
    return refuse(c, unknowns, "fmi2GetDirectionalDerivative: not provided");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                       const fmi2Integer order[], const fmi2Real values[]) {
    (void)references, (void)order, (void)values;
    return refuse(c, count, "fmi2SetRealInputDerivatives: inputs are held, not interpolated");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                        const fmi2Integer order[], fmi2Real values[]) {
    (void)references, (void)order, (void)values;
    return refuse(c, count, "fmi2GetRealOutputDerivatives: not provided");
}

/* Steps are never pending, so most questions about them have no answer: fmi2Discard. */
static fmi2Status discard(fmi2Component component, const void *value) {
    Slave *slave = slave_in(component, ANY_PHASE, "fmi2GetStatus");
    if (!slave) return fmi2Error;
    return report(slave, value ? fmi2Discard : fmi2Error, "no such status: every step is complete when it returns");
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    (void)kind;
    return discard(c, value);
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    if (!c || !value || kind != fmi2LastSuccessfulTime) return discard(c, value);
    *value = ((Slave *)c)->saved.values[MODEL_TIME];
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    (void)kind;
    return discard(c, value);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    if (!c || !value || kind != fmi2Terminated) return discard(c, value);
    *value = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    (void)kind;
    return discard(c, value);
}
