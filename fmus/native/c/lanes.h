/* Vectors that hold one number of each lane: an instance of a model among those that advance together.
 *
 * A truth value is a mask: all bits of a lane set, or none. A function with `live` as its first argument changes
 * nothing in lanes outside of it, and what it returns there means nothing.
 */
#ifndef LANES_H
#define LANES_H

#include <immintrin.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#ifdef __AVX512DQ__
#define LANES 8
#define LANE_ALL(x) {x, x, x, x, x, x, x, x}
#else
#define LANES 4
#define LANE_ALL(x) {x, x, x, x}
#endif

typedef double lane_d __attribute__((vector_size(LANES * 8)));
typedef int64_t lane_i __attribute__((vector_size(LANES * 8)));

#define LANE_NONE ((lane_i){0})
#define LANE_DOUBLE(x) ((double)(x) - (lane_d){0})
#define LANE_INT(x) ((int64_t)(x) + (lane_i){0})
#define LANE_EACH(l) for (int l = 0; l < LANES; ++l)

static inline int lane_any(lane_i mask) {
#if LANES == 8
    return _mm512_test_epi64_mask((__m512i)mask, (__m512i)mask) != 0;
#else
    return !_mm256_testz_si256((__m256i)mask, (__m256i)mask);
#endif
}

/* A bit for each lane of a mask. */
static inline unsigned lane_bits(lane_i mask) {
#if LANES == 8
    return _mm512_movepi64_mask((__m512i)mask);
#else
    return (unsigned)_mm256_movemask_pd((__m256d)mask);
#endif
}

static inline lane_i lane_pick_i(lane_i where, lane_i a, lane_i b) { return (where & a) | (~where & b); }
static inline lane_i lane_pick_b(lane_i where, lane_i a, lane_i b) { return (where & a) | (~where & b); }

static inline lane_d lane_pick_d(lane_i where, lane_d a, lane_d b) {
    return (lane_d)((where & (lane_i)a) | (~where & (lane_i)b));
}

static inline lane_d lane_fabs(lane_d x) { return (lane_d)((lane_i)x & INT64_MAX); }

static inline lane_d lane_copysign(lane_d x, lane_d sign) {
    return (lane_d)(((lane_i)x & INT64_MAX) | ((lane_i)sign & INT64_MIN));
}

static inline lane_d lane_float_min(lane_d a, lane_d b) { return lane_pick_d(b < a, b, a); }
static inline lane_d lane_float_max(lane_d a, lane_d b) { return lane_pick_d(b > a, b, a); }
static inline lane_i lane_int_min(lane_i a, lane_i b) { return lane_pick_i(b < a, b, a); }
static inline lane_i lane_int_max(lane_i a, lane_i b) { return lane_pick_i(b > a, b, a); }
static inline lane_i lane_int_abs(lane_i a) { return lane_pick_i(a < 0, -a, a); }

static inline lane_i lane_index_in(lane_i index, lane_i n) {
    const lane_i place = lane_pick_i(index < 0, index + n, index);
    return lane_pick_i(place < 0, LANE_NONE, lane_pick_i(place < n, place, n - 1));
}

static inline lane_i lane_shift_left(lane_i a, lane_i n) {
    return lane_pick_i((n < 0) | (n > 63), LANE_NONE, a << (n & 63));
}

static inline lane_i lane_shift_right(lane_i a, lane_i n) {
    return lane_pick_i(n < 0, LANE_NONE, a >> (lane_int_min(n, LANE_INT(63)) & 63));
}

static inline lane_i lane_int_of(lane_d x) {
    const lane_i is_small = lane_fabs(x) < 9223372036854775808.0;
    const lane_i whole = __builtin_convertvector(lane_pick_d(is_small, x, LANE_DOUBLE(0.0)), lane_i);
    return lane_pick_i(is_small | (x != x), whole, lane_pick_i(x > 0.0, LANE_INT(INT64_MAX), LANE_INT(INT64_MIN)));
}

static inline lane_i lane_isnan(lane_d x) { return x != x; }
static inline lane_i lane_isfinite(lane_d x) { return x - x == 0.0; }
static inline lane_i lane_isinf(lane_d x) { return (x == x) & ~lane_isfinite(x); }

