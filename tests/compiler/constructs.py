"""Functions for test_language: one for each construct. Not a model; read as text."""

# ruff: noqa: B002, B007, B008, RUF021, RUF057

import math
from enum import IntEnum
from math import pi
from typing import Annotated, NamedTuple

# ---- types and constants


class Mode(IntEnum):
    """A mode."""

    OFF = 0
    """Nothing."""
    ON = 1
    HALF = 5
    BACK = -2


class Point(NamedTuple):
    """A point."""

    x: float = 0.0
    y: float = 1.0

    def times(self, factor: float, more: float = 0.5) -> "Point":
        """Return the point, longer."""
        return Point(self.x * factor + more, self.y * factor)

    @property
    def sum(self) -> float:
        """Both together."""
        return self.x + self.y


class Flags(NamedTuple):
    """Conditions."""

    low: bool = False
    high: bool = False
    both: bool = True


class Big(NamedTuple):
    """Large enough to be returned by pointer."""

    at: Point = Point()
    row: tuple[float, ...] = (1.0, 2.0, 3.0, 4.0, 5.0)
    mode: int = Mode.HALF
    flags: Flags = Flags()
    default: Annotated[float, "not a signal"] = -0.0
    counts: tuple[int, int, int] = (1, -2, 3)
    points: tuple[Point, ...] = (Point(), Point(2.0, 3.0))


class Three(NamedTuple):
    """Equal fields."""

    a: float = 0.0
    b: float = 0.0
    c: float = 0.0


TWO = 2
LARGE = 3_000_000_000
LIMIT = 2.5
TABLE = (3, 1, 4, 1, 5)
ROWS = ((Mode.OFF, Mode.ON, 2), (Mode.ON, Mode.HALF, 3), (Mode.HALF, Mode.BACK, 4))
MODES = (Mode.ON, Mode.HALF)
PLACES = (Point(0.5, 0.25), Point(-1.0, 2.0), Point())
START = Big(row=(0.1, 0.2, 0.3, 0.4, 0.5), mode=Mode.ON)
DEEP = ((1.0, 2.0), (3.0, 4.0))
ALIAS = int(Mode.HALF)
EMPTY_BOX = Three(0.0, -0.0, math.inf)


# ---- numbers


