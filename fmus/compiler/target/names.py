"""Names in C: as in Python, unless C or another file has taken them."""

import re
from collections.abc import Iterable


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


KEYWORDS = _words(
    "auto break case char const continue default do double else enum extern float for goto if inline int long register "
    "restrict return short signed sizeof static struct switch typedef union unsigned void volatile while "
    "int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t intptr_t uintptr_t intmax_t uintmax_t size_t "
    "_Bool _Complex _Imaginary asm typeof bool true false "
    "alignas alignof and and_eq bitand bitor catch class compl constexpr const_cast decltype delete dynamic_cast "
    "explicit export friend mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected "
    "public reinterpret_cast static_assert static_cast template this thread_local throw try typeid typename using "
    "virtual wchar_t xor xor_eq"
)
"""Of C99 and of C++: the header is for both."""
MACROS = _words(
    "NAN INFINITY HUGE_VAL HUGE_VALF HUGE_VALL FP_INFINITE FP_NAN FP_NORMAL FP_SUBNORMAL FP_ZERO FP_ILOGB0 "
    "FP_ILOGBNAN FP_FAST_FMA MATH_ERRNO MATH_ERREXCEPT math_errhandling fpclassify isfinite isinf isnan isnormal "
    "signbit isgreater isgreaterequal isless islessequal islessgreater isunordered INT64_MAX INT64_MIN INT64_C "
    "UINT64_C DOMAIN OVERFLOW UNDERFLOW SING PLOSS TLOSS M_PI M_E NULL"
)
FUNCTIONS = _words(
    "acos asin atan atan2 cos sin tan acosh asinh atanh cosh sinh tanh exp exp2 expm1 frexp ilogb ldexp log log10 "
    "log1p log2 logb modf scalbn scalbln cbrt fabs hypot pow sqrt erf erfc lgamma tgamma ceil floor nearbyint rint "
    "lrint llrint round lround llround trunc fmod remainder remquo copysign nan nextafter nexttoward fdim fmax fmin "
    "fma j0 j1 jn y0 y1 yn gamma main abs labs llabs exit index printf memcpy memset malloc free signal drem "
    "significand scalb finite"
)
"""Of the C library: a function of a model may not have their names, a variable only if it is not needed there."""


def plain_name(name: str) -> str:
    """Return a Python name with letters that C has, not beginning as names of the C library do."""
    ascii_only = "".join(c if c.isascii() else f"u{ord(c):04x}" for c in name)
    return ascii_only.lstrip("_") or "unnamed"


def member_name(field: str) -> str:
    """Return the name of a struct member for a field of a NamedTuple."""
    name = plain_name(field)
    return f"{name}_" if name in KEYWORDS or name in MACROS else name


class FileNames:
    """The names of one C file at its outermost level: types, functions, constants."""

    def __init__(self, reserved: Iterable[str]) -> None:
        self.taken = set(reserved) | KEYWORDS | MACROS | FUNCTIONS

    def add(self, name: str, module: str) -> str:
        """Return a free name: its own, else with the name of its file behind, else with more of its path."""
        own = plain_name(name)
        places = module.split(".")
        tries = [own] + ["_".join([own, *places[-count:]]) for count in range(1, len(places) + 1)]
        number = 2
        for found in tries:
            if found not in self.taken:
                self.taken.add(found)
                return found
        while f"{own}_{number}" in self.taken:
            number += 1
        self.taken.add(f"{own}_{number}")
        return f"{own}_{number}"


class LocalNames:
    """The names inside one C function."""

    def __init__(self, avoid: Iterable[str]) -> None:
        self.taken = set(avoid) | KEYWORDS | MACROS

    def add(self, name: str) -> str:
        """Return a free name: its own, else with an underscore behind, else with a number."""
        own = re.sub(r"[^A-Za-z0-9_]", "_", plain_name(name))
        found = own if own not in self.taken else f"{own}_"
        number = 2
        while found in self.taken:
            found = f"{own}{number}"
            number += 1
        self.taken.add(found)
        return found
