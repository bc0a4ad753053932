/* Sine, cosine, tangent and arc tangent of vectors, with the bits of the platform's functions.
 *
 * Sine and cosine are worked out as glibc does since 2.28 where the processor has fma(): two short polynomials about
 * the nearest angle of a table, with the same roundings. lanes_agree() compares some with the platform's. Arguments
 * beyond 1e8, infinite ones and NaN ask the platform.
 *
 * Tangent and arc tangent are each worked out as a sum of two doubles, hi + lo. The platform's result can then only be
 * the double nearest to it, unless the sum lies within both errors of the middle between two doubles; lanes where it
 * does ask the platform, and so do arguments beyond 1,000, infinite ones and NaN. Of 6 million arguments in each of 36
 * ranges, glibc 2.36 is wrong by half a unit in the last place and at most
 *
 *     |x|           0 .. 0.06   .. 0.125   .. 0.25   .. 1     beyond
 *     tangent       0.0024      0.066      0.029     0.016    0.080
 *     arc tangent   0.0020      0.021      0.016     0.012    0.004
 *
 * The tangent's sum starts from the table of sines, too; its own error is below 0.001 units. That of the arc tangent, a
 * polynomial through 12 Chebyshev nodes, is below 0.01.
 */
#ifndef LANE_MATH_H
#define LANE_MATH_H

#include "lane_sines.h"
#include "lane_tangents.h"
#include "lanes.h"

#define LANE_MOST 1000.0
#define LANE_LEAST 0x1p-27 /* the function is its argument below it */
#define LANE_TABULATED 0.06 /* glibc has polynomials for tangent and arc tangent below it, tabulated points beyond */

typedef struct {
    lane_d hi, lo;
} LaneSum;

typedef double Platform(double x);

static inline lane_d lane_fma(lane_d a, lane_d b, lane_d c) {
#if LANES == 8
    return (lane_d)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
#else
    return (lane_d)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
#endif
}

/* a + b where |a| >= |b| or a is 0. */
static inline LaneSum lane_add(lane_d a, lane_d b) {
    const lane_d sum = a + b;
    const LaneSum result = {sum, (a - sum) + b};
    return result;
}

static inline LaneSum lane_product(lane_d a, lane_d b) {
    const lane_d product = a * b;
    const LaneSum result = {product, lane_fma(a, b, -product)};
    return result;
}

static inline lane_d lane_polynomial(lane_d x, const double *coefficients, int count) {
    lane_d sum = LANE_DOUBLE(coefficients[count - 1]);
    for (int i = count - 2; i >= 0; i--) sum = lane_fma(sum, x, LANE_DOUBLE(coefficients[i]));
    return sum;
}

/* The result with that of the platform in some lanes, a bit for each. */
static __attribute__((noinline)) lane_d lane_asked(lane_d result, lane_d x, unsigned lanes, Platform *platform) {
    union {
        lane_d vector;
        double numbers[LANES];
    } from = {x}, to = {result};
    for (; lanes; lanes &= lanes - 1) {
        const int l = __builtin_ctz(lanes);
        to.numbers[l] = platform(from.numbers[l]);
    }
    return to.vector;
}

/* The rounded sum; where the middle lies nearer than `unsure` units in the last place, or `asks` says so, what the
 * platform has. */
static inline lane_d lane_round(lane_i live, LaneSum sum, lane_d unsure, lane_i asks, lane_d x, Platform *platform) {
    lane_d result = sum.hi + sum.lo;
    const lane_d rest = (sum.hi - result) + sum.lo;
    const lane_d unit = (lane_d)((lane_i)result & INT64_C(0x7FF0000000000000)) * (unsure * 0x1p-52);
    const lane_i ask = live & (asks | (result + (rest + lane_copysign(unit, rest)) != result));
    const unsigned lanes = lane_bits(ask);
    return lanes ? lane_asked(result, x, lanes, platform) : result;
}

