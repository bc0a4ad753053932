"""Where Python raises, C goes on with the value that docs/model-language.md states, and reads no memory outside."""

import math
from pathlib import Path
from typing import Any

import pytest

from tests.compiler.language import Inputs, Twins

PAGE = Path(__file__).parents[2] / "docs" / "model-language.md"
SIGNATURE = "x: float, y: float, n: int, m: int, p: bool, q: bool"
LARGEST, SMALLEST = 2**63 - 1, -(2**63)
NAN, INF = math.nan, math.inf
EXPRESSIONS: dict[str, tuple[str, str]] = {
    "quotient": ("float", "x / y"),
    "int_quotient": ("float", "n / m"),
    "root": ("float", "math.sqrt(x)"),
    "logarithm": ("float", "math.log(x)"),
    "sine": ("float", "math.sin(x)"),
    "arc": ("float", "math.acos(x)"),
    "power_of_e": ("float", "math.exp(x)"),
    "whole_quotient": ("int", "n // m"),
    "rest": ("int", "n % m"),
    "truncated": ("int", "int(x)"),
    "floored": ("int", "math.floor(x)"),
    "raised": ("int", "math.ceil(x)"),
    "rounded": ("int", "round(x)"),
    "item": ("float", "(1.0, 2.0, 3.0)[n]"),
    "shifted_left": ("int", "n << m"),
    "shifted_right": ("int", "n >> m"),
}
"""Function -> type of its result, and what it returns."""
CASES: list[tuple[str, dict[str, Any], type[Exception], Any]] = [
    ("quotient", {"x": 1.0, "y": 0.0}, ZeroDivisionError, INF),
    ("quotient", {"x": 1.0, "y": -0.0}, ZeroDivisionError, -INF),
    ("quotient", {"x": 0.0, "y": 0.0}, ZeroDivisionError, NAN),
    ("int_quotient", {"n": -3, "m": 0}, ZeroDivisionError, -INF),
    ("int_quotient", {"n": 0, "m": 0}, ZeroDivisionError, NAN),
    ("root", {"x": -1.0}, ValueError, NAN),
    ("logarithm", {"x": 0.0}, ValueError, -INF),
    ("logarithm", {"x": -1.0}, ValueError, NAN),
    ("sine", {"x": INF}, ValueError, NAN),
    ("arc", {"x": 1.5}, ValueError, NAN),
    ("power_of_e", {"x": 1e3}, OverflowError, INF),
    ("whole_quotient", {"n": 7, "m": 0}, ZeroDivisionError, 0),
    ("rest", {"n": 7, "m": 0}, ZeroDivisionError, 0),
    *((name, {"x": NAN}, ValueError, 0) for name in ("truncated", "floored", "raised", "rounded")),
    *((name, {"x": INF}, OverflowError, LARGEST) for name in ("truncated", "floored", "raised", "rounded")),
    *((name, {"x": -INF}, OverflowError, SMALLEST) for name in ("truncated", "floored", "raised", "rounded")),
    ("item", {"n": 7}, IndexError, 3.0),
    ("item", {"n": 3}, IndexError, 3.0),
    ("item", {"n": -4}, IndexError, 1.0),
    ("item", {"n": SMALLEST}, IndexError, 1.0),
    ("item", {"n": LARGEST}, IndexError, 3.0),
    ("shifted_left", {"n": 5, "m": -1}, ValueError, 0),
    ("shifted_right", {"n": 5, "m": -1}, ValueError, 0),
]
TABLE = """\
| Python raises | C gives |
|---|---|
| `x / 0.0`, `n / 0`, `math.exp(1e3)` | infinite or NaN |
| `math.sqrt(-1.0)`, `math.log(0.0)`, `math.sin(inf)`, `math.acos(1.5)` | infinite or NaN |
| `n // 0`, `n % 0` | 0 |
| `int(x)`, `math.floor(x)`, `math.ceil(x)`, `round(x)` of NaN; of infinite | 0; the nearest 64-bit integer |
| `xs[i]` out of range | the nearest item; C never reads memory outside |
| a negative shift | 0 |
| an integer out of the range of its store column | the nearest value in range |
"""


@pytest.fixture(scope="module")
def twins(tmp_path_factory: pytest.TempPathFactory) -> Any:
    functions = (
        f"def {name}({SIGNATURE}) -> {kind}:\n    return {text}\n" for name, (kind, text) in EXPRESSIONS.items()
    )
    return Twins("\n\n".join(functions), tmp_path_factory.mktemp("raising"), "raising_functions")


@pytest.mark.parametrize(("name", "values", "error", "expected"), CASES)
def test_c_goes_on_where_python_raises(
    twins: Any, name: str, values: dict[str, Any], error: type[Exception], expected: Any
) -> None:
    inputs = Inputs(**values)
    with pytest.raises(error):
        getattr(twins.module, name)(*inputs)
    twins.c.step(twins.module.In(*inputs), 0)
    found = getattr(twins.c.outputs, name)
    assert found == expected or (math.isnan(expected) and math.isnan(found))


def test_all_of_it_is_in_the_page() -> None:
    assert TABLE in PAGE.read_text("utf-8")
    assert {name for name, *_ in CASES} == EXPRESSIONS.keys()
