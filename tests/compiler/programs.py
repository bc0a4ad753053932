"""Hypothesis writes functions of the model language: well typed, of bounded integers, all nested in all."""

from collections.abc import Callable
from typing import Any

from hypothesis import strategies as st

HEAD = '''\
class Mode(IntEnum):
    """A mode."""

    LOW = -1
    OFF = 0
    ON = 1
    HIGH = 40


class Point(NamedTuple):
    """A point."""

    x: float = 0.5
    y: float = -0.0

    def turned(self, by: float) -> "Point":
        """Return another point."""
        return Point(self.y, self.x * by)


class Car(NamedTuple):
    """Large enough to go by pointer."""

    at: Point = Point()
    row: tuple[float, ...] = (0.0, 1.0, 2.0)
    mode: int = Mode.ON
    ready: bool = True
    ends: tuple[Point, ...] = (Point(), Point(1.0, 2.0))
    speed: float = 1.5


class Fleet(NamedTuple):
    """Large structs within one."""

    first: Car = Car()
    second: Car = Car(mode=Mode.HIGH)
    lead: float = 2.0


ROW = (1.0, -2.5, 3.0)
COUNT = 3
CAR = Car(speed=-0.0)
'''
SIGNATURE = "x: float, y: float, n: int, m: int, p: bool, q: bool"
KINDS = ("float", "int", "bool", "Point", "Car", "Row")
ALL = (*KINDS, "Fleet")
RETURNED = ("float", "int", "bool", "Point", "Car")
FLOATS = ("0.0", "-0.0", "1.0", "0.1", "-2.5", "3.0", "1e300", "1e-310", "math.inf", "math.nan", "math.pi")
INTS = ("0", "1", "-1", "2", "3", "7", "-5", "100000", "Mode.HIGH", "Mode.LOW", "COUNT")


