"""Expressions in lanes: every operator acts on vectors, and a choice picks between two of them."""

from collections.abc import Callable
from typing import Any, NamedTuple

from pycparser import c_ast

from fmus.compiler.lanes.kinds import (
    BOOL,
    DOUBLE,
    INT,
    SHARED_BOOL,
    SHARED_DOUBLE,
    SHARED_INT,
    Kind,
    LaneArray,
    LaneStruct,
    LaneValue,
    NoLanesError,
    Number,
    Pointer,
    convert,
    declaration,
    kind_of_type,
    own,
    type_name,
)
from fmus.compiler.lanes.reading import Declarations

COMPARISONS = {"<", ">", "<=", ">=", "==", "!="}
CHEAP = {"sqrt", "fabs", "floor", "ceil", "trunc", "rint", "copysign", "fmod"}
"""Functions of C's library that are worked out in all lanes; the others only in those that need them."""
TESTS = {"isnan", "isinf", "isfinite"}
HELPERS: dict[str, tuple[Number, ...]] = {
    "int_of": (INT, DOUBLE),
    "floor_div": (INT, INT, INT),
    "floor_mod": (INT, INT, INT),
    "shift_left": (INT, INT, INT),
    "shift_right": (INT, INT, INT),
    "index_in": (INT, INT, INT),
    "int_within": (INT, INT, INT, INT),
    "int_abs": (INT, INT),
    "int_min": (INT, INT, INT),
    "int_max": (INT, INT, INT),
    "float_min": (DOUBLE, DOUBLE, DOUBLE),
    "float_max": (DOUBLE, DOUBLE, DOUBLE),
    "int_quotient": (DOUBLE, INT, INT),
    "compare_int_float": (INT, INT, DOUBLE),
}
"""Functions of the translator's runtime: the kind of the result, then those of the arguments."""


class LaneVariable(NamedTuple):
    """A local variable or parameter."""

    kind: Kind
    level: int
    """Of the mask under which it was declared; -1: a parameter."""


class LanePlace(NamedTuple):
    """A place whose index differs between lanes: ``text`` is where lane ``l`` finds it."""

    text: str
    kind: Kind


