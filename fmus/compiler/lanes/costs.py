"""What C costs in lanes: a branch that costs little is worked out in all lanes, without a test whether one takes it."""

from typing import Any

from pycparser import c_ast

from fmus.compiler.lanes.reading import Declarations

MAX_UNTESTED_COST = 6
"""Operations on vectors up to which a branch is not tested."""
MAX_COST = 1_000_000
"""Cost of loops, of functions of C's library and of whatever else is left out where no lane needs it."""
OPERATORS = {"/": 8, "%": MAX_COST}
CALLS = {"sqrt": 10, "fabs": 1, "copysign": 2, "int_abs": 2, "int_min": 2, "int_max": 2, "float_min": 2, "float_max": 2,
         "index_in": 6, "int_within": 6, "shift_left": 4, "shift_right": 4, "isnan": 1, "isinf": 3, "isfinite": 2,
         "INT64_C": 0, "UINT64_C": 0}  # fmt: skip
ITEM_COST = 8
"""An item whose index is worked out."""


class Costs:
    """Costs of parts of one file."""

    def __init__(self, file: Declarations) -> None:
        self._file = file
        self._functions: dict[str, int] = {}

    def of(self, node: Any) -> int:
        """Return the cost of a statement or expression, in operations on vectors."""
        if node is None or isinstance(node, c_ast.Constant | c_ast.ID | c_ast.Typename):
            return 0
        if isinstance(node, c_ast.For | c_ast.Switch | c_ast.Break):
            return MAX_COST
        own, parts = 1, [child for _, child in node.children()]
        if isinstance(
            node, c_ast.StructRef | c_ast.Compound | c_ast.InitList | c_ast.NamedInitializer | c_ast.ExprList
        ):
            own = 0
        elif isinstance(node, c_ast.ArrayRef):
            own = 0 if isinstance(node.subscript, c_ast.Constant | c_ast.ID) else ITEM_COST
        elif isinstance(node, c_ast.BinaryOp):
            own = OPERATORS.get(node.op, 1)
        elif isinstance(node, c_ast.FuncCall):
            own, parts = self._call(node.name.name), [node.args]
        elif isinstance(node, c_ast.Decl):
            parts = [node.init]
        elif isinstance(node, c_ast.Cast):
            parts = [node.expr]
        elif isinstance(node, c_ast.CompoundLiteral):
            own, parts = len(node.init.exprs), [node.init]
        return min(MAX_COST, own + sum(map(self.of, parts)))

    def _call(self, name: str) -> int:
        node = self._file.functions.get(name)
        if node is None:
            return CALLS.get(name, MAX_COST)
        if name not in self._functions:
            self._functions[name] = MAX_COST  # of a function that calls itself
            self._functions[name] = self.of(node.body)
        return self._functions[name]

    def is_small(self, node: Any) -> bool:
        """Return whether a branch costs no more than the test whether a lane takes it."""
        return self.of(node) <= MAX_UNTESTED_COST