class Function:
    """One function in the writing."""

    def __init__(self, draw: Any, helpers: Any, name: Any) -> None:
        self.draw, self.helpers, self.name = draw, helpers, name
        self.lines: list[str] = []
        self.scope = {"float": ["x", "y"], "int": ["n", "m"], "bool": ["p", "q"], "Point": [], "Car": ["CAR"],
                      "Row": ["ROW"], "Fleet": []}  # fmt: skip
        self.fixed = {"CAR", "ROW"}
        self.count = 0

    def pick(self, options: Any) -> Any:
        return self.draw(st.sampled_from(options))

    def chance(self, one_in: Any) -> Any:
        return self.draw(st.integers(1, one_in)) == 1

    def new(self, kind: Any) -> Any:
        self.count += 1
        return f"{kind[0].lower()}{self.count}"

    # ---- expressions

    def expression(self, kind: Any, depth: Any) -> Any:
        """Return the text of an expression; deeper than ``depth`` there are names and numbers only."""
        if depth <= 0 or self.chance(5):
            return self.leaf(kind)
        made = self.pick(getattr(self, f"{kind.lower()}s"))
        return made(self, depth - 1)

    def leaf(self, kind: Any) -> Any:
        if self.scope[kind] and not self.chance(3):
            return self.pick(self.scope[kind])
        return {
            "float": lambda: self.pick(FLOATS),
            "int": lambda: self.pick(INTS),
            "bool": lambda: self.pick(("True", "False", "(COUNT == 3)")),
            "Point": lambda: self.pick(("Point()", "Point(1.0, 2.0)", "CAR.at")),
            "Car": lambda: self.pick(("CAR", "Car()")),
            "Row": lambda: self.pick(("ROW", "(0.25, -3.0, 0.5)")),
            "Fleet": lambda: self.pick(("Fleet()", "Fleet(lead=-0.0)")),
        }[kind]()

    def call(self, kind: Any, depth: Any) -> Any:
        found = [item for item in self.helpers if item[1] == kind]
        if not found:
            return self.leaf(kind)
        name, _, kinds = self.pick(found)
        return f"{name}({', '.join(self.expression(item, min(depth, 1)) for item in kinds)})"

    def choice(self, kind: Any, depth: Any) -> Any:
        test, first, other = (self.expression(item, depth) for item in ("bool", kind, kind))
        return f"({first} if {test} else {other})"

    def several(self, kind: Any, depth: Any, forms: Any) -> Any:
        """Return one of ``forms`` with expressions in place of {f}, {i} and so on."""
        text = self.pick(forms)
        letters = {"f": "float", "i": "int", "b": "bool", "p": "Point", "c": "Car", "r": "Row", "w": "Fleet"}
        for letter, inner in letters.items():
            while f"{{{letter}}}" in text:
                text = text.replace(f"{{{letter}}}", self.expression(inner, depth), 1)
        return text

    floats = (
        lambda self, depth: self.several("float", depth, (
            "({f} + {f})", "({f} - {f})", "({f} * {f})", "({f} / {f})", "({f} + {f} * {f} - {f})", "-{f}", "abs({f})",
            "({i} * {f})", "({f} - {i})", "({i} / 7)", "({i} / (abs({i}) + 1))", "float({i})", "float({b})",
        )),
        lambda self, depth: self.several("float", depth, (
            "min({f}, {f})", "max({f}, {f}, {f})", "math.sqrt(abs({f}))", "math.copysign({f}, {f})",
            "math.atan({f})", "math.floor({f}) * {f}", "({f} - math.ceil({f}))", "({f} + int({f}))", "({f} or {f})",
            "({f} and {f})", "float(round({f}))", "math.fabs({f})", "math.sin({f})", "math.atan2({f}, {f})",
        )),
        lambda self, depth: self.several("float", depth, (
            "{p}.x", "{c}.speed", "{c}.at.y", "{c}.row[1]", "{r}[0]", "{r}[-1]", "{r}[{i} % 3]", "{c}.ends[{i} % 2].x",
            "{c}.row[min(max({i}, 0), 2)]", "{p}[1]", "{p}.turned({f}).x", "({f}, {f}, {f})[{i} % 3]", "{r}[{c}.mode]",
            "max({f} * v for v in {r})", "min({r})", "({r} + ({f},))[{i} % 4]", "({r} * 2)[{i} % 6]",
        )),
        lambda self, depth: self.choice("float", depth),
        lambda self, depth: self.call("float", depth),
    )  # fmt: skip
    ints = (
        lambda self, depth: self.several("int", depth, (
            "(({i} + {i}) % 1000003)", "(({i} - {i}) % 1000)", "({i} * {i} % 4099)", "({i} // (abs({i}) % 9 + 1))",
            "({i} % -7)", "({i} // -3)", "({i} & 255)", "({i} & {i})", "(({i} | {i}) % 65536)", "(({i} ^ {i}) & 4095)",
            "({i} >> 2)", "(({i} & 1023) << 3)", "-({i} % 1000)", "~({i} % 50)",
            "({i} // ({c}.mode - 3))", "({i} % ({c}.mode + 2))",
        )),
        lambda self, depth: self.several("int", depth, (
            "abs({i})", "min({i}, {i})", "max({i}, {i}, 0)", "int({b})", "({b} + {b})", "{c}.mode", "len({r})",
            "int(min(max({f}, -1e6), 1e6))", "math.floor({f} * 0.0 + 2.5)", "round(max(min({f}, 9.5), -9.5))",
            "sum(1 for v in {r} if v < {f})", "sum({i} % 10 for _ in range(3))", "({i} or {i})", "({i} and {i})",
        )),
        lambda self, depth: self.choice("int", depth),
        lambda self, depth: self.call("int", depth),
    )  # fmt: skip
    bools = (
        lambda self, depth: self.several("bool", depth, (
            "({f} < {f})", "({f} >= {f})", "({f} == {f})", "({f} != {f})", "({i} <= {i})", "({i} == {i})",
            "({f} < {f} <= {f})", "({i} != {i} < {i})", "({i} < {f})", "({f} == {i})", "({i} >= {f})", "({b} == {b})",
        )),
        lambda self, depth: self.several("bool", depth, (
            "(not {b})", "({b} and {b})", "({b} or {b})", "({b} and ({b} or {b}))", "({b} ^ {b})", "({b} & {b})",
            "{c}.ready", "({i} in (Mode.ON, 3, {i}))", "({i} not in (Mode.HIGH, COUNT))", "bool({i})",
            "any(v > {f} for v in {r})", "all(v < {f} for v in {r})", "math.isnan({f})", "math.isfinite({f})",
        )),
        lambda self, depth: self.choice("bool", depth),
        lambda self, depth: self.call("bool", depth),
    )  # fmt: skip
    points = (
        lambda self, depth: self.several("Point", depth, (
            "Point({f}, {f})", "Point(y={f})", "{p}._replace(x={f})", "{c}.at", "{c}.ends[{i} % 2]",
            "{p}.turned({f})", "{c}.ends[-1]", "({p}, {p})[{i} % 2]",
        )),
        lambda self, depth: self.choice("Point", depth),
        lambda self, depth: self.call("Point", depth),
    )  # fmt: skip
    cars = (
        lambda self, depth: self.several("Car", depth, (
            "Car({p}, {r}, {i}, {b}, ({p}, {p}), {f})", "Car(speed={f})", "{c}._replace(at={p}, mode={i})",
            "{c}._replace(row={r}, ready={b}, speed={f})", "Car(at={p}, ends=({p}, {p}))",
            "{c}._replace(ends=tuple(e._replace(y={f}) for e in {c}.ends))", "{w}.first", "{w}.second",
        )),
        lambda self, depth: self.choice("Car", depth),
        lambda self, depth: self.call("Car", depth),
    )  # fmt: skip
    rows = (
        lambda self, depth: self.several("Row", depth, (
            "({f}, {f}, {f})", "({r}[1:] + ({f},))", "{c}.row", "tuple(v * {f} for v in {r})", "{r}[::-1]",
            "tuple(float(i) * {f} for i in range(3))", "tuple(min(a, b) for a, b in zip({r}, {r}, strict=True))",
            "(({f},) + {r}[:-1])", "tuple(v + k for k, v in enumerate({r}))",
        )),
        lambda self, depth: self.choice("Row", depth),
        lambda self, depth: self.call("Row", depth),
    )  # fmt: skip

    fleets = (
        lambda self, depth: self.several("Fleet", depth, ("Fleet({c}, {c}, {f})", "Fleet(second={c})")),
        lambda self, depth: self.choice("Fleet", depth),
        lambda self, depth: self.call("Fleet", depth),
    )  # fmt: skip

    # ---- statements

    def write(self, text: Any, indent: Any) -> None:
        self.lines.append("    " * indent + text)

    def statements(self, indent: Any, budget: Any, returned: Any, in_loop: bool = False) -> None:
        """Write a block; names that it binds are forgotten after it."""
        before = {kind: list(names) for kind, names in self.scope.items()}
        count = len(self.lines)
        for _ in range(self.draw(st.integers(1, 3))):
            self.statement(indent, budget, returned, in_loop)
        if len(self.lines) == count:
            self.write("pass", indent)
        self.scope = before

    def statement(self, indent: Any, budget: Any, returned: Any, in_loop: Any) -> None:
        forms: list[Callable[[Any, Any, Any], None]]
        forms = [self.assign, self.assign, self.again, self.again, self.unpack, self.replace, self.update, self.fleet]
        if budget > 0:
            forms += [self.branch, self.branch, self.loop, self.match, self.leave]
            forms += [self.go_on] if in_loop else []
        self.pick(forms)(indent, budget - 1, returned)

    def assign(self, indent: Any, _budget: Any, _returned: Any) -> None:
        kind = self.pick(ALL)
        text = self.expression(kind, 3)
        name = self.new(kind)
        self.write(f"{name} = {text}", indent)
        self.scope[kind].append(name)

    def again(self, indent: Any, _budget: Any, _returned: Any) -> None:
        kind = self.pick(KINDS)
        names = [name for name in self.scope[kind] if name not in self.fixed]
        if names and kind in ("float", "int") and self.chance(3):
            bound = " % 1000" if kind == "int" else ""
            self.write(f"{self.pick(names)} {self.pick(('+=', '-='))} ({self.expression(kind, 2)}){bound}", indent)
        elif names:
            self.write(f"{self.pick(names)} = {self.expression(kind, 3)}", indent)

    def unpack(self, indent: Any, _budget: Any, _returned: Any) -> None:
        kind = self.pick(("float", "int", "Point", "Row"))
        names = [name for name in self.scope[kind] if name not in self.fixed]
        if len(names) > 1:
            one, other = names[0], names[-1]
            self.write(f"{one}, {other} = {self.expression(kind, 2)}, {self.expression(kind, 2)}", indent)
        else:
            a, b = self.new("float"), self.new("float")
            self.write(f"{a}, {b} = {self.expression('Point', 2)}", indent)
            self.scope["float"] += [a, b]

    def replace(self, indent: Any, _budget: Any, _returned: Any) -> None:
        names = [name for name in self.scope["Car"] if name not in self.fixed]
        if names:
            name = self.pick(names)
            form = self.pick((
                "at={c}.at._replace(x={f})", "speed={c}.at.x + {f}, at=Point({c}.speed, {f})", "mode={i}, row={r}",
                "ends=({c}.ends[1], {c}.ends[0])", "at=Point({c}.at.y, {c}.at.x), ready={b}",
            ))  # fmt: skip
            self.write(f"{name} = {name}._replace({self.several('Car', 2, (form.replace('{c}', name),))})", indent)

    def update(self, indent: Any, _budget: Any, _returned: Any) -> None:
        """Write a change of a struct by a function that changes it where it lies."""
        for kind, names in ((kind, [n for n in self.scope[kind] if n not in self.fixed]) for kind in ("Car", "Fleet")):
            found = [item for item in self.helpers if item[1] == kind and item[2][0] == kind]
            if names and found:
                name, (helper, _, kinds) = self.pick(names), self.pick(found)
                rest = "".join(f", {self.expression(one, 1)}" for one in kinds[1:])
                self.write(f"{name} = {helper}({self.pick((name, name, self.leaf(kind)))}{rest})", indent)

    def fleet(self, indent: Any, _budget: Any, _returned: Any) -> None:
        names = self.scope["Fleet"]
        if names:
            name = self.pick(names)
            self.write(f"{name} = {self.new_fleet(name)}", indent)

    def new_fleet(self, name: Any) -> Any:
        """Return another fleet made of one."""
        form = self.pick((
            "{F}._replace(first={c}, second={F}.first)", "{F}._replace(second={F}.second._replace(at={F}.first.at))",
            "{F}._replace(first={F}.first._replace(speed={F}.lead, row={r}), lead={F}.first.speed + {f})",
            "Fleet({F}.second, {F}.first, {f})", "Fleet(first={F}.first, second={c}, lead={F}.second.at.x)",
            "{F}._replace(lead={f})", "{F}",
        ))  # fmt: skip
        return self.several("Car", 1, (form.replace("{F}", name),))

    def branch(self, indent: Any, budget: Any, returned: Any) -> None:
        self.write(f"if {self.expression('bool', 3)}:", indent)
        self.statements(indent + 1, budget, returned)
        if self.chance(3):
            self.write(f"elif {self.expression('bool', 2)}:", indent)
            self.statements(indent + 1, budget, returned)
        if self.chance(2):
            self.write("else:", indent)
            self.statements(indent + 1, budget, returned)

    def loop(self, indent: Any, budget: Any, returned: Any) -> None:
        kind, head = self.pick((
            ("int", "range({i} % 4)"), ("int", "range(2, 9, 3)"), ("int", "range(3, -2, -1)"), ("float", "{r}"),
            ("Point", "{c}.ends"), ("float", "({f}, {f})"), ("int", "range({i} % 3, {i} % 5)"),
        ))  # fmt: skip
        name = self.new(kind)
        text = self.several(kind, 2, (head,))
        before = list(self.scope["int"])
        if head == "{r}" and self.chance(2):
            place = self.new("int")
            self.write(f"for {place}, {name} in enumerate({text}):", indent)
            self.scope["int"].append(place)
        else:
            self.write(f"for {name} in {text}:", indent)
        self.scope[kind].append(name)
        self.statements(indent + 1, budget, returned, in_loop=True)
        self.scope[kind].remove(name)
        self.scope["int"] = before

    def go_on(self, indent: Any, _budget: Any, _returned: Any) -> None:
        self.write(f"if {self.expression('bool', 2)}:", indent)
        self.write(self.pick(("break", "continue")), indent + 1)

    def match(self, indent: Any, budget: Any, returned: Any) -> None:
        self.write(f"match {self.expression('int', 2)}:", indent)
        for case in ("Mode.ON", "0 | Mode.LOW", "2 if " + self.expression("bool", 1), "_"):
            if case == "_" or not self.chance(3):
                self.write(f"case {case}:", indent + 1)
                self.statements(indent + 2, budget, returned)

    def leave(self, indent: Any, _budget: Any, returned: Any) -> None:
        self.write(f"if {self.expression('bool', 2)}:", indent)
        self.write(f"return {self.returned(returned)}", indent + 1)

    def returned(self, kind: Any) -> Any:
        """Return what a function gives: of a large struct often what was changed."""
        names = [name for name in self.scope.get(kind, ()) if name not in self.fixed]
        if kind == "Fleet":
            return self.new_fleet(names[0])
        if kind != "Car" or not names or self.chance(4):
            return self.expression(kind, 3)
        name = self.pick(names)
        found = [item for item in self.helpers if item[1] == kind and item[2][0] == kind]
        if found and self.chance(2):
            helper, _, kinds = self.pick(found)
            return f"{helper}({name}{''.join(f', {self.expression(one, 1)}' for one in kinds[1:])})"
        form = self.pick(("at=Point({c}.speed, {f}), speed={c}.at.x", "mode={i}", "row={r}, ends=({p}, {c}.at)"))
        whole = "Car({c}.ends[1], {c}.row, {i}, {b}, ({c}.at, {p}), {c}.at.y)"
        text = self.pick((whole, f"{{c}}._replace({form})", "{c}"))
        return self.several("Car", 1, (text.replace("{c}", name),))

    def whole(self, signature: Any, kinds: Any, returned: Any) -> Any:
        """Return the text of the function."""
        self.scope = {kind: [name for name, own in kinds.items() if own == kind] + [
            name for name in self.scope[kind] if name in self.fixed] for kind in ALL}  # fmt: skip
        self.statements(1, 2, returned)
        self.write(f"return {self.returned(returned)}", 1)
        kind = "tuple[float, float, float]" if returned == "Row" else returned
        return "\n".join([f"def {self.name}({signature}) -> {kind}:", *self.lines, "", "", ""])