/* An argument as quarter * pi / 2 + a + rest. */
typedef struct {
    lane_d a, rest;
    lane_i quarter, asks;
} LaneQuarter;

static inline LaneQuarter lane_quarter(lane_i live, lane_d x) {
    const lane_d size = lane_fabs(x);
    const lane_i beyond = live & ~(size < 0x1.b6p-1), far = beyond & ~(size < 0x1.368fdp+1);
    LaneQuarter turn = {x, LANE_DOUBLE(0.0), LANE_NONE, LANE_NONE};
    if (lane_any(beyond)) { /* to 2.43: one quarter */
        const lane_d y = 0x1.921fb54442d18p+0 - size, a = y + 0x1.1a62633145c07p-54;
        const lane_i sign = ~(lane_i)x & INT64_MIN;
        turn.a = lane_pick_d(beyond, (lane_d)((lane_i)a ^ sign), x);
        turn.rest = (lane_d)(((lane_i)((y - a) + 0x1.1a62633145c07p-54) ^ sign) & beyond);
        turn.quarter = lane_pick_i(x < 0.0, LANE_INT(3), LANE_INT(1)) & beyond;
    }
    if (lane_any(far)) {
        const lane_d shifted = lane_fma(x, LANE_DOUBLE(0x1.45f306dc9c883p-1), LANE_DOUBLE(0x1.8p52));
        const lane_d n = 0x1.8p52 - shifted;
        const lane_d near = lane_fma(n, LANE_DOUBLE(0x1.921fb58p0), x);
        const lane_d y = lane_fma(n, LANE_DOUBLE(-0x1.dde973cp-27), near);
        const lane_d first = lane_fma(n, LANE_DOUBLE(-0x1.cb3b398p-55), y);
        const lane_d a = lane_fma(n, LANE_DOUBLE(-0x1.d747f23e32ed7p-83), first);
        const lane_d rest = lane_fma(n, LANE_DOUBLE(-0x1.cb3b398p-55), y - first);
        turn.a = lane_pick_d(far, a, turn.a);
        turn.rest = lane_pick_d(far, lane_fma(n, LANE_DOUBLE(-0x1.d747f23e32ed7p-83), first - a) + rest, turn.rest);
        turn.quarter = lane_pick_i(far, (lane_i)shifted, turn.quarter);
        turn.asks = far & ~(size < 1e8);
    }
    return turn;
}

/* A row of a table for each lane. */
typedef struct {
    lane_d a, b, c, d;
} LaneRow;

static inline LaneRow lane_row(const double table[][4], lane_i number) {
#if LANES == 8
#define LANE_TWO(i, j) \
    _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(table[number[i]])), _mm256_loadu_pd(table[number[j]]), 1)
    const __m512d even = LANE_TWO(0, 2), odd = LANE_TWO(1, 3), later_even = LANE_TWO(4, 6), later_odd = LANE_TWO(5, 7);
    const __m512d low = _mm512_unpacklo_pd(even, odd), later_low = _mm512_unpacklo_pd(later_even, later_odd);
    const __m512d high = _mm512_unpackhi_pd(even, odd), later_high = _mm512_unpackhi_pd(later_even, later_odd);
    const LaneRow row = {
        (lane_d)_mm512_shuffle_f64x2(low, later_low, 0x88),
        (lane_d)_mm512_shuffle_f64x2(high, later_high, 0x88),
        (lane_d)_mm512_shuffle_f64x2(low, later_low, 0xDD),
        (lane_d)_mm512_shuffle_f64x2(high, later_high, 0xDD),
    };
