"""Model code that the translator refuses: what is wrong, on which line, what is said of it."""

# ruff: noqa: E501

HEAD = '''\
"""A model with something wrong in it."""

import enum
import math
import random
from collections import namedtuple
from enum import IntEnum
from typing import Annotated, Any, NamedTuple

import numpy as np


class Mode(IntEnum):
    OFF = 0
    ON = 1


class Point(NamedTuple):
    x: float = 0.0
    y: float = 0.0


class Row(NamedTuple):
    values: tuple[float, ...] = (0.0,) * 3
    mode: int = 0


ROW = (1.0, 2.0, 3.0)
NAMES = ("a", "b")
LIST = [1.0, 2.0]
COUNT = 3


def half(x: float) -> float:
    return 0.5 * x


def pair(x: float) -> tuple[float, int]:
    return x, 1


def total(values: tuple[float, ...]) -> float:
    return values[0]


'''
FRAME = """

class In(NamedTuple):
    x: float = 0.0
    n: int = 0


class Out(NamedTuple):
    y: float = 0.0


class Nothing(NamedTuple):
    unused: float = 0.0


def initialize(params: Nothing) -> tuple[Nothing, Out]:
    return Nothing(), Out()


def step(state: Nothing, inputs: In, params: Nothing, dt_ns: int) -> tuple[Nothing, Out]:
    return state, Out(f(inputs.x, inputs.n))
"""
WHOLE = "def f(x: float, n: int) -> float:\n"
# What stands in the function (with the line that is at fault marked) -> what is said of it.
BODIES = {
    "list": ("y = [x, x]  # !\nreturn x", "a list", "write a tuple"),
    "list comprehension": ("return max([x * k for k in ROW])  # !", "a list comprehension", "tuple(f(x) for x in xs)"),
    "dict": ("y = {1: x}  # !\nreturn x", "a dict", "NamedTuple"),
    "set": ("y = {x, 1.0}  # !\nreturn x", "a set", "x in (A, B)"),
    "string": ('y = "on"  # !\nreturn x', "a string", "IntEnum"),
    "f-string": ('y = f"{x}"  # !\nreturn x', "an f-string", "IntEnum"),
    "string compared": ('return 1.0 if NAMES[0] == "a" else x  # !', "a string", "IntEnum"),
    "list of the module": ("return LIST[0]  # !", "a list", "tuple"),
    "lambda": ("g = lambda a: a  # !\nreturn x", "a lambda", "def at the top"),
    "None": ("y = None  # !\nreturn x", "None", "bool beside it"),
    "try": ("try:  # !\n    return 1.0 / x\nexcept ZeroDivisionError:\n    return 0.0", "try", "test beforehand"),
    "raise": ("if x < 0.0:\n    raise ValueError  # !\nreturn x", "raise", "status"),
    "assert": ("assert x > 0.0  # !\nreturn x", "assert", "status"),
    "with": ("with open(x) as g:  # !\n    pass\nreturn x", "with", "outside of the model"),
    "global": ("global COUNT  # !\nreturn x", "global", "argument"),
    "nested function": ("def g(a: float) -> float:  # !\n    return a\nreturn x", "function inside", "top of the module"),
    "class inside": ("class G(NamedTuple):  # !\n    a: float\nreturn x", "class inside", "top of the module"),
    "import inside": ("import math  # !\nreturn x", "import inside", "top of the module"),
    "del": ("y = x\ndel y  # !\nreturn x", "del", "leave it out"),
    "yield": ("yield x  # !\nreturn x", "yield", "tuple of fixed length"),
    "walrus": ("return (y := x) + 1.0  # !", ":=", "line of its own"),
    "power": ("return x ** 2  # !", "**", "x * x"),
    "matrix product": ("return x @ x  # !", "@", "x * x"),
    "remainder of floats": ("return x % 2.0  # !", "% of floats", "math.floor(a / b)"),
    "floor division of floats": ("return x // 2.0  # !", "// of floats", "math.floor(a / b)"),
    "pow": ("return pow(x, 2.0)  # !", "pow()", "x * x"),
    "hypot": ("return math.hypot(x, x)  # !", "math.hypot()", "math.sqrt(x * x + y * y)"),
    "gamma": ("return math.gamma(x)  # !", "math.gamma()", "functions that C has"),
    "sum of floats": ("return sum(k * x for k in ROW)  # !", "sum() of floats", "loop that adds"),
    "print": ("print(x)  # !\nreturn x", "print()", "outputs"),
    "isinstance": ("return 1.0 if isinstance(x, float) else x  # !", "isinstance()", "annotate"),
    "sorted": ("return sorted(ROW)[0]  # !", "sorted()", "one by one"),
    "random": ("return random.random()  # !", "random", "functions of the model"),
    "numpy": ("return np.sin(x)  # !", "of numpy", "use math"),
    "Any": ("return Any(x)  # !", "a call of Any", "only NamedTuples"),
    "unknown name": ("return y + x  # !", "y is not known", "define it"),
    "unknown field": ("return Point(x, x).z  # !", "Point has no field z", "it has x, y"),
    "unknown method": ("return Point(x, x).norm()  # !", "Point has no method norm", "fields x, y"),
    "field of a float": ("return x.real  # !", ".real of float", "only NamedTuples"),
    "unknown of an enum": ("return 1.0 if n == Mode.AUTO else x  # !", "Mode.AUTO is not known", "no AUTO"),
    "enum made": ("return 1.0 if Mode(n) == Mode.ON else x  # !", "a call of Mode", "the int itself"),
    "is": ("return 1.0 if n is 1 else x  # !", "'is'", "=="),
    "is not": ("return 1.0 if x is not None else x  # !", "None", "bool beside it"),
    "tuples compared": ("return 1.0 if Point(x, x) == Point() else x  # !", "comparison of Point", "compare the fields"),
    "in floats": ("return 1.0 if x in ROW else x  # !", "'in' of float", "=="),
    "truth of a tuple": ("return 1.0 if ROW else x  # !", "the truth of a tuple", "comparison"),
    "and of unequal kinds": ("return (x and n) * 1.0  # !", "'and' between float and int", "a if c else b"),
    "choice of unequal kinds": ("return 2.0 * (x if n else 1)  # !", "float or int, by a condition", "1.0, not 1"),
    "min of unequal kinds": ("return 1.0 * min(x, 1)  # !", "min() of float and int", "float(n)"),
    "min with key": ("return min(x, 1.0, key=half)  # !", "min() with key", "one by one"),
    "int for float": ("return half(2)  # !", "int where half() takes float", "write 2.0"),
    "int expression for float": ("return half(n)  # !", "int where half() takes float", "float(...)"),
    "float for int": ("for _ in range(x):  # !\n    pass\nreturn x", "range() of float", "int(x)"),
    "float for bool": ("return half(x) if Row(mode=x > 1.0).mode else Row(mode=x).values[0]  # !", "float where Row.mode", "int(...)"),
    "int returned": ("return n  # !", "int where f() returns float", "float(...)"),
    "whole number returned": ("if n:\n    return 0  # !\nreturn x", "int where f() returns float", "write 0.0"),
    "variable changes type": ("y = 0\ny = y + x  # !\nreturn y * 1.0", "float where y is int before", "int(...)"),
    "variable changes from float": ("y = x\ny = 1  # !\nreturn y", "int where y is float before", "write 1.0"),
    "declared otherwise": ("y: int = x  # !\nreturn x", "float where y is declared int", "int(...)"),
    "declared without a value": ("y: float  # !\ny = x\nreturn y", "a type without a value", "where it gets its value"),
    "use before assignment": ("if n:\n    y = x\nreturn y  # !", "y may not be bound", "give it a value"),
    "use after a loop": ("for k in range(n):\n    y = x\nreturn y  # !", "y may not be bound", "give it a value"),
    "missing return": ("if n:  # !\n    return x", "without a return", "every way"),
    "never reached": ("return x\nx = 1.0  # !", "never reached", "remove it"),
    "return of nothing": ("return  # !", "a return without a value", "annotated type"),
    "value not used": ("half(x)  # !\nreturn x", "is not used", "bind it"),
    "several targets": ("y = z = x  # !\nreturn y", "several names", "one line for each"),
    "item changed": ("xs = (x, x)\nxs[0] = 1.0  # !\nreturn x", "a change of xs[0]", "_replace"),
    "field changed": ("point = Point(x, x)\npoint.x = 1.0  # !\nreturn x", "a change of point.x", "_replace"),
    "field added to": ("point = Point(x, x)\npoint.x += 1.0  # !\nreturn x", "a change of point.x", "_replace"),
    "star on the left": ("y, *z = (x, x, x)  # !\nreturn y", "a star", "name each item"),
    "star in a call": ("return half(*ROW)  # !", "* or **", "write the arguments out"),
    "star in a tuple": ("return (*ROW, x)[0]  # !", "a star", "join tuples with +"),
    "too few names": ("y, z, w = pair(x)  # !\nreturn y", "3 names for 2 items", "one name for each"),
    "too many arguments": ("return half(x, x)  # !", "half() with 2 arguments", "it takes x"),
    "missing argument": ("return half()  # !", "without its argument x", "it takes x"),
    "unknown argument": ("return half(z=x)  # !", "half() has no z", "it takes x"),
    "argument twice": ("return half(x, x=x)  # !", "two values for x", "write one"),
    "missing of a tuple": ("return Point(x, z=x).x  # !", "Point() has no z", "it takes x, y"),
    "replaced by place": ("return Point()._replace(x).x  # !", "no name", "_replace(field=value)"),
    "replaced what is not there": ("return Point()._replace(z=x).x  # !", "no field z", "it has x, y"),
    "index out of range": ("return ROW[3]  # !", "index 3 of 3 items", "0 to 2"),
    "index far out": ("return ROW[-4]  # !", "index -4 of 3 items", "0 to 2"),
    "index of a loop out of range": ("for k in range(3, 5):\n    x = x + ROW[k]  # !\nreturn x", "out of range: there are 3 items", "bounds"),
    "index by float": ("return ROW[x]  # !", "an index into a tuple of 3 float that is float", "int(...)"),
    "index that varies": ("return 1.0 * pair(x)[n]  # !", "index that varies", "write the number"),
    "slice that varies": ("return ROW[n:][0]  # !", "ends that vary", "whole numbers"),
    "empty tuple": ("y = ()  # !\nreturn x", "an empty tuple", "leave it out"),
    "tuple of unknown length": ("return total(tuple(x for _ in range(n)))  # !", "unknown length", "constants"),
    "tuple by condition": ("return total(tuple(k for k in ROW if k > x))  # !", "a condition decides", "bool for each"),
    "tuple repeated": ("return total((x,) * n)  # !", "unknown number of times", "constant"),
    "generator by itself": ("y = (k for k in ROW)  # !\nreturn x", "a generator by itself", "tuple()"),
    "generator twice": ("return total(tuple(j * k for j in ROW for k in ROW))  # !", "two loops", "for loops"),
    "zip of unequal": ("for j, k in zip(ROW, (1.0, 2.0)):  # !\n    x += j * k\nreturn x", "2 and 3 items", "equally long"),
    "loop over a number": ("for k in n:  # !\n    x += 1.0\nreturn x", "a loop over int", "range"),
    "loop over a NamedTuple": ("for k in Point():  # !\n    x += k\nreturn x", "a loop over Point", "tuple"),
    "step that varies": ("for k in range(0, 9, n):  # !\n    x += 1.0\nreturn x", "step that varies", "number"),
    "else of a loop": ("for k in ROW:\n    x += k\nelse:\n    x = 0.0  # !\nreturn x", "else after a loop", "bool"),
    "loop without an end": ("while True:  # !\n    x += 1.0\nreturn x", "without an end", "range(N)"),
    "match of a float": ("match x:  # !\n    case 1.0:\n        return x\nreturn x", "match of float", "if and elif"),
    "case that binds": ("match n:\n    case k:  # !\n        return x", "the case k", "enum members"),
    "case of a string": ('match n:\n    case "a":  # !\n        return x\nreturn x', "a string", "IntEnum"),
    "case twice": ("match n:\n    case 1:\n        x = 1.0\n    case Mode.ON:  # !\n        x = 2.0\nreturn x", "second time", "remove it"),
    "replaced in a number": ("y = x\ny = y._replace(x=1.0)  # !\nreturn y", "._replace() of float", "function"),
    "repeated too often": ("return total((x,) * 1000000)  # !", "repeated 1000000 times", "10000 times at most"),
    "method of the class": ("return Point._replace(x=x).x  # !", "Point._replace() is not known", "no _replace"),
    "too large": ("return x + 9223372036854775808  # !", "9223372036854775808", "64 bits"),
    "too large a product": ("return x + 9999999999 * 9999999999  # !", "99999999980000000001", "64 bits"),
    "shift too far": ("return 1.0 * (n << 64)  # !", "a shift by 64 bits", "0 to 63"),
    "division by 0": ("return 1.0 * (n // 0)  # !", "// by 0", "something else"),
    "inverted truth": ("return 1.0 * ~(n > 1)  # !", "~ of bool", "'not'"),
    "inverted float": ("return 1.0 * ~x  # !", "~ of float", "not"),
    "shifted float": ("return 1.0 * (x << 1)  # !", "<< of floats", "int(...)"),
    "function as a value": ("g = half  # !\nreturn x", "the function or class half", "call it"),
    "class as a value": ("g = Point  # !\nreturn x", "the function or class Point", "call it"),
    "call of a call": ("return half(x)(x)  # !", "a call of half(x)", "by its name"),
    "recursion": ("return f(x, n)  # !", "recursion", "loop with a fixed number"),
    "float of a string": ('return float("nan")  # !', "float() of a string", "math.nan"),
    "round to decimals": ("return round(x, 2)  # !", "round() to decimals", "math.floor"),
    "complex": ("return abs(1j) * x  # !", "the constant 1j", "float"),
    "dunder": ("return x.__add__(x)  # !", ".__add__() of float", "function"),
    "arithmetic with a tuple": ("return Point() + x  # !", "arithmetic with Point", "name the field"),
    "tuple added": ("return (ROW + (n,))[0]  # !", "joined to", "one kind"),
    "named tuple where a number is": ("return math.sin(Point())  # !", "Point where a number", "name the field"),
    "math with two": ("return math.sin(x, x)  # !", "math.sin() with these arguments", "give it 1"),
    "enum's name": ("return x + n.value  # !", ".value of an integer variable", "leave .value out"),
}  # fmt: skip
# Whole definitions, before f.
MODULES = {
    "untyped argument": ("def g(x) -> float:  # !\n    return x\n", "g(x)", "takes x without a type", "x: float"),
    "no result type": ("def g(x: float):  # !\n    return x\n", "g(x)", "no result type", "-> float"),
    "star arguments": ("def g(*xs: float) -> float:  # !\n    return 1.0\n", "g(x)", "* or ** arguments", "name each"),
    "default of a float": ("def g(x: float = 0) -> float:  # !\n    return x\n", "g()", "by default the int 0", "0.0"),
    "mutable default": ("def g(x: float, y: list = []) -> float:  # !\n    return x\n", "g(x)", "a list", "tuple[X, ...]"),
    "string argument": ("def g(x: float, y: str) -> float:  # !\n    return x\n", "g(x, x)", "a string", "IntEnum"),
    "optional": ("def g(x: float | None) -> float:  # !\n    return 1.0\n", "g(x)", "float | None", "a bool beside it"),
    "Any": ("def g(x: Any) -> float:  # !\n    return 1.0\n", "g(x)", "Any", "write float, int, bool"),
    "object": ("def g(x: object) -> float:  # !\n    return 1.0\n", "g(x)", "the type object", "float, int, bool"),
    "bare tuple": ("def g(x: tuple) -> float:  # !\n    return 1.0\n", "g(ROW)", "unknown items", "tuple[X, ...]"),
    "returns None": ("def g(x: float) -> None:  # !\n    pass\n", "g(x)", "None", "one type"),
    "unknown type": ('def g(x: "Wheel") -> float:  # !\n    return 1.0\n', "g(x)", "cannot be read", "knows"),
    "class field a list": ("class G(NamedTuple):\n    a: list = []  # ?\n", "G().a[0]  # !", "G.a is a list", "tuple"),
    "class float of int": ("class G(NamedTuple):\n    a: float = 0  # !\n", "G().a", "its default the int 0", "0.0"),
    "class bool of int": ("class G(NamedTuple):\n    a: bool = 0  # !\n", "1.0 * G().a", "no bool", "that is bool"),
    "class of unknown length": (
        "class G(NamedTuple):\n    a: tuple[float, ...]\n", "G(ROW).a[0]  # !", "unknown length", "default",
    ),
    "namedtuple": ('G = namedtuple("G", "a")\n', "G(x).a  # !", "G", "class G(NamedTuple)"),
    "mutual recursion": (
        "def g(x: float) -> float:\n    return h(x)\n\n\ndef h(x: float) -> float:\n    return g(x)  # !\n",
        "g(x)", "recursion: g()", "loop",
    ),
    "wrong length": (
        "def g(a: tuple[float, float]) -> float:\n    return a[0]\n", "g(ROW)  # !", "a tuple of 3 float", "as long as",
    ),
}  # fmt: skip
