/* A model in lanes as a table: one instance holds a vector for each of its variables, an element for each lane. */
#ifndef LANE_LIBRARY_H
#define LANE_LIBRARY_H

#include "lanes.h"
#include "library.h"

typedef struct {
    Library table; /* places are those of vectors; a truth value is a mask; it has no start and no step */
    int64_t lanes;
    void (*start)(void *instance, int lane, const double *params);
    void (*step)(void *instance, const lane_i *live, const lane_i *dt_ns);
} LaneLibrary;

#endif