#else
    const __m256d first = _mm256_loadu_pd(table[number[0]]), second = _mm256_loadu_pd(table[number[1]]);
    const __m256d third = _mm256_loadu_pd(table[number[2]]), fourth = _mm256_loadu_pd(table[number[3]]);
    const __m256d low = _mm256_unpacklo_pd(first, second), later_low = _mm256_unpacklo_pd(third, fourth);
    const __m256d high = _mm256_unpackhi_pd(first, second), later_high = _mm256_unpackhi_pd(third, fourth);
    const LaneRow row = {
        (lane_d)_mm256_permute2f128_pd(low, later_low, 0x20),
        (lane_d)_mm256_permute2f128_pd(high, later_high, 0x20),
        (lane_d)_mm256_permute2f128_pd(low, later_low, 0x31),
        (lane_d)_mm256_permute2f128_pd(high, later_high, 0x31),
    };
#endif
    return row;
}

/* The tabulated angle next to |a|, and what |a| + rest is beyond it. */
typedef struct {
    lane_d beyond, rest, sin, sin_rest, cos, cos_rest;
} LaneNode;

static inline LaneNode lane_node(lane_d a, lane_d rest) {
    const lane_d size = lane_fabs(a), shifted = size + 0x1.8p45;
    const LaneRow row = lane_row(lane_sines, (lane_i)shifted & (LANE_SINES - 1));
    const LaneNode node = {
        .beyond = size - (shifted - 0x1.8p45),
        .rest = (lane_d)((lane_i)rest ^ ((lane_i)a & INT64_MIN)),
        .sin = row.a,
        .sin_rest = row.b,
        .cos = row.c,
        .cos_rest = row.d,
    };
    return node;
}

static inline lane_d lane_sine_of_rest(lane_d x, lane_d square, lane_d rest) {
    const lane_d part = lane_fma(square, LANE_DOUBLE(8.33333214285722277379541354343671e-03),
                                 LANE_DOUBLE(-1.66666666666664880952546298448555e-01));
    return lane_fma(x * square, part, rest);
}

static inline lane_d lane_cosine_of_rest(lane_d square) {
    const lane_d part = lane_fma(square, LANE_DOUBLE(1.38888874007937613028114285595617e-03),
                                 LANE_DOUBLE(-4.16666666666664434524222570944589e-02));
    return square * lane_fma(square, part, LANE_DOUBLE(4.99999999999999999999950396842453e-01));
}

/* Sine of a + rest, |a| < 0.86. */
static inline lane_d lane_near_sin(lane_i live, const LaneQuarter *turn, const LaneNode *node) {
    const lane_d a = turn->a, rest = turn->rest;
    const lane_i is_small = lane_fabs(a) < 0.126;
    lane_d found = a;
    if (lane_any(live & is_small)) {
        const lane_d square = a * a;
        lane_d sum = lane_fma(LANE_DOUBLE(-2.5022014848318398e-08), square, LANE_DOUBLE(2.755729806860771e-06));
        sum = lane_fma(sum, square, LANE_DOUBLE(-0.00019841269834414642));
        sum = lane_fma(sum, square, LANE_DOUBLE(0.0083333333333323288));
        sum = lane_fma(sum, square, LANE_DOUBLE(-0.16666666666666666));
        sum = lane_fma(lane_fma(sum, a, -0.5 * rest), square, rest);
        found = lane_pick_d(lane_fabs(a) < 0x1p-26, a, a + sum);
    }
    if (lane_any(live & ~is_small)) {
        const lane_d x = node->beyond, square = x * x;
        const lane_d s = x + lane_sine_of_rest(x, square, node->rest);
        const lane_d c = lane_fma(x, node->rest, lane_cosine_of_rest(square));
        const lane_d sum = lane_fma(-node->sin, c, lane_fma(s, node->cos_rest, node->sin_rest));
        const lane_d whole = node->sin + lane_fma(node->cos, s, sum);
        found = lane_pick_d(is_small, found, lane_copysign(whole, a));
    }
    return found;
}

static inline lane_d lane_near_cos(const LaneNode *node) {
    const lane_d x = node->beyond + node->rest, square = x * x;
    const lane_d s = lane_sine_of_rest(x, square, x), c = lane_cosine_of_rest(square);
    const lane_d sum = lane_fma(-node->cos, c, lane_fma(-s, node->sin_rest, node->cos_rest));
    return node->cos + lane_fma(-node->sin, s, sum);
}