@st.composite
def programs(draw: Any, functions: Any) -> Any:
    """Return the text of a module with ``functions`` functions of the usual six arguments, and helpers."""
    texts = [HEAD]
    helpers: list[tuple[str, str, tuple[str, ...]]] = []
    for number in range(functions):
        if number % 3 == 0:
            kinds = {"a": draw(st.sampled_from(KINDS)), "b": draw(st.sampled_from(KINDS)), "c": "float"}
            returned = draw(st.sampled_from(KINDS))
            hints = {kind: "tuple[float, ...]" if kind == "Row" else kind for kind in KINDS}
            signature = ", ".join(f"{name}: {hints[kind]}" for name, kind in kinds.items())
            texts.append(Function(draw, list(helpers), f"_helper{number}").whole(signature, kinds, returned))
            helpers.append((f"_helper{number}", returned, tuple(kinds.values())))
        if number % 3 == 1:
            kind = draw(st.sampled_from(("Car", "Car", "Fleet")))
            kinds = {"own": kind, "p": draw(st.sampled_from(("Point", "Car", "float"))), "c": "float"}
            if kind == "Fleet":
                kinds["p"] = "Car"
            signature = ", ".join(f"{name}: {own}" for name, own in kinds.items())
            texts.append(Function(draw, list(helpers), f"_update{number}").whole(signature, kinds, kind))
            helpers.append((f"_update{number}", kind, tuple(kinds.values())))
        kinds = {"x": "float", "y": "float", "n": "int", "m": "int", "p": "bool", "q": "bool"}
        returned = draw(st.sampled_from(RETURNED))
        texts.append(Function(draw, helpers, f"f{number}").whole(SIGNATURE, kinds, returned))
    return "\n\n".join(texts)
