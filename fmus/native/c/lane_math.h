/* Sine, cosine, tangent and arc tangent of vectors, with the bits of the platform's functions.
 *
 * Each is worked out as a sum of two doubles, hi + lo, whose error is below 0.01 units in the last place. The
 * platform's result can then only be the double nearest to it, unless the sum lies within the platform's own error of
 * the middle between two doubles. The largest seen of glibc 2.36, of 24 million arguments each, is beyond half a unit
 * by 0.016 for sine and cosine, 0.021 for the arc tangent and 0.078 for the tangent. Lanes where the sum is so near the
 * middle ask the platform; so do arguments beyond 1,000, infinite ones and NaN.
 *
 * Arguments are reduced to |r| <= pi / 4 by two parts of pi / 2 (Cody, Waite), of which fma() makes products exact.
 * Coefficients: Taylor's for sine and cosine; for the arc tangent a polynomial through 12 Chebyshev nodes.
 */
#ifndef LANE_MATH_H
#define LANE_MATH_H

#include "lanes.h"

#define LANE_UNSURE_TURN 0.03 /* of a unit in the last place, on both sides of the middle */
#define LANE_UNSURE_TAN 0.10
#define LANE_UNSURE_ATAN 0.04
#define LANE_MOST 1000.0
#define LANE_LEAST 0x1p-27 /* the function is its argument below it */

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

/* The rounded sum; where another one lies too near, or `asks` says so, what the platform has. */
static inline lane_d lane_round(lane_i live, LaneSum sum, double unsure, lane_i asks, lane_d x, Platform *platform) {
    lane_d result = sum.hi + sum.lo;
    const lane_d rest = (sum.hi - result) + sum.lo;
    const lane_d unit = (lane_d)((lane_i)result & INT64_C(0x7FF0000000000000)) * (unsure * 0x1p-52);
    const lane_i ask = live & (asks | (result + (rest + lane_copysign(unit, rest)) != result));
    const unsigned lanes = lane_bits(ask);
    return lanes ? lane_asked(result, x, lanes, platform) : result;
}

/* What sine, cosine and tangent share: sine and cosine of the reduced argument, and the quarter turns taken off. */
typedef struct {
    LaneSum sin, cos;
    lane_i quarter, asks, is_small;
} LaneTurn;

static inline LaneTurn lane_turn(lane_d x) {
    static const double sines[] = {0x1.1111111111111p-7,   -0x1.a01a01a01a01ap-13, 0x1.71de3a556c734p-19,
                                   -0x1.ae64567f544e4p-26, 0x1.6124613a86d09p-33,  -0x1.ae7f3e733b81fp-41,
                                   0x1.952c77030ad4ap-49};
    static const double cosines[] = {-0x1.6c16c16c16c17p-10, 0x1.a01a01a01a01ap-16, -0x1.27e4fb7789f5cp-22,
                                     0x1.1eed8eff8d898p-29,  -0x1.93974a8c07c9dp-37, 0x1.ae7f3e733b81fp-45,
                                     -0x1.6827863b97d97p-53};
    const lane_d shifted = x * 0x1.45f306dc9c883p-1 + 0x1.8p52, turns = shifted - 0x1.8p52;
    const lane_d near = lane_fma(-turns, LANE_DOUBLE(0x1.921fb54442d18p+0), x); /* exact */
    const LaneSum far = lane_product(turns, LANE_DOUBLE(0x1.1a62633145c07p-54));
    const lane_d r = near - far.hi, rest = ((near - r) - far.hi) - far.lo;
    LaneSum square = lane_product(r, r), cube, fourth, sine, cosine, first;
    LaneTurn turn;
    square.lo += 2.0 * r * rest;
    cube = lane_product(r, square.hi);
    cube.lo += r * square.lo + rest * square.hi;
    const LaneSum sixth = lane_product(cube.hi, LANE_DOUBLE(-0x1.5555555555555p-3));
    sine = lane_add(r, sixth.hi);
    sine.lo += rest + (sixth.lo + cube.lo * -0x1.5555555555555p-3 + cube.hi * -0x1.5555555555555p-57) +
               square.hi * cube.hi * lane_polynomial(square.hi, sines, 7);
    fourth = lane_product(square.hi, square.hi);
    fourth.lo += 2.0 * square.hi * square.lo;
    const LaneSum part = lane_product(fourth.hi, LANE_DOUBLE(0x1.5555555555555p-5));
    first = lane_add(LANE_DOUBLE(1.0), -0.5 * square.hi);
    cosine = lane_add(first.hi, part.hi);
    cosine.lo += first.lo - 0.5 * square.lo +
                 (part.lo + fourth.lo * 0x1.5555555555555p-5 + fourth.hi * 0x1.5555555555555p-59) +
                 square.hi * fourth.hi * lane_polynomial(square.hi, cosines, 7);
    turn.sin = sine;
    turn.cos = cosine;
    turn.quarter = (lane_i)shifted;
    turn.asks = ~(lane_fabs(x) < LANE_MOST) | ((lane_fabs(r) < 0x1p-30) & (turns != 0.0));
    turn.is_small = lane_fabs(x) < LANE_LEAST;
    return turn;
}