/* Sine of the argument a whole number of quarter turns on; asked of the platform where it is too large. */
static inline lane_d lane_sine(lane_i live, lane_d x, const LaneQuarter *turn, const LaneNode *node, int on,
                               Platform *platform) {
    const lane_i quarter = turn->quarter + on, odd = -(quarter & 1);
    lane_d found = {0};
    if (lane_any(live & ~odd)) found = lane_near_sin(live & ~odd, turn, node);
    if (lane_any(live & odd)) found = lane_pick_d(odd, lane_near_cos(node), found);
    found = (lane_d)((lane_i)found ^ (quarter << 62 & INT64_MIN));
    return lane_any(turn->asks) ? lane_asked(found, x, lane_bits(turn->asks), platform) : found;
}

#define LANE_OF_TURN(name, on)                                                                               \
    static __attribute__((noinline)) void lane_##name##_of(LaneCall *call, lane_i live, lane_d x) {          \
        const LaneQuarter turn = lane_quarter(live, x);                                                      \
        const LaneNode node = lane_node(turn.a, turn.rest);                                                  \
        call->result = lane_pick_d(live, lane_sine(live, x, &turn, &node, on, name), call->result);          \
        call->x = lane_pick_d(live, x, call->x);                                                             \
    }
LANE_OF_TURN(sin, 0)
LANE_OF_TURN(cos, 1)

/* Sine in `result`, cosine in `other`. */
static __attribute__((noinline)) void lane_sincos_of(LaneCall *call, lane_i live, lane_d x) {
    const LaneQuarter turn = lane_quarter(live, x);
    const LaneNode node = lane_node(turn.a, turn.rest);
    call->result = lane_pick_d(live, lane_sine(live, x, &turn, &node, 0, sin), call->result);
    call->other = lane_pick_d(live, lane_sine(live, x, &turn, &node, 1, cos), call->other);
    call->x = lane_pick_d(live, x, call->x);
}

#if LANE_TANGENTS
#define LANE_LAST_TANGENT 0x1.92f1ap-1

/* Tangent of |x| <= LANE_LAST_TANGENT from the platform's own table, with its roundings. */
static inline lane_d lane_near_tan(lane_i live, lane_d x) {
    const lane_d size = lane_fabs(x);
    const lane_i is_small = size <= 0x1.f212dp-5;
    lane_d found = x;
    if (lane_any(live & ~is_small)) {
        const lane_d place = lane_fma(size, LANE_DOUBLE(256.0), LANE_DOUBLE(-15.5)), shifted = place + 0x1.8p52;
        const lane_i below = shifted - 0x1.8p52 > place;
        const LaneRow row = lane_row(lane_tangents, ((lane_i)shifted + below) & (LANE_TANGENTS - 1));
        const lane_d z = size - row.a, square = z * z;
        const lane_d sum = lane_fma(square, LANE_DOUBLE(0x1.11112e0a6b45fp-3), LANE_DOUBLE(0x1.5555555554dbdp-2));
        const lane_d tan = lane_fma(z * square, sum, z);
        found = lane_copysign(row.b + row.d * tan / (row.c - tan), x);
    }
    if (lane_any(live & is_small)) {
        const lane_d square = x * x;
        lane_d sum = lane_fma(LANE_DOUBLE(0x1.2385a3cf2e4eap-7), square, LANE_DOUBLE(0x1.664ed49cfc666p-6));
        sum = lane_fma(sum, square, LANE_DOUBLE(0x1.ba1ba1cdb8745p-5));
        sum = lane_fma(sum, square, LANE_DOUBLE(0x1.11111111107c6p-3));
        sum = lane_fma(sum, square, LANE_DOUBLE(0x1.5555555555555p-2));
        found = lane_pick_d(is_small, lane_fma(x * square, sum, x), found);
    }
    return found;
}
#endif

