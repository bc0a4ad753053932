"""Statements in lanes: a branch becomes a mask, and no lane outside it changes anything."""

import re
from itertools import zip_longest
from typing import Any

from pycparser import c_ast

from fmus.compiler.lanes.expressions import Expressions, LaneVariable
from fmus.compiler.lanes.kinds import (
    BOOL,
    SHARED_INT,
    Kind,
    LaneArray,
    LaneStruct,
    LaneValue,
    NoLanesError,
    Number,
    Pointer,
    Void,
    convert,
    declaration,
    kind_of_type,
    type_name,
)
from fmus.compiler.lanes.reading import Declarations, is_const

PLACE = re.compile(r"\(\*\w+\)|\w+(->\w+|\.\w+|\[\w+\])*")
"""The text of a struct that is somewhere, and not worked out."""
ANYTHING = "*"
"""For a statement that calls a function, which may change what its arguments point to."""


class Function:
    """Writes one function."""

    def __init__(self, file: Declarations, needed: set[str], calls: list[int], node: Any) -> None:
        self.file, self.needed, self.node = file, needed, node
        self.result, self.params = file.signatures[node.decl.name]
        self.write = Expressions(file, needed, calls)
        self.write.variables = {name: LaneVariable(kind, -1) for name, kind in self.params}
        self.lines: list[str] = []
        self.level, self.levels, self.count, self.depth = 0, 0, 0, 1
        self.mask = "live"
        self.loops: list[str] = []
        self.next_turns: dict[str, str] = {}
        items = node.body.block_items or []
        self.returns_early = any(holds(item, c_ast.Return) for item in items[:-1]) or (
            bool(items) and not isinstance(items[-1], c_ast.Return) and holds(items[-1], c_ast.Return)
        )

    def text(self) -> list[str]:
        """Return the lines of the function."""
        if self.returns_early:
            self._line("lane_i lane_at = live;")
            self._line("lane_i lane_gone = LANE_NONE;")
            self._use("lane_at")
            if not isinstance(self.result, Void):
                zero = " = {0}" if isinstance(self.result, Number) else ""
                self._line(f"{declaration(self.result, 'lane_returned')}{zero};")
        items = self.node.body.block_items or []
        self._block(items)
        if self.returns_early and not isinstance(self.result, Void) and not isinstance(items[-1], c_ast.Return):
            self._line("return lane_returned;")
        return [signature(self.file, self.node.decl.name), "{", "    (void)live;", *self.lines, "}"]

    def _line(self, text: str) -> None:
        self.lines.append("    " * self.depth + text)

    def _use(self, mask: str) -> None:
        self.mask = self.write.mask = mask

    def _fresh(self, word: str) -> str:
        self.count += 1
        return f"lane_{word}{self.count}"

    def _block(self, items: list[Any]) -> None:
        known = dict(self.write.variables)
        self.next_turns = {}
        for item, after in zip_longest(items, items[1:]):
            self._turn(item, after)
            self._statement(item)
        self.write.variables, self.next_turns = known, {}

    def _turn(self, item: Any, after: Any) -> None:
        """Write sine and cosine of one argument as one call, where a statement, or it and the next one, have both."""
        self.write.turns, self.next_turns = self.next_turns, {}
        changed = self._assignment_target(item)
        if changed is None:
            return
        here: dict[str, set[str]] = {}
        following: dict[str, set[str]] = {}
        self._find_turns(_worth(item), here)
        if changed != ANYTHING and self._assignment_target(after) is not None:
            self._find_turns(_worth(after), following)
        for text, names in here.items():
            stays = changed != ANYTHING and not (changed and re.search(rf"\b{changed}\b", text))
            if len(names | (following.get(text, set()) if stays else set())) == 2 and text not in self.write.turns:
                call = self._fresh("turn")
                self._line(
                    f"const LaneCall *const {call} = lane_sincos_call({self.write.call()}, {self.mask}, {text});"
                )
                self.write.turns[text] = f"(*{call})"
                if stays:
                    self.next_turns[text] = f"(*{call})"

    def _assignment_target(self, node: Any) -> str | None:
        """Return the variable that a statement changes, ``""`` if it is a new one; None: no assignment."""
        if not isinstance(node, c_ast.Decl | c_ast.Assignment | c_ast.Return) or _worth(node) is None:
            return None
        if self._calls_function(node):
            return ANYTHING
        return root(node.lvalue) if isinstance(node, c_ast.Assignment) else ""

    def _calls_function(self, node: Any) -> bool:
        if isinstance(node, c_ast.FuncCall) and node.name.name in self.file.signatures:
            return True
        return any(self._calls_function(child) for _, child in node.children())

    def _find_turns(self, node: Any, found: dict[str, set[str]]) -> None:
        if isinstance(node, c_ast.FuncCall) and node.name.name in ("sin", "cos"):
            try:
                value = self.write.value(node.args.exprs[0])
            except NoLanesError:
                return
            if isinstance(value.kind, Number) and not value.kind.is_shared and "calls" not in value.text:
                found.setdefault(value.text, set()).add(node.name.name)
        elif isinstance(node, c_ast.Node) and not isinstance(node, c_ast.TernaryOp):
            for _, child in node.children():
                self._find_turns(child, found)

    def _statement(self, node: Any) -> None:
        if isinstance(node, c_ast.Decl):
            self._declare(node)
        elif isinstance(node, c_ast.Assignment):
            self._assign(node)
        elif isinstance(node, c_ast.If):
            self._branch(node)
        elif isinstance(node, c_ast.For):
            self._repeat(node)
        elif isinstance(node, c_ast.Return):
            self._give(node)
        elif isinstance(node, c_ast.Compound):
            self._line("{")
            self.depth += 1
            self._block(node.block_items or [])
            self.depth -= 1
            self._line("}")
        elif isinstance(node, c_ast.Switch):
            self._switch(node)
        elif isinstance(node, c_ast.Break) and self.loops:
            self._leave(self.loops[-1])
        elif isinstance(node, c_ast.FuncCall):
            self._line(f"{self.write.value(node).text};")
        elif isinstance(node, c_ast.Cast):
            self._line(f"(void){self.write.value(node.expr).text};")
        elif not isinstance(node, c_ast.EmptyStatement):
            raise NoLanesError(type(node).__name__)

    def _declare(self, node: Any) -> None:
        if isinstance(node.init, c_ast.UnaryOp) and node.init.op == "&" and is_const(node.type):
            place = self.write.place(node.init.expr)
            if place is not None and isinstance(place.kind, LaneStruct):
                self._declare_copy(node.name, self.write.value(node.init.expr))
                return
        if isinstance(node.init, c_ast.TernaryOp) and isinstance(node.type, c_ast.PtrDecl) and is_const(node.type):
            self._declare_choice(node)
            return
        kind = kind_of_type(node.type, self.file.lengths)
        text = ""
        if node.init is not None:
            kind = self._kind_of_initial(node, kind)
            is_list = isinstance(node.init, c_ast.InitList)
            text = self.write.initial(node.init, kind) if is_list else self.write.argument(node.init, kind)
        elif isinstance(kind, Number):
            text = "{0}"
        self.write.variables[node.name] = LaneVariable(kind, self.level)
        const = "const " if is_const(node.type) else ""
        self._line(f"{const}{declaration(kind, node.name)}{' = ' + text if text else ''};")

    def _declare_copy(self, name: str, value: LaneValue) -> None:
        """Write a pointer to a copy of an item whose index differs between lanes."""
        copy = self._fresh("copy")
        self._line(f"const {declaration(value.kind, copy)} = {value.text};")
        self.write.variables[name] = LaneVariable(Pointer(value.kind), self.level)
        self._line(f"const {declaration(Pointer(value.kind), name)} = &{copy};")

    def _declare_choice(self, node: Any) -> None:
        """Write a pointer to one of two structs, to a copy of it where the choice differs between lanes."""
        parts = (node.init.cond, node.init.iftrue, node.init.iffalse)
        where, one, other = (self.write.value(part) for part in parts)
        kind = one.kind
        if not isinstance(where.kind, Number) or not isinstance(kind, Pointer) or other.kind != kind:
            raise NoLanesError(f"{kind} or {other.kind}")
        if where.kind.is_shared:
            self.write.variables[node.name] = LaneVariable(kind, self.level)
            text = f"{where.text} ? {one.text} : {other.text}"
            self._line(f"const {declaration(kind, node.name)} = {text};")
            return
        if not isinstance(kind.to, LaneStruct):
            raise NoLanesError(f"{kind} that differs between lanes")
        chosen = self._fresh("chosen")
        self._line(f"{kind.to.name} {chosen} = *{other.text};")
        self._line(f"{kind.to.name}_put(&{chosen}, {one.text}, {convert(where, BOOL)});")
        self.write.variables[node.name] = LaneVariable(kind, self.level)
        self._line(f"const {declaration(kind, node.name)} = &{chosen};")

    def _kind_of_initial(self, node: Any, kind: Kind) -> Kind:
        """Return the kind of a variable: a constant one that all lanes share stays a plain number."""
        if isinstance(node.init, c_ast.InitList):
            return kind
        found = self.write.value(node.init).kind
        if isinstance(kind, Number) and isinstance(found, Number) and found.is_shared and "const" in node.quals:
            return Number(kind.name, True)
        if isinstance(kind, Pointer) and isinstance(found, LaneArray | Pointer):
            return Pointer(found.item if isinstance(found, LaneArray) else found.to)
        return kind

    def _assign(self, node: Any) -> None:
        if node.op != "=":
            node = c_ast.Assignment("=", node.lvalue, c_ast.BinaryOp(node.op[:-1], node.lvalue, node.rvalue))
        if is_dead(node.rvalue) or self._is_dead_output(node.lvalue):
            return
        place = self.write.place(node.lvalue)
        if place is not None:
            if not isinstance(place.kind, Number):
                raise NoLanesError(f"{place.kind} at an index that differs between lanes")
            value = self._fresh("v")
            self._line(f"{{ const {type_name(place.kind)} {value} = {self.write.number(node.rvalue, place.kind)};")
            self._line(f"LANE_EACH(l) if (({self.mask})[l]) {place.text}[l] = {value}[l]; }}")
            return
        target = self.write.value(node.lvalue)
        self._put(target, self.write.argument(node.rvalue, target.kind), self._is_own(node.lvalue))

    def _is_dead_output(self, node: Any) -> bool:
        """Return whether a place is an output that the slice does not need."""
        field = ""
        while isinstance(node, c_ast.StructRef | c_ast.ArrayRef):
            if isinstance(node, c_ast.StructRef):
                field = node.field.name
            node = node.name
        kind = self.write.variables[node.name].kind if isinstance(node, c_ast.ID) else None
        return kind == Pointer(self.file.outputs) and bool(field) and field not in self.file.live_outputs

    def _put(self, target: LaneValue, text: str, is_whole: bool) -> None:
        kind = target.kind
        if is_whole:
            self._line(f"{target.text} = {text};")
        elif isinstance(kind, Number) and not kind.is_shared:
            self._line(f"{target.text} = lane_pick_{kind.name[0]}({self.mask}, {text}, {target.text});")
        elif isinstance(kind, LaneStruct):
            value = text if PLACE.fullmatch(text) else self._fresh("value")
            if value != text:
                self._line(f"const {kind.name} {value} = {text};")
            self._line(f"{kind.name}_put(&{target.text}, &{value}, {self.mask});")
        else:
            raise NoLanesError(f"{kind} assigned")

    def _as_struct(self, text: str, kind: LaneStruct) -> str:
        return f"({kind.name}){text}" if text.startswith("{") else text

    def _is_own(self, node: Any) -> bool:
        """Return whether a variable was declared under the present mask: other lanes do not need it."""
        while isinstance(node, c_ast.StructRef | c_ast.ArrayRef):
            if isinstance(node, c_ast.StructRef) and node.type == "->":
                return False
            node = node.name
        if not isinstance(node, c_ast.ID) or node.name not in self.write.variables:
            return False
        variable = self.write.variables[node.name]
        return variable.level == self.level and not isinstance(variable.kind, Pointer)

    def _branch(self, node: Any) -> None:
        condition = self.write.value(node.cond)
        assert isinstance(condition.kind, Number)
        if condition.kind.is_shared:
            self._line(f"if ({condition.text}) {{")
            self._inner(node.iftrue)
            self._narrow(node.iftrue)
            if node.iffalse is not None:
                self._line("} else {")
                self._inner(node.iffalse)
                self._narrow(node.iffalse)
            self._line("}")
            return
        name, outer, level = self._fresh("if"), self.mask, self.level
        self._line(f"const lane_i {name} = {convert(condition, BOOL)};")
        for part, where in ((node.iftrue, name), (node.iffalse, f"~{name}")):
            if part is None:
                continue
            inner = self._fresh("at")
            self._line(f"lane_i {inner} = {outer} & {where};")
            self._line(f"if (lane_any({inner})) {{")
            self.level = self._next_level()
            self._use(inner)
            self._inner(part)
            self._use(outer)
            self._narrow(part)
            self._line("}")
            self.level = level

    def _next_level(self) -> int:
        self.levels += 1
        return self.levels

    def _inner(self, node: Any) -> None:
        self.depth += 1
        self._block((node.block_items or []) if isinstance(node, c_ast.Compound) else [node])
        self.depth -= 1

    def _narrow(self, node: Any) -> None:
        """Take those that have returned in a statement, or left the loop, out of the present mask."""
        if holds(node, c_ast.Return):
            self._narrow_returned()
        if self.loops and self.loops[-1] and holds_break(node):
            self._line(f"{self.mask} &= {self.loops[-1]};")

    def _narrow_returned(self) -> None:
        self._line(f"{self.mask} &= ~lane_gone;")
        value = "" if isinstance(self.result, Void) else " lane_returned"
        self._line(f"if (!lane_any(live & ~lane_gone)) return{value};")

    def _leave(self, loop: str) -> None:
        self._line(f"{loop} &= ~{self.mask};")
        if loop != self.mask:
            self._line(f"{self.mask} = LANE_NONE;")

    def _give(self, node: Any) -> None:
        if node.expr is None:
            if self.returns_early:
                self._line(f"lane_gone |= {self.mask};")
                self._line(f"{self.mask} = LANE_NONE;")
            return
        text = self.write.argument(node.expr, self.result)
        if not self.returns_early:
            self._line(f"return {self._as_struct(text, self.result) if isinstance(self.result, LaneStruct) else text};")
            return
        self._put(LaneValue("lane_returned", self.result), text, False)
        if self.depth == 1:
            self._line("return lane_returned;")
            return
        self._line(f"lane_gone |= {self.mask};")
        self._line(f"{self.mask} = LANE_NONE;")

    def _repeat(self, node: Any) -> None:
        if node.init is None:
            raise NoLanesError("a loop without a counter")
        (first,) = node.init.decls
        begin = self.write.value(first.init)
        self.write.variables[first.name] = LaneVariable(SHARED_INT, self.level)
        shared = isinstance(begin.kind, Number) and begin.kind.is_shared and not assigns(node.stmt, first.name)
        condition = self.write.value(node.cond).kind if shared else None
        if isinstance(condition, Number) and condition.is_shared:
            self._repeat_together(node, first, begin)
        else:
            self._repeat_masked(node, first, begin)
        del self.write.variables[first.name]
        if holds(node.stmt, c_ast.Return):
            self._narrow(node)

    def _next(self, node: Any) -> str:
        """Return what a loop does after each round."""
        change = node.next
        if isinstance(change, c_ast.UnaryOp):
            return f"{change.expr.name} {change.op[-1]}= 1"
        return f"{change.lvalue.name} {change.op} {self.write.value(change.rvalue).text}"

    def _repeat_together(self, node: Any, first: Any, begin: LaneValue) -> None:
        """Write a loop that all lanes go through alike."""
        outer, level, name = self.mask, self.level, ""
        has_break = holds_break(node.stmt)
        if has_break:
            name = self._fresh("loop")
            self._line(f"lane_i {name} = {outer};")
        self._line(
            f"for (int64_t {first.name} = {begin.text}; {self.write.value(node.cond).text}; {self._next(node)}) {{"
        )
        if has_break:
            self.depth += 1
            self._line(f"if (!lane_any({name})) break;")
            self.depth -= 1
            self.level = self._next_level()
            self._use(name)
        self.loops.append(name)
        self._inner(node.stmt)
        self.loops.pop()
        self._line("}")
        self._use(outer)
        self.level = level

    def _repeat_masked(self, node: Any, first: Any, begin: LaneValue) -> None:
        """Write a loop that each lane leaves when its own condition fails."""
        outer, level, name = self.mask, self.level, self._fresh("loop")
        kind = kind_of_type(first.type, self.file.lengths)
        assert isinstance(kind, Number)
        self._line(f"lane_i {name} = {outer};")
        self.level = self._next_level()
        self.write.variables[first.name] = LaneVariable(kind, self.level)
        self._line(f"lane_i {first.name} = {convert(begin, kind)};")
        self._line("for (;;) {")
        self._use(name)
        self.depth += 1
        condition = self.write.number(node.cond, BOOL)
        self._line(f"{name} &= {condition}{' & ~lane_gone' if self.returns_early else ''};")
        self._line(f"if (!lane_any({name})) break;")
        self.depth -= 1
        self.loops.append(name)
        self._inner(node.stmt)
        self.loops.pop()
        self._line(f"    {self._next(node)};")
        self._line("}")
        self._use(outer)
        self.level = level

    def _switch(self, node: Any) -> None:
        """Write a switch whose cases all end with ``break`` as a chain of branches."""
        chosen, rest = self._fresh("case"), self._fresh("rest")
        value = self.write.number(node.cond, Number("int", False))
        self._line(f"const lane_i {chosen} = {value};")
        self._line(f"lane_i {rest} = {self.mask};")
        labels: list[str] = []
        outer, level = self.mask, self.level
        for case in node.stmt.block_items:
            if isinstance(case, c_ast.Case):
                labels.append(f"({chosen} == {self.write.value(case.expr).text})")
                if not case.stmts:
                    continue
            where = " | ".join(labels) if isinstance(case, c_ast.Case) else rest
            labels = []
            inner = self._fresh("at")
            self._line(f"lane_i {inner} = {rest} & ({where});")
            self._line(f"{rest} &= ~{inner};")
            self._line(f"if (lane_any({inner})) {{")
            self.level = self._next_level()
            self._use(inner)
            self._cases(case.stmts)
            self._use(outer)
            if any(holds(item, c_ast.Return) for item in case.stmts):
                self._narrow_returned()
            self._line("}")
            self.level = level

    def _cases(self, statements: list[Any]) -> None:
        items = list(statements)
        if len(items) == 1 and isinstance(items[0], c_ast.Compound):
            items = list(items[0].block_items or [])
        if items and isinstance(items[-1], c_ast.Break):
            items.pop()
        elif not items or not isinstance(items[-1], c_ast.Return):
            raise NoLanesError("a case that goes on into the next")
        self.depth += 1
        self._block(items)
        self.depth -= 1