def sums(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return x + y - (x - y) * 0.1 - (y - (x - 1.0)) + -x - -y


def products(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return x * (y * x) / (1.5 / (y / 3.0)) / x


def mixed(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return n * x + 2 * y - TWO + p * x - n / 2


def int_sums(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return n % 1000 + m % 1000 * TWO - (7 - n % 10) + (p + q) - -3


def int_wide(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return 100000 * 100000 + LARGE * 3 - (1 << 40) + TWO * 2000000000


def floor_division(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return n // m


def remainder(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return n % m


def quotient(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return n / m


def small_quotient(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return n % 100 / (m % 7 + 1)


def manoeuvres(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return ((n & 0xFFFF) << 13) ^ (m >> 3) | (n >> (m & 31))


def bits_of(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return (n & m) | (n ^ ~m)


def bools(x: float, y: float, n: int, m: int, p: bool, q: bool) -> bool:
    return (p & q) | (p ^ (n < m))


def negative(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return -(-3) - -n // 4


def minus_zero(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return -0.0 if p else 0.0 * -1.0


def constants(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return pi + math.pi + math.tau + math.e + 1e22 + 5e-324 + 1.7976931348623157e308 + LIMIT


def infinities(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return math.inf if x > 0.0 else -math.inf if x < 0.0 else math.nan


def library(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    a = math.sin(x) + math.cos(y) + math.atan(x) + math.atan2(x, y) + math.tan(x)
    return a + math.exp(-abs(x)) + math.sqrt(abs(y)) + math.log(abs(x) + 1.0) + math.tanh(y)


def known_arguments(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Three:
    """C compilers know better, or otherwise, than the C library what these are."""
    return Three(_exp_of(1.9004748476878712), _cos_of(4.6167136412976815), _atan_of(0.7206933530479881))


def _exp_of(x: float) -> float:
    return math.exp(x)


def _cos_of(x: float) -> float:
    return math.cos(x)


def _atan_of(x: float) -> float:
    return math.atan(x)


def inverse(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return math.asin(x) + math.acos(y)


def exact(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return math.copysign(x, y) + math.fabs(x)


def remainder_of_floats(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return math.fmod(x, y)


def tests(x: float, y: float, n: int, m: int, p: bool, q: bool) -> bool:
    return math.isnan(x) or math.isinf(y) or not math.isfinite(x + y)


def floors(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return math.floor(x) + math.ceil(y) + math.trunc(x) + int(y)


def floor_as_float(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return x - y * math.floor(x / y + 0.5) + math.ceil(x) * 1.0


def floor_of_tiny(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return x * math.ceil(-0.25) + y * int(-0.5) + x * round(-0.3)


def rounds(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return round(x) + round(y * 0.5) + round(n)


def floats_of(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return float(n) + float(p) + float(x)


def ints_of(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return int(n) + int(p) + int(bool(x)) + bool(n)


def absolute(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return abs(x) + abs(n) + abs(-2) + abs(p)


def least(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return min(x, y)


def greatest(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return max(y, x, 0.0)


def extremes(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return min(n, m, 3) + max(TABLE) + max(p, n) + min((n, m))


# ---- truth


def chain(x: float, y: float, n: int, m: int, p: bool, q: bool) -> bool:
    return 0.0 < x <= y != 3.0


def chain_of_calls(x: float, y: float, n: int, m: int, p: bool, q: bool) -> bool:
    return n % 5 < _one_more(n % 7) < m


def _one_more(n: int) -> int:
    return n + 1


def logic(x: float, y: float, n: int, m: int, p: bool, q: bool) -> bool:
    return not p and (q or x > y) or n == m and not (p or q)


def either_number(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return x or y or 2.0


def both_numbers(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return n and m and 7


def truth_of_numbers(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    if x and not n:
        return 1
    return 2 if n or y else 3


def int_and_float(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    count = 0
    if n < x:
        count += 1
    if n <= x:
        count += 2
    if x == n:
        count += 4
    if x != n:
        count += 8
    if x > n:
        count += 16
    if y >= m:
        count += 32
    if n > 2.5:
        count += 64
    return count


def members(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    count = 0
    if n in (Mode.ON, Mode.HALF, m):
        count += 1
    if m not in TABLE:
        count += 2
    if n in MODES:
        count += 4
    if n in (3,):
        count += 8
    return count


def choice(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return x if p else y if q else -x


def choice_of_ints(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return n if x < y else Mode.HALF


def comparing_bools(x: float, y: float, n: int, m: int, p: bool, q: bool) -> bool:
    return p == q or p < q or (p != (n > 0))


# ---- variables and control


def rebinding(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    x = x + 1.0
    x *= y
    if p:
        x -= 2.0
        z = x
    else:
        z = y
    for _ in range(3):
        z = z + x
    return z


def swapping(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    x, y = y, x
    x, y, z = y, x + y, x - y
    return x + 2.0 * y + 3.0 * z


def early(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    if p:
        return 1
    elif q:
        if x > 0.0:
            return 2
    else:
        n = 5
    return n % 7


def ranges(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    total = 0
    for i in range(5):
        total += i * i
    for i in range(2, 8, 3):
        total += i
    for i in range(9, n % 5, -2):
        total = total * 3 + i
    for i in range(n % 4, m % 6):
        total -= i
    return total


def last_of_range(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    i = -1
    for i in range(n % 4):
        pass
    return i


def bound_in_a_loop(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    for place in PLACES:
        last = place.x
        if last > x:
            break
    for i in range(TWO):
        y = y + i
        half = 0.5 * y
    return last + half


def changing_counter(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    total = 0
    for i in range(4):
        total += i
        i = i * 10
        total += i
    return total


def changing_end(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    end = n % 5
    count = 0
    for _ in range(end):
        end = end + 3
        count += 1
    return count * 100 + end


def leaving(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    found = -1
    for i in range(10):
        if i == n % 4:
            continue
        if i > m % 6:
            break
        found = i
    return found


def while_loop(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    a, b = n % 50, m % 20 + 1
    while b != 0:
        a, b = b, a % b
    count = 0
    while count < 3 and a > count:
        count += 1
    return a * 10 + count


def while_with_choice(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    count = 0
    while (count if p else count * 2) < min(n % 7, 9) and _is_small(Point(float(count), 1.0)):
        count += 1
    return count


def _is_small(point: Point) -> bool:
    return point.x < 4.0


def matching(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    match n:
        case Mode.ON:
            return 10
        case Mode.HALF | 7:
            result = 20
        case -2:
            result = 30
        case _:
            result = 40
    match m % 3:
        case 0:
            result += 1
        case 1 if p:
            result += 2
    return result


def matching_in_loop(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    total = 0
    for i in range(6):
        match i:
            case 4:
                break
            case 1 | 2:
                continue
        total += i
    return total


# ---- NamedTuples


def fields(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    point = Point(x, y)
    other = Point(y=2.0)
    return point.x - point.y * other.y + Point(x=y).y + Point().x


def methods(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    point = Point(x, y).times(2.0)
    return point.times(0.5, more=y).sum - point.sum


def replaced(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Point:
    point = Point(x, y)
    other = point._replace(x=point.y, y=point.x)
    point = point._replace(y=point.x + 1.0, x=point.y)
    return other if p else point._replace(x=other.x)


def replaced_deep(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Big:
    big = START
    big = big._replace(at=big.at._replace(x=x), mode=n, row=big.row[1:] + (y,))
    if p:
        big = big._replace(at=Point(big.at.y, big.at.x), default=big.at.x)
    return big._replace(flags=Flags(low=q), default=big.default + 1.0)


def replaced_argument(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Big:
    big = Big(Point(x, y))
    return _changed(_unconditional(big, x), y, p)


def _changed(big: Big, value: float, really: bool) -> Big:
    if really:
        big = big._replace(default=value)
    return big._replace(mode=Mode.BACK)


def _unconditional(big: Big, value: float) -> Big:
    before = big.default
    big = Big(Point(value, before), default=value)
    if value > 0.0:
        big = big._replace(counts=(4, 5, 6))
    return big


def returned_early(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Big:
    state = START
    if p:
        return state
    state = state._replace(default=x)
    return state


def own_result(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Big:
    state = _changed(START, x, True)
    state = _changed(state, y, p)
    for _ in range(2):
        state = _turned(state)
    return state


def _turned(big: Big) -> Big:
    return Big(big.points[1], big.row[::-1], big.mode, big.flags, big.at.x, big.counts, (big.at, big.points[0]))


def several_results(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Big:
    big, count, number = _several(START, n, x)
    big, again, number = _several(big, count, number + y)
    left, (_, right) = _nested(number)
    return big._replace(mode=again, at=Point(left, right))


def _several(big: Big, n: int, x: float) -> tuple[Big, int, float]:
    if n > 3:
        return big, 0, x
    return big._replace(default=x), n + 1, big.default


def _nested(x: float) -> tuple[float, tuple[int, float]]:
    return x, (3, x * 2.0)


def passing_on(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    big, count, number = _passing(n, x)
    return big.default + count + number


def _passing(n: int, x: float) -> tuple[Big, int, float]:
    return _several(START, n, x)


def chosen_struct(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    point = PLACES[0] if p else PLACES[1]
    other = point if q else Point(x, y)
    return _length(other if x > y else point) + _either(p, x).y + (START if p else Big()).default


def _either(first: bool, x: float) -> Point:
    return Point(x, 3.0) if first else PLACES[1]


def _length(point: Point) -> float:
    return point.x * point.x + point.y * point.y


def flags(x: float, y: float, n: int, m: int, p: bool, q: bool) -> bool:
    guards = Flags(low=x < 1.0, high=y > 2.0, both=p and q)
    guards = guards._replace(both=guards.low and guards.high)
    return guards.both or guards[0]


def unpacking(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    a, b = Point(x, y)
    c, d, e = START.counts
    return a - b + c + d * e


def indexed_fields(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    three = Three(x, y, 1.5)
    total = 0.0
    for i in range(3):
        total = total * 0.5 + three[i]
    return total + three[-1] + EMPTY_BOX[n % 2]


# ---- tuples


def items(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    row = (x, y, 3.0)
    return row[0] - row[-1] * row[1] + row[n % 3] + (1.0, x)[p + 0] + DEEP[1][n % 2] + len(row)


def out_of_range(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    row = (x, y, 3.0)
    return row[n] + TABLE[m]


def clamped_index(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    return TABLE[min(max(n, 0), len(TABLE) - 1)] + TABLE[-1 - m % 3]


def slices(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    row = (x, y, 3.0, 4.0)
    a = row[1:]
    b = row[:-1] + (x,)
    c = row[::2]
    line = row
    for _ in range(n % 3):
        line = line[1:] + (line[0],)
    return a[0] - b[3] * c[1] + line[1] + row[1:3][0]


def repeated(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    row = (x,) * 4
    pairs = (y, 2.0) * TWO
    return row[3] - pairs[2] + len(pairs)


def tables(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    for source, guard, target in ROWS:
        if source == n and guard != m:
            return target
    return -1


def loops(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    total = 0.0
    for value in (x, y, 1.5):
        total = total * 0.5 + value
    for point in PLACES:
        total += point.x * point.y
    for number, value in enumerate(TABLE, start=2):
        total += number * value
    for a, (b, c) in zip((x, y), DEEP, strict=True):
        total = total + a * b - c
    for number, point in enumerate(START.points):
        total -= point.y * number
    return total


def loop_over_changing(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    row = (x, y, 1.0)
    total = 0.0
    for value in row:
        row = (value, total, row[0])
        total = total + value * row[2]
    return total + row[1]


def last_item(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    best = PLACES[0]
    for place in PLACES:
        if place.x < x:
            best = place
    return best.x + best.y


def mapped(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Big:
    row = tuple(value * x for value in START.row)
    points = tuple(Point(point.y, y) for point in START.points)
    counts = tuple(i * n % 9 for i in range(3))
    return Big(row=tuple(min(a, b) for a, b in zip(row, START.row, strict=True)), points=points, counts=counts)  # type: ignore[arg-type]


def names_of_generators(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    values = tuple(value * y for value in _shifted((x, y, 1.0)))
    a = values
    return min(a * 2.0 for a in a) + _total(values)


def _shifted(values: tuple[float, ...]) -> tuple[float, ...]:
    values = values[1:] + (0.5,)
    return tuple(max(values, 0.25) for values in values)


def reductions(x: float, y: float, n: int, m: int, p: bool, q: bool) -> int:
    count = sum(1 for value in START.row if value < x)
    if any(value > y for value in (x, 1.0, 2.0)):
        count += 10
    if all(i < n for i in range(2, 5)):
        count += 100
    return count + sum(number * number for number in TABLE) + max(i * n % 7 for i in range(1, 9, 2))


def extremes_of_loop(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return min(value * y for value in (x, 2.0, 3.0)) + max(abs(value) for value in (x, y))


def short_circuit(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    if p and _far(Big(Point(x, y))) > 1.0 or q and any(value > x for value in START.row):
        return 1.0
    return _far(Big(Point(y, x))) if n > 0 and m > 0 else -1.0


def _far(big: Big) -> float:
    return big.at.x + big.row[0]


def lengths(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return _total((x, y)) + _total(START.row) + _head(START.row, x)[0] + _total(_head((x, y, 2.0), y))


def _total(values: tuple[float, ...]) -> float:
    total = 0.0
    for index in range(len(values)):
        total = total + values[index] * (index + 1)
    return total


def _head(values: tuple[float, ...], new: float) -> tuple[float, ...]:
    return (new,) + values[:-1]


def defaults(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    return _with_defaults(x) + _with_defaults(x, mode=Mode.ON, by=y) + _with_defaults(y, 3.0, START)


def _with_defaults(x: float, by: float = 0.5, big: Big = Big(), *, mode: int = Mode.BACK) -> float:
    return x * by + big.at.y + mode


def same_names(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    double = x
    int64_t = y
    cos = math.cos(1.0)
    total = 0.0
    for index in range(2):
        value = double * index
        total += value
    for index in range(3):
        value = int64_t - index
        total -= value
    return total + cos + math.sin(cos if abs(cos) < 2.0 else 0.0)


class Pair(NamedTuple):
    """Large structs within one."""

    one: Big = Big()
    two: Big = Big(default=3.0)
    count: int = 0  # type: ignore[assignment]  # tuples have a method count


def changed_within(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Pair:
    pair = _crossed(Pair(Big(Point(x, y)), count=n), x)
    kept = pair
    pair = _crossed(pair, kept.two.default)
    pair = pair._replace(one=_marked(pair.one, pair.two.at, y), two=_marked(pair.two, pair.one.at, x))
    return pair if p else kept


def _crossed(pair: Pair, x: float) -> Pair:
    return Pair(pair.two, pair.one, pair.count + 1) if x > 0.0 else pair._replace(two=pair.one)


def _marked(big: Big, at: Point, value: float) -> Big:
    row = big.row
    return big._replace(at=Point(big.at.y, at.x), row=row[1:] + (big.at.x + value,), default=at.y)


def kept_from_argument(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Big:
    return _made_anew(_made_anew(Big(Point(x, y), default=y), x, p), y, q)


def _made_anew(big: Big, value: float, back: bool) -> Big:
    if back:
        return big
    made = Big(default=value, points=(big.at, big.points[0]))
    return made._replace(at=big.at, default=big.default)


def changed_by_itself(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Big:
    big = Big(Point(x, y), default=y)
    big = _marked(big, big.at, big.default)
    big = _mixed_with(big, big.points[1], big)
    big = _marked(_marked(big, big.at, x), big.points[0], y)
    return _mixed_with(START, big.at, big) if p else big


def _mixed_with(big: Big, at: Point, other: Big) -> Big:
    if at.x > 1.0:
        return _marked(big, at, other.default)
    if at.x < 0.0:
        return big
    return other


def borrowed(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Pair:
    pair = Pair(Big(Point(x, y)), count=n)
    first, _ = _advanced(pair, n, p)
    second, number = _advanced(first, m, q)
    return second._replace(count=int(number) if abs(number) < 1e6 else first.count)


def _advanced(pair: Pair, rounds: int, back: bool) -> tuple[Pair, float]:
    one = pair.one
    two = pair.two
    before = two.default
    for k in range(rounds % 3):
        one = _marked(one, two.at, k * before)
        if back:
            two = two._replace(default=one.at.x, at=one.points[0])
    pair = Pair(one, count=pair.count + 1, two=two)
    return pair, pair.two.at.x + one.at.y + before


def not_borrowed(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Pair:
    return _taken_out(_taken_out(Pair(Big(Point(x, y)), count=n), p), q)


def _taken_out(pair: Pair, back: bool) -> Pair:
    one = pair.one
    one = _marked(one, pair.two.at, 1.0)
    if back:
        return pair._replace(count=pair.count + 1)
    two = pair.two
    two = two._replace(default=pair.one.at.x)
    pair = Pair(two, one)
    two = two._replace(default=0.5)
    return pair._replace(count=round(two.default))


def results_after(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Big:
    big, row, at = _turned_out(Big(Point(x, y)), n)
    big, row, at = _turned_out(big, row[0] > 0.0)
    row, big = _the_other_way(big)
    return big._replace(row=row, at=at)


def _turned_out(big: Big, n: int) -> tuple[Big, tuple[float, float, float, float, float], Point]:
    if n == 1:
        return _turned_out_again(big)
    return big._replace(row=big.row[::-1], at=Point(big.at.y, big.default)), big.row, big.at  # type: ignore[return-value]


def _turned_out_again(big: Big) -> tuple[Big, tuple[float, float, float, float, float], Point]:
    return _marked(big, big.points[1], big.at.x), big.row, big.at  # type: ignore[return-value]


def _the_other_way(big: Big) -> tuple[tuple[float, float, float, float, float], Big]:
    return big.row, big._replace(row=big.row[::-1], default=big.row[0])  # type: ignore[return-value]


def items_of_fields(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Big:
    big = _with_points(Big(Point(x, y), points=(Point(y, x), Point(x, x))), p)
    at = min(max(n, 0), 4)
    kept = big
    big = big._replace(row=big.row[:at] + (x + big.row[0],) + big.row[at + 1 :], default=big.row[at])
    row = big.row[:at] + (kept.row[at] + y,) + big.row[at + 1 :]
    big = big._replace(row=row, counts=kept.counts) if q else kept._replace(at=big.points[1])
    other = kept._replace(row=big.row[:at] + (y,) + big.row[at + 1 :])
    return _with_points(big._replace(default=other.row[0] + other.row[at]), q)


def _with_points(big: Big, swap: bool) -> Big:
    for index in range(2):
        at = 1 - index if swap else index
        nearest = min(max(at, 0), 1)
        point = Point(big.points[0].y, big.points[nearest].x)
        big = big._replace(points=big.points[:nearest] + (point,) + big.points[nearest + 1 :], at=big.points[index])
    return big


def pointed_at(x: float, y: float, n: int, m: int, p: bool, q: bool) -> Big:
    return _pointing(_pointing(Big(Point(x, y), points=(Point(y, x), Point(x, x))), p), q)


def _pointing(big: Big, swap: bool) -> Big:
    at = big.at
    first = big.points[0]
    other = first if swap else big.points[1]
    for point in big.points:
        if point.x > 2.0:
            return big._replace(points=(point, at), at=first)
    return Big(other, big.row, big.mode, Flags(at.x > first.x, first.y > at.x), at.y, big.counts, (at, first))


def bound_first_in_elifs(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    if p:
        r = x
    elif q:
        if x > 0.0:
            a = 1.0
        else:
            a = 2.0
        r = a
    else:
        if x > 1.0:
            a = 3.0
        else:
            a = 4.0
        r = a + y
    return r


def bound_in_each_branch(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    if p:
        a = 1.0
    elif q:
        a = 2.0
    else:
        a = y
    return a + x


def bound_in_some_elifs(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    r = 0.0
    if p:
        r = x
    elif q:
        a = 2.0
        r = a
    elif n > 2:
        a = 4.0
        r = a + y
    elif m > 2:
        for k in range(3):
            b = k * x
            r += b
    else:
        if y > 0.0:
            b = 1.0
        else:
            b = y
        r = b
    return r


def bound_in_cases(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    match n:
        case 0:
            if p:
                a = 1.0
            else:
                a = x
            r = a
        case 3 if q:
            a = y
            r = a * 2.0
        case 5 | 7:
            r = x
        case _:
            if q:
                a = 1.5
            else:
                a = y
            r = a
    return r