/* Sine and cosine of |a| + rest are those of the angle in the table and of what is beyond it, in two doubles each. */
static __attribute__((noinline)) lane_d lane_summed_tan(lane_i live, lane_d x) {
    const LaneQuarter turn = lane_quarter(live, x);
    const LaneNode node = lane_node(turn.a, turn.rest);
    const lane_d size = lane_fabs(x), d = node.beyond, square = d * d;
    const lane_d fifth = lane_fma(square, LANE_DOUBLE(-1.0 / 5040.0), LANE_DOUBLE(1.0 / 120.0));
    const lane_d sine = lane_fma(d * square, lane_fma(square, fifth, LANE_DOUBLE(-1.0 / 6.0)), node.rest); /* less d */
    const lane_d fourth = lane_fma(square, LANE_DOUBLE(-1.0 / 720.0), LANE_DOUBLE(1.0 / 24.0));
    const lane_d cosine = square * lane_fma(square, fourth, LANE_DOUBLE(-0.5)); /* less 1 */
    const LaneSum up = lane_product(node.cos, d), down = lane_product(node.sin, d);
    LaneSum sin = lane_add(node.sin, up.hi), cos = lane_add(node.cos, -down.hi);
    sin.lo += up.lo + lane_fma(node.cos_rest, d, node.sin_rest) + lane_fma(node.sin, cosine, node.cos * sine);
    cos.lo += lane_fma(-node.sin_rest, d, node.cos_rest) - down.lo + lane_fma(node.cos, cosine, -(node.sin * sine));
    const lane_i odd = -(turn.quarter & 1), sign = ((lane_i)turn.a ^ odd) & INT64_MIN;
    const LaneSum above = {lane_pick_d(odd, cos.hi, sin.hi), lane_pick_d(odd, cos.lo, sin.lo)};
    const LaneSum below = {lane_pick_d(odd, sin.hi, cos.hi), lane_pick_d(odd, sin.lo, cos.lo)};
    const lane_d quotient = above.hi / below.hi, inverse = 1.0 / (below.hi + below.lo);
    const lane_d rest = (lane_fma(-quotient, below.hi, above.hi) + lane_fma(-quotient, below.lo, above.lo)) * inverse;
    const LaneSum sum = {(lane_d)((lane_i)quotient ^ sign), (lane_d)((lane_i)rest ^ sign)};
    const lane_d middle = lane_pick_d(size > 0.25, LANE_DOUBLE(0.022), LANE_DOUBLE(0.04));
    const lane_d beyond = lane_pick_d((size > 0.125) & (size < 1.0), middle, LANE_DOUBLE(0.1));
    const lane_d unsure = lane_pick_d(size < LANE_TABULATED, LANE_DOUBLE(0.004), beyond);
    const lane_i asks = ~(size < LANE_MOST) | ((lane_fabs(turn.a) < 0x1p-30) & (turn.quarter != 0));
    const lane_i is_small = size < LANE_LEAST;
    return lane_pick_d(is_small, x, lane_round(live & ~is_small, sum, unsure, asks, x, tan));
}

static __attribute__((noinline)) void lane_tan_of(LaneCall *call, lane_i live, lane_d x) {
#if LANE_TANGENTS
    const lane_i far = live & ~(lane_fabs(x) <= LANE_LAST_TANGENT);
    lane_d found = lane_near_tan(live & ~far, x);
    if (lane_any(far)) found = lane_pick_d(far, lane_summed_tan(far, x), found);
#else
    const lane_d found = lane_summed_tan(live, x);
#endif
    call->result = lane_pick_d(live, found, call->result);
    call->x = lane_pick_d(live, x, call->x);
}