def signature(file: Declarations, name: str) -> str:
    """Return the head of a function: the mask of the lanes that live comes first."""
    result, params = file.signatures[name]
    texts = [
        f"const {declaration(kind, item)}" if isinstance(kind, Pointer) and file.is_read_only(name, item) else
        declaration(kind, item)
        for item, kind in params
    ]  # fmt: skip
    return f"static inline {type_name(result)} {name}({', '.join(['LaneCall *calls', 'lane_i live', *texts])})"


def root(node: Any) -> str:
    """Return the variable that a place is in."""
    while isinstance(node, c_ast.StructRef | c_ast.ArrayRef | c_ast.UnaryOp):
        node = node.expr if isinstance(node, c_ast.UnaryOp) else node.name
    return str(node.name)


def _worth(node: Any) -> Any:
    """Return the expression of a statement."""
    if isinstance(node, c_ast.Decl):
        return node.init
    return node.rvalue if isinstance(node, c_ast.Assignment) else node.expr


def is_dead(node: Any) -> bool:
    """Return whether a value is the zero that stands where a slice needs none."""
    if not isinstance(node, c_ast.CompoundLiteral):
        return False
    items = node.init.exprs
    return len(items) == 1 and isinstance(items[0], c_ast.Constant) and items[0].value == "0"


def holds(node: Any, kind: type) -> bool:
    """Return whether a statement has one of this kind in it."""
    return isinstance(node, kind) or any(holds(child, kind) for _, child in node.children())


def holds_break(node: Any) -> bool:
    """Return whether a statement leaves the loop that it is in."""
    if isinstance(node, c_ast.For | c_ast.Switch):
        return False
    return isinstance(node, c_ast.Break) or any(holds_break(child) for _, child in node.children())


def assigns(node: Any, name: str) -> bool:
    """Return whether a statement assigns to a variable."""
    if isinstance(node, c_ast.Assignment) and isinstance(node.lvalue, c_ast.ID) and node.lvalue.name == name:
        return True
    return any(assigns(child, name) for _, child in node.children())