class Expressions:
    """Writes expressions of one function."""

    def __init__(self, file: Declarations, needed: set[str], calls: list[int]) -> None:
        self.file, self.needed, self.calls = file, needed, calls
        self.turns: dict[str, str] = {}
        """Arguments of which sine and cosine are known -> the call that knows them."""
        self.variables: dict[str, LaneVariable] = {}
        self.fresh = 0
        self.mask = "live"
        """The lanes for which an expression is worked out."""
        self._writers: dict[type, Callable[[Any], LaneValue]] = {
            c_ast.Constant: self._constant,
            c_ast.ID: self._name,
            c_ast.StructRef: self._field,
            c_ast.ArrayRef: self._item,
            c_ast.UnaryOp: self._unary,
            c_ast.BinaryOp: self._binary,
            c_ast.TernaryOp: self._choice,
            c_ast.Cast: self._cast,
            c_ast.FuncCall: self._call,
            c_ast.CompoundLiteral: self._literal,
        }

    def value(self, node: Any) -> LaneValue:
        """Return an expression."""
        writer = self._writers.get(type(node))
        if writer is None:
            raise NoLanesError(type(node).__name__)
        return writer(node)

    def number(self, node: Any, wanted: Number) -> str:
        """Return the text of an expression as the ``wanted`` number."""
        return convert(self.value(node), wanted)

    def argument(self, node: Any, kind: Kind) -> str:
        """Return the text of what is assigned to, or passed as, a ``kind``."""
        if isinstance(kind, Number):
            return self.number(node, kind)
        if isinstance(node, c_ast.InitList):
            return self.initial(node, kind)
        value = self.value(node)
        if isinstance(value.kind, LaneArray) and isinstance(kind, Pointer) and value.kind.item == kind.to:
            return value.text
        if value.kind != kind:
            raise NoLanesError(f"{value.text}: {value.kind}, no {kind}")
        return value.text

    def initial(self, node: Any, kind: Kind) -> str:
        """Return an initializer."""
        if not isinstance(node, c_ast.InitList):
            value = self.value(node)
            if isinstance(kind, Number) and isinstance(value.kind, Number) and value.kind.is_shared:
                return self._everywhere(value, kind)
            return self.argument(node, kind)
        if isinstance(kind, LaneStruct):
            fields = self.file.structs[kind.name]
            if all(isinstance(item, c_ast.Constant) and item.value == "0" for item in node.exprs):
                return "{}"
            parts = []
            for name, item in zip(fields, node.exprs, strict=False):
                if isinstance(item, c_ast.NamedInitializer):
                    parts.append(f".{item.name[0].name} = {self.initial(item.expr, fields[item.name[0].name])}")
                else:
                    parts.append(self.initial(item, fields[name]))
            return "{" + ", ".join(parts) + "}"
        if isinstance(kind, LaneArray):
            return "{" + ", ".join(self.initial(item, kind.item) for item in node.exprs) + "}"
        raise NoLanesError(f"a list for {kind}")

    def _everywhere(self, value: LaneValue, kind: Number) -> str:
        if kind.is_shared:
            return value.text
        return f"LANE_ALL({f'-({value.text})' if kind.name == 'bool' else value.text})"

    def _constant(self, node: Any) -> LaneValue:
        return LaneValue(node.value, SHARED_DOUBLE if "double" in node.type else SHARED_INT)

    def _name(self, node: Any) -> LaneValue:
        name = str(node.name)
        if name in ("true", "false"):
            return LaneValue(name, SHARED_BOOL)
        if name in ("NAN", "INFINITY"):
            return LaneValue(name, SHARED_DOUBLE)
        if name in self.variables:
            return LaneValue(name, self.variables[name].kind)
        kind = self.file.name(name)
        if kind is None:
            raise NoLanesError(f"unknown name {name}")
        return LaneValue(name, kind)

    def _field(self, node: Any) -> LaneValue:
        place = self.place(node)
        if place is not None:
            return self._gather(place)
        value = self.value(node.name)
        kind = value.kind.to if node.type == "->" and isinstance(value.kind, Pointer) else value.kind
        return LaneValue(f"{value.text}{node.type}{node.field.name}", self.file.field(kind, node.field.name))

    def _item(self, node: Any) -> LaneValue:
        place = self.place(node)
        if place is not None:
            return self._gather(place)
        value, index = self.value(node.name), self.value(node.subscript)
        kind = value.kind
        if not isinstance(kind, LaneArray | Pointer):
            raise NoLanesError(f"an item of {kind}")
        return LaneValue(f"{value.text}[{index.text}]", kind.item if isinstance(kind, LaneArray) else kind.to)

    def place(self, node: Any) -> LanePlace | None:
        """Return the place of an item whose index differs between lanes; None if none in its path does."""
        if isinstance(node, c_ast.StructRef):
            place = self.place(node.name)
            if place is None or node.type == "->":
                return None
            return LanePlace(f"{place.text}.{node.field.name}", self.file.field(place.kind, node.field.name))
        if not isinstance(node, c_ast.ArrayRef):
            return None
        index = self.value(node.subscript)
        place = self.place(node.name)
        is_own = isinstance(index.kind, Number) and not index.kind.is_shared
        if place is None and not is_own:
            return None
        if place is None:
            base = self.value(node.name)
            place = LanePlace(base.text, base.kind)
        if not isinstance(place.kind, LaneArray | Pointer):
            raise NoLanesError(f"an item of {place.kind}")
        kind = place.kind.item if isinstance(place.kind, LaneArray) else place.kind.to
        text = f"({convert(index, INT)} & {self.mask})[l]" if is_own else index.text
        return LanePlace(f"{place.text}[{text}]", kind)

    def _gather(self, place: LanePlace) -> LaneValue:
        """Return what each live lane finds at a place; an index means nothing in the others, which find the first."""
        kind = place.kind
        if isinstance(kind, Number):
            item = place.text if kind.is_shared else f"{place.text}[l]"
            text = f"{'-' if kind == SHARED_BOOL else ''}{item}"
            return LaneValue(f"({{ {type_name(own(kind))} r; LANE_EACH(l) r[l] = {text}; r; }})", own(kind))
        if isinstance(kind, LaneStruct):
            take = f"{kind.name}_take(&r, &{place.text}, l)"
            return LaneValue(f"({{ {kind.name} r; LANE_EACH(l) {take}; r; }})", kind)
        raise NoLanesError(f"{kind} at an index that differs between lanes")

    def _unary(self, node: Any) -> LaneValue:
        operator = node.op
        if operator == "&":
            return self._address(node.expr)
        value = self.value(node.expr)
        if operator == "*" and isinstance(value.kind, Pointer):
            return LaneValue(f"(*{value.text})", value.kind.to)
        if not isinstance(value.kind, Number):
            raise NoLanesError(f"{operator} of {value.kind}")
        if operator == "!":
            if value.kind.is_shared:
                return LaneValue(f"(!({value.text}))", SHARED_BOOL)
            return LaneValue(f"(~{convert(value, BOOL)})", BOOL)
        if operator in ("-", "+", "~"):
            if value.kind.name == "bool":
                raise NoLanesError("arithmetic with a truth value")
            return LaneValue(f"({operator}{value.text})", value.kind)
        raise NoLanesError(operator)

    def _address(self, node: Any) -> LaneValue:
        place = self.place(node)
        if place is None:
            value = self.value(node)
            return LaneValue(f"(&{value.text})", Pointer(value.kind))
        raise NoLanesError(f"the address of {place.text}")

    def has_call(self, node: Any) -> bool:
        """Return whether a function is called that takes some time."""
        if isinstance(node, c_ast.FuncCall):
            name = node.name.name
            return name not in HELPERS and name not in CHEAP and name not in TESTS
        return any(self.has_call(child) for _, child in node.children())

    def under(self, condition: str, node: Any, wanted: Number) -> str:
        """Return an expression worked out where ``condition`` holds."""
        before, self.mask = self.mask, f"({self.mask} & {condition})"
        text = self.number(node, wanted)
        self.mask = before
        return text

    def _binary(self, node: Any) -> LaneValue:
        operator = node.op
        left, right = self.value(node.left), self.value(node.right)
        if not isinstance(left.kind, Number) or not isinstance(right.kind, Number):
            raise NoLanesError(f"{left.kind} {operator} {right.kind}")
        is_shared = left.kind.is_shared and right.kind.is_shared
        if operator in ("&&", "||"):
            return self._logic(node, left, right, is_shared)
        is_double = "double" in (left.kind.name, right.kind.name)
        if is_shared:
            kind = SHARED_BOOL if operator in COMPARISONS else SHARED_DOUBLE if is_double else SHARED_INT
            return LaneValue(f"({left.text} {operator} {right.text})", kind)
        if left.kind.name == right.kind.name == "bool" and operator in ("==", "!="):
            return LaneValue(f"({convert(left, BOOL)} {operator} {convert(right, BOOL)})", BOOL)
        common = DOUBLE if is_double else INT
        text = f"({convert(left, common)} {operator} {convert(right, common)})"
        if operator in COMPARISONS:
            return LaneValue(text, BOOL)
        if operator in ("/", "%") and not is_double:
            raise NoLanesError("C's own division of integers")
        return LaneValue(text, common)

    def _logic(self, node: Any, left: LaneValue, right: LaneValue, is_shared: bool) -> LaneValue:
        if is_shared:
            return LaneValue(f"({left.text} {node.op} {right.text})", SHARED_BOOL)
        first = convert(left, BOOL)
        if not self.has_call(node.right):
            return LaneValue(f"({first} {node.op[0]} {convert(right, BOOL)})", BOOL)
        condition = "a" if node.op == "&&" else "~a"
        name = self._fresh("a")
        condition = condition.replace("a", name)
        second = self.under(condition, node.right, BOOL)
        text = (
            f"({{ lane_i {name} = {first}; if (lane_any({self.mask} & {condition})) "
            f"{name} {node.op[0]}= {second}; {name}; }})"
        )
        return LaneValue(text, BOOL)

    def _fresh(self, word: str) -> str:
        self.fresh += 1
        return f"{word}{self.fresh}_"

    def _choice(self, node: Any) -> LaneValue:
        condition, one, other = (self.value(item) for item in (node.cond, node.iftrue, node.iffalse))
        if one.kind != other.kind and not (isinstance(one.kind, Number) and isinstance(other.kind, Number)):
            raise NoLanesError(f"{one.kind} or {other.kind}")
        assert isinstance(condition.kind, Number)
        if not isinstance(one.kind, Number) or not isinstance(other.kind, Number):
            if condition.kind.is_shared:
                return LaneValue(f"({condition.text} ? {one.text} : {other.text})", one.kind)
            raise NoLanesError(f"{one.kind} that differs between lanes")
        names = {one.kind.name, other.kind.name}
        common = DOUBLE if "double" in names else BOOL if names == {"bool"} else INT
        if condition.kind.is_shared:
            if one.kind.is_shared and other.kind.is_shared:
                return LaneValue(f"({condition.text} ? {one.text} : {other.text})", Number(common.name, True))
            return LaneValue(f"({condition.text} ? {convert(one, common)} : {convert(other, common)})", common)
        pick, where = f"lane_pick_{common.name[0]}", convert(condition, BOOL)
        if not (self.has_call(node.iftrue) or self.has_call(node.iffalse)):
            return LaneValue(f"{pick}({where}, {convert(one, common)}, {convert(other, common)})", common)
        name, result = self._fresh("c"), self._fresh("r")
        first, second = self.under(name, node.iftrue, common), self.under(f"~{name}", node.iffalse, common)
        text = (
            f"({{ const lane_i {name} = {where}; {type_name(common)} {result} = {{0}}; "
            f"if (lane_any({self.mask} & {name})) {result} = {first}; "
            f"if (lane_any({self.mask} & ~{name})) {result} = {pick}({name}, {result}, {second}); {result}; }})"
        )
        return LaneValue(text, common)

    def _cast(self, node: Any) -> LaneValue:
        kind = kind_of_type(node.to_type, self.file.lengths, True)
        value = self.value(node.expr)
        if not isinstance(kind, Number) or not isinstance(value.kind, Number):
            raise NoLanesError(f"{value.kind} as {kind}")
        if value.kind.is_shared:
            return LaneValue(f"(({SHARED_TYPE[kind.name]})({value.text}))", kind)
        return LaneValue(convert(value, own(kind)), own(kind))

    def _call(self, node: Any) -> LaneValue:
        name, given = node.name.name, node.args.exprs if node.args else []
        if name in self.file.signatures:
            result, params = self.file.signatures[name]
            texts = [self.argument(item, kind) for item, (_, kind) in zip(given, params, strict=True)]
            return LaneValue(f"{name}({', '.join(['calls', self.mask, *texts])})", result)
        values = [self.value(item) for item in given]
        if all(isinstance(value.kind, Number) and value.kind.is_shared for value in values):
            if name in ("INT64_C", "UINT64_C"):
                return LaneValue(values[0].text, SHARED_INT)
            kind = HELPERS[name][0] if name in HELPERS else BOOL if name in TESTS else DOUBLE
            return LaneValue(f"{name}({', '.join(value.text for value in values)})", Number(kind.name, True))
        self.needed.add(name)
        if name in HELPERS:
            kind, *kinds = HELPERS[name]
            texts = [convert(value, wanted) for value, wanted in zip(values, kinds, strict=True)]
            return LaneValue(f"lane_{name}({', '.join(texts)})", kind)
        texts = [convert(value, DOUBLE) for value in values]
        if name in TESTS:
            return LaneValue(f"lane_{name}({', '.join(texts)})", BOOL)
        if name in CHEAP:
            return LaneValue(f"lane_{name}({', '.join(texts)})", DOUBLE)
        if name in ("sin", "cos") and texts[0] in self.turns:
            return LaneValue(f"{self.turns[texts[0]]}.{'result' if name == 'sin' else 'other'}", DOUBLE)
        return LaneValue(f"lane_{name}({self.call()}, {', '.join([self.mask, *texts])})", DOUBLE)

    def call(self) -> str:
        """Return the place of what is known of one more call of a function of C's library."""
        self.calls.append(len(self.calls))
        return f"calls, {self.calls[-1]}"

    def _literal(self, node: Any) -> LaneValue:
        kind = kind_of_type(node.type, self.file.lengths)
        return LaneValue(f"({declaration(kind, '').strip()}){self.initial(node.init, kind)}", kind)


SHARED_TYPE = {"double": "double", "int": "int64_t", "bool": "bool"}