#define LANE_EXACT(name)                              \
    static inline lane_d lane_##name(lane_d x) {      \
        lane_d r;                                     \
        LANE_EACH(l) r[l] = name(x[l]);               \
        return r;                                     \
    }
LANE_EXACT(sqrt)
LANE_EXACT(floor)
LANE_EXACT(ceil)
LANE_EXACT(trunc)
LANE_EXACT(rint)

static inline lane_d lane_fmod(lane_d x, lane_d y) {
    lane_d r;
    LANE_EACH(l) r[l] = fmod(x[l], y[l]);
    return r;
}

/* A call of a function: its argument and what it gave. */
typedef struct {
    lane_d x, result, other;
} LaneCall;

/* The calls that an instance remembers: the last one of each function, then the last one at each place that has one. */
enum {
    LANE_LAST_sin, LANE_LAST_cos, LANE_LAST_tan, LANE_LAST_atan, LANE_LAST_sincos,
    LANE_LAST_asin, LANE_LAST_acos, LANE_LAST_sinh, LANE_LAST_cosh, LANE_LAST_tanh, LANE_LAST_asinh, LANE_LAST_acosh,
    LANE_LAST_atanh, LANE_LAST_exp, LANE_LAST_expm1, LANE_LAST_log, LANE_LAST_log1p, LANE_LAST_log2, LANE_LAST_log10,
    LANE_FUNCTIONS
};

static inline lane_i lane_differs(lane_d a, lane_d b) { return ((lane_i)a ^ (lane_i)b) != 0; }

/* The call at a place, made by `lane_name_of(call, live, x)`: many have the argument of the step before, or that of the
 * call before. */
#define LANE_REMEMBERED(name)                                                                                      \
    static __attribute__((noinline)) void lane_##name##_at(LaneCall *call, LaneCall *last, lane_i new, lane_d x) { \
        const lane_i unknown = new & lane_differs(last->x, x);                                                     \
        if (lane_any(unknown)) lane_##name##_of(last, unknown, x);                                                 \
        call->x = lane_pick_d(new, x, call->x);                                                                    \
        call->result = lane_pick_d(new, last->result, call->result);                                               \
        call->other = lane_pick_d(new, last->other, call->other);                                                  \
    }                                                                                                              \
    static inline const LaneCall *lane_##name##_call(LaneCall *calls, int place, lane_i live, lane_d x) {          \
        LaneCall *const call = &calls[LANE_FUNCTIONS + place];                                                     \
        const lane_i new = live & lane_differs(call->x, x);                                                        \
        if (lane_any(new)) lane_##name##_at(call, &calls[LANE_LAST_##name], new, x);                               \
        return call;                                                                                               \
    }

#define LANE_FUNCTION(name)                                                               \
    LANE_REMEMBERED(name)                                                                 \
    static inline lane_d lane_##name(LaneCall *calls, int place, lane_i live, lane_d x) { \
        return lane_##name##_call(calls, place, live, x)->result;                         \
    }

/* One lane after the other, by the platform's function: the same bits as in a single run. */
#define LANE_PLATFORM(name)                                                       \
    static inline void lane_##name##_of(LaneCall *call, lane_i live, lane_d x) { \
        LANE_EACH(l) if (live[l]) call->result[l] = name(x[l]);                   \
        call->x = lane_pick_d(live, x, call->x);                                  \
    }                                                                             \
    LANE_FUNCTION(name)
LANE_PLATFORM(asin)
LANE_PLATFORM(acos)
LANE_PLATFORM(sinh)
LANE_PLATFORM(cosh)
LANE_PLATFORM(tanh)
LANE_PLATFORM(asinh)
LANE_PLATFORM(acosh)
LANE_PLATFORM(atanh)
LANE_PLATFORM(exp)
LANE_PLATFORM(expm1)
LANE_PLATFORM(log)
LANE_PLATFORM(log1p)
LANE_PLATFORM(log2)
LANE_PLATFORM(log10)

static inline lane_d lane_atan2(LaneCall *calls, int place, lane_i live, lane_d y, lane_d x) {
    (void)calls;
    (void)place;
    lane_d r = {0};
    LANE_EACH(l) if (live[l]) r[l] = atan2(y[l], x[l]);
    return r;
}

#endif