static __attribute__((noinline)) void lane_atan_of(LaneCall *call, lane_i live, lane_d x) {
    static const double tail[] = {0x1.9999999999999p-3,  -0x1.24924924923ccp-3, 0x1.c71c71c7044c3p-4,
                                  -0x1.745d173c91fe7p-4, 0x1.3b13af6536f2ep-4,  -0x1.1110d9d5114ebp-4,
                                  0x1.e1d99b2a1957ap-5,  -0x1.aebf1c05800f8p-5, 0x1.828f47a3f6753p-5,
                                  -0x1.4faa3840a4f96p-5, 0x1.f1e5bc3c03524p-6,  -0x1.bd8af68dd62b7p-7};
    static const double starts[] = {0.4375, 0.6875, 1.1875}, centres[] = {0.5, 1.0, 1.5};
    static const double angles[] = {0x1.dac670561bb4fp-2, 0x1.921fb54442d18p-1, 0x1.f730bd281f69bp-1};
    static const double rests[] = {0x1.a2b7f222f65e2p-56, 0x1.1a62633145c07p-55, 0x1.007887af0cbbdp-56};
    const lane_d size = lane_fabs(x);
    const lane_i is_small = size < LANE_LEAST, is_large = size > 2.4375;
    lane_d centre = LANE_DOUBLE(0.0), angle = centre, angle_rest = centre;
    for (int i = 0; i < 3; i++) {
        const lane_i where = size >= starts[i];
        centre = lane_pick_d(where, LANE_DOUBLE(centres[i]), centre);
        angle = lane_pick_d(where, LANE_DOUBLE(angles[i]), angle);
        angle_rest = lane_pick_d(where, LANE_DOUBLE(rests[i]), angle_rest);
    }
    angle = lane_pick_d(is_large, LANE_DOUBLE(0x1.921fb54442d18p+0), angle);
    angle_rest = lane_pick_d(is_large, LANE_DOUBLE(0x1.1a62633145c07p-54), angle_rest);
    /* t = (size - centre) / (1 + centre size), or -1 / size */
    const lane_d above = lane_pick_d(is_large, LANE_DOUBLE(-1.0), size - centre);
    const lane_d sum = lane_fma(centre, size, LANE_DOUBLE(1.0));
    const lane_d below = lane_pick_d(is_large, size, sum);
    const lane_d below_rest = lane_pick_d(is_large, LANE_DOUBLE(0.0), lane_fma(centre, size, 1.0 - sum));
    const lane_d t = above / below, t_rest = (lane_fma(-t, below, above) - t * below_rest) / below;
    LaneSum square = lane_product(t, t), cube, first, result;
    square.lo += 2.0 * t * t_rest;
    cube = lane_product(t, square.hi);
    cube.lo += t * square.lo + t_rest * square.hi;
    const LaneSum third = lane_product(cube.hi, LANE_DOUBLE(-0x1.5555555555555p-2));
    first = lane_add(t, third.hi);
    result = lane_add(angle, first.hi);
    result.lo += first.lo + (t_rest + angle_rest) +
                 (third.lo + cube.lo * -0x1.5555555555555p-2 + cube.hi * -0x1.5555555555555p-56) +
                 square.hi * cube.hi * lane_polynomial(square.hi, tail, 12);
    result.hi = (lane_d)((lane_i)result.hi ^ ((lane_i)x & INT64_MIN));
    result.lo = (lane_d)((lane_i)result.lo ^ ((lane_i)x & INT64_MIN));
    const lane_d beyond = lane_pick_d(size > 0.26, LANE_DOUBLE(0.02), LANE_DOUBLE(0.04));
    const lane_d unsure = lane_pick_d(size < LANE_TABULATED, LANE_DOUBLE(0.01), beyond);
    result.hi = lane_round(live & ~is_small, result, unsure, ~(size < 1e15), x, atan);
    call->result = lane_pick_d(live, lane_pick_d(is_small, x, result.hi), call->result);
    call->x = lane_pick_d(live, x, call->x);
}

LANE_FUNCTION(sin)
LANE_FUNCTION(cos)
LANE_FUNCTION(tan)
LANE_FUNCTION(atan)
LANE_REMEMBERED(sincos)

#endif