static inline LaneSum lane_chosen(lane_i where, LaneSum a, LaneSum b, lane_i sign) {
    const LaneSum sum = {(lane_d)((lane_i)lane_pick_d(where, a.hi, b.hi) ^ sign),
                         (lane_d)((lane_i)lane_pick_d(where, a.lo, b.lo) ^ sign)};
    return sum;
}

static inline lane_d lane_turn_sin(lane_i live, lane_d x, const LaneTurn *turn) {
    const lane_i odd = -(turn->quarter & 1), sign = turn->quarter << 62 & INT64_MIN;
    const LaneSum sum = lane_chosen(odd, turn->cos, turn->sin, sign);
    const lane_d found = lane_round(live & ~turn->is_small, sum, LANE_UNSURE_TURN, turn->asks, x, sin);
    return lane_pick_d(turn->is_small, x, found);
}

static inline lane_d lane_turn_cos(lane_i live, lane_d x, const LaneTurn *turn) {
    const lane_i odd = -(turn->quarter & 1), sign = (turn->quarter + 1) << 62 & INT64_MIN;
    const LaneSum sum = lane_chosen(odd, turn->sin, turn->cos, sign);
    return lane_round(live, sum, LANE_UNSURE_TURN, turn->asks, x, cos);
}

static inline lane_d lane_turn_tan(lane_i live, lane_d x, const LaneTurn *turn) {
    const lane_i odd = -(turn->quarter & 1);
    const LaneSum chosen = lane_chosen(odd, turn->cos, turn->sin, LANE_NONE), above = lane_add(chosen.hi, chosen.lo);
    const LaneSum other = lane_chosen(odd, turn->sin, turn->cos, odd & INT64_MIN), below = lane_add(other.hi, other.lo);
    const lane_d quotient = above.hi / below.hi;
    const lane_d rest = (lane_fma(-quotient, below.hi, above.hi) + above.lo - quotient * below.lo) / below.hi;
    const LaneSum sum = {quotient, rest};
    const lane_d found = lane_round(live & ~turn->is_small, sum, LANE_UNSURE_TAN, turn->asks, x, tan);
    return lane_pick_d(turn->is_small, x, found);
}

#define LANE_OF_TURN(name)                                                                                 \
    static __attribute__((noinline)) void lane_##name##_of(LaneCall *call, lane_i live, lane_d x) {        \
        const LaneTurn turn = lane_turn(x);                                                                \
        call->result = lane_pick_d(live, lane_turn_##name(live, x, &turn), call->result);                  \
        call->x = lane_pick_d(live, x, call->x);                                                           \
    }
LANE_OF_TURN(sin)
LANE_OF_TURN(cos)
LANE_OF_TURN(tan)

/* Sine in `result`, cosine in `other`. */
static __attribute__((noinline)) void lane_sincos_of(LaneCall *call, lane_i live, lane_d x) {
    const LaneTurn turn = lane_turn(x);
    call->result = lane_pick_d(live, lane_turn_sin(live, x, &turn), call->result);
    call->other = lane_pick_d(live, lane_turn_cos(live, x, &turn), call->other);
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
    result.hi = lane_round(live & ~is_small, result, LANE_UNSURE_ATAN, ~(size < 1e15), x, atan);
    call->result = lane_pick_d(live, lane_pick_d(is_small, x, result.hi), call->result);
    call->x = lane_pick_d(live, x, call->x);
}

#define LANE_FUNCTION(name)                                                     \
    static inline lane_d lane_##name(LaneCall *call, lane_i live, lane_d x) {   \
        if (!lane_is_known(call, live, x)) lane_##name##_of(call, live, x);     \
        return call->result;                                                    \
    }
LANE_FUNCTION(sin)
LANE_FUNCTION(cos)
LANE_FUNCTION(tan)
LANE_FUNCTION(atan)
LANE_FUNCTION(sincos)

#endif
