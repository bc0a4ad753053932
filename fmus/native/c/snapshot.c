/* Saving, restoring and serializing the whole state of an instance. */
#include "slave.h"

#include <stdlib.h>
#include <string.h>

/* Serialized form: this header, then the numbers as they lie in memory. For the same binary only. */
typedef struct {
    char magic[8];
    uint64_t model; /* hash of the GUID */
    uint64_t check; /* hash of the numbers */
    uint64_t size;
} Header;

static const char MAGIC[8] = "APAFMU1";

/* FNV-1a, 64 bit. */
static uint64_t hash(const void *data, size_t size) {
    uint64_t value = 14695981039346656037u;
    for (size_t i = 0; i < size; i++) value = (value ^ ((const unsigned char *)data)[i]) * 1099511628211u;
    return value;
}

static Header header_of(const Saved *saved) {
    Header header = {.model = hash(model_guid, strlen(model_guid)),
                     .check = hash(saved, sizeof *saved),
                     .size = sizeof *saved};
    memcpy(header.magic, MAGIC, sizeof MAGIC);
    return header;
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state) {
    Slave *slave = slave_in(component, ANY_PHASE, "fmi2GetFMUstate");
    if (!slave) return fmi2Error;
    if (!state) return report(slave, fmi2Error, "fmi2GetFMUstate: null pointer");
    if (!*state) *state = malloc(sizeof slave->saved);
    if (!*state) return report(slave, fmi2Error, "fmi2GetFMUstate: out of memory");
    memcpy(*state, &slave->saved, sizeof slave->saved);
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
    Slave *slave = slave_in(component, ANY_PHASE, "fmi2SetFMUstate");
    if (!slave) return fmi2Error;
    if (!state) return report(slave, fmi2Error, "fmi2SetFMUstate: null pointer");
    memcpy(&slave->saved, state, sizeof slave->saved);
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state) {
    Slave *slave = slave_in(component, ANY_PHASE, "fmi2FreeFMUstate");
    if (!slave) return fmi2Error;
    if (!state) return fmi2OK;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size) {
    Slave *slave = slave_in(component, ANY_PHASE, "fmi2SerializedFMUstateSize");
    if (!slave) return fmi2Error;
    if (!state || !size) return report(slave, fmi2Error, "fmi2SerializedFMUstateSize: null pointer");
    *size = sizeof(Header) + sizeof slave->saved;
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    Slave *slave = slave_in(component, ANY_PHASE, "fmi2SerializeFMUstate");
    if (!slave) return fmi2Error;
    if (!state || !bytes) return report(slave, fmi2Error, "fmi2SerializeFMUstate: null pointer");
    if (size < sizeof(Header) + sizeof slave->saved)
        return report(slave, fmi2Error, "fmi2SerializeFMUstate: %zu bytes are too few", size);
    Header header = header_of(state);
    memcpy(bytes, &header, sizeof header);
    memcpy(bytes + sizeof header, state, sizeof slave->saved);
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    Slave *slave = slave_in(component, ANY_PHASE, "fmi2DeSerializeFMUstate");
    if (!slave) return fmi2Error;
    if (!state || !bytes) return report(slave, fmi2Error, "fmi2DeSerializeFMUstate: null pointer");
    if (size < sizeof(Header) + sizeof slave->saved)
        return report(slave, fmi2Error, "fmi2DeSerializeFMUstate: %zu bytes are too few", size);
    Saved *saved = malloc(sizeof *saved);
    if (!saved) return report(slave, fmi2Error, "fmi2DeSerializeFMUstate: out of memory");
    memcpy(saved, bytes + sizeof(Header), sizeof *saved);
    Header header = header_of(saved);
    if (memcmp(&header, bytes, sizeof header)) {
        free(saved);
        return report(slave, fmi2Error, "fmi2DeSerializeFMUstate: not a state of this FMU, or damaged");
    }
    if (!*state) {
        *state = saved;
    } else {
        memcpy(*state, saved, sizeof *saved);
        free(saved);
    }
    return fmi2OK;
}
