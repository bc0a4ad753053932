"""What Python does with numbers and C does not: small C functions, written only where a model needs them."""

TEXTS = {
    "int_of": """\
/* Python's int(): truncates. Where Python raises: 0 for NaN, else the nearest integer of 64 bits. */
static int64_t int_of(double x)
{
    if (x >= 9223372036854775808.0) {
        return INT64_MAX;
    }
    if (x <= -9223372036854775808.0) {
        return INT64_MIN;
    }
    return x == x ? (int64_t)x : 0;
}
""",
    "floor_div": """\
/* Python's division of integers that rounds down. Where Python raises (b is 0): 0. */
static int64_t floor_div(int64_t a, int64_t b)
{
    if (b == 0) {
        return 0;
    }
    return a % b != 0 && (a % b < 0) != (b < 0) ? a / b - 1 : a / b;
}
""",
    "floor_mod": """\
/* Python's a % b: has the sign of b. Where Python raises (b is 0): 0. */
static int64_t floor_mod(int64_t a, int64_t b)
{
    const int64_t rest = b == 0 ? 0 : a % b;

    return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}
""",
    "shift_left": """\
/* Python's a << n for results of 64 bits. */
static int64_t shift_left(int64_t a, int64_t n)
{
    return n < 0 || n > 63 ? 0 : (int64_t)((uint64_t)a << (uint64_t)n);
}
""",
    "shift_right": """\
/* Python's a >> n: fills up with the sign. Where Python raises (n is negative): 0. */
static int64_t shift_right(int64_t a, int64_t n)
{
    const uint64_t bits = (uint64_t)a;
    const uint64_t shift = n > 63 ? UINT64_C(63) : (uint64_t)n;

    if (n < 0) {
        return 0;
    }
    return (int64_t)(a < 0 ? ~(~bits >> shift) : bits >> shift);
}
""",
    "index_in": """\
#if defined(__GNUC__)
#define LIKELY(condition) __builtin_expect(condition, 1)
#else
#define LIKELY(condition) (condition)
#endif

/* Index of an item of n, from the end if negative. Where Python raises (no such item): the nearest one. */
static int64_t index_in(int64_t index, int64_t n)
{
    if (LIKELY((uint64_t)index < (uint64_t)n)) {
        return index;
    }
    if (index < 0) {
        return index + n < 0 ? 0 : index + n;
    }
    return n - 1;
}
""",
    "int_within": """\
/* The integer nearest to a from low to high: what a column keeps of one that does not fit, where Python raises. */
static int64_t int_within(int64_t a, int64_t low, int64_t high)
{
    return a < low ? low : a > high ? high : a;
}
""",
    "int_abs": """\
/* Python's abs() of an integer. */
static int64_t int_abs(int64_t a)
{
    return a < 0 ? -a : a;
}
""",
    "int_min": """\
/* Python's min(a, b). */
static int64_t int_min(int64_t a, int64_t b)
{
    return b < a ? b : a;
}
""",
    "int_max": """\
/* Python's max(a, b). */
static int64_t int_max(int64_t a, int64_t b)
{
    return b > a ? b : a;
}
""",
    "float_min": """\
/* Python's min(a, b): a unless b is less; so NaN stays if it is a, and is passed over if it is b. */
static double float_min(double a, double b)
{
    return b < a ? b : a;
}
""",
    "float_max": """\
/* Python's max(a, b): a unless b is greater; so NaN stays if it is a, and is passed over if it is b. */
static double float_max(double a, double b)
{
    return b > a ? b : a;
}
""",
    "int_quotient": """\
/* Python's a / b of integers: the exact quotient rounded once. Where Python raises (b is 0): infinite or NaN. */
static double int_quotient(int64_t a, int64_t b)
{
    const int64_t whole = INT64_C(9007199254740992);
    const uint64_t divisor = b < 0 ? -(uint64_t)b : (uint64_t)b;
    const uint64_t dividend = a < 0 ? -(uint64_t)a : (uint64_t)a;
    uint64_t quotient;
    uint64_t rest;
    int bits = 0;

    if ((-whole <= a && a <= whole && -whole <= b && b <= whole) || a == 0 || b == 0) {
        return (double)a / (double)b;
    }
    quotient = dividend / divisor;
    rest = dividend % divisor;
    while (quotient < UINT64_C(36028797018963968)) {
        const uint64_t twice = rest << 1;

        rest = twice >= divisor ? twice - divisor : twice;
        quotient = (quotient << 1) | (uint64_t)(twice >= divisor);
        ++bits;
    }
    quotient |= (uint64_t)(rest != 0);
    return ldexp((a < 0) == (b < 0) ? (double)quotient : -(double)quotient, -bits);
}
""",
    "compare_int_float": """\
/* Less than, equal to, greater than 0 as the integer a is to x, exactly, as in Python; x is not NaN. */
static int compare_int_float(int64_t a, double x)
{
    const double rounded = (double)a;

    if (rounded != x) {
        return rounded < x ? -1 : 1;
    }
    if (x >= 9223372036854775808.0) {
        return -1;
    }
    return (a > (int64_t)x) - (a < (int64_t)x);
}
""",
}
"""By name; none needs another."""


def text(used: set[str]) -> list[str]:
    """Return the lines of the functions ``used``, in a fixed order."""
    return [line for name, body in TEXTS.items() if name in used for line in ["", *body.splitlines()]]
