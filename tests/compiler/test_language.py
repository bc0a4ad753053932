"""Every construct of the language gives CPython's bits in C."""

import itertools
import math
from pathlib import Path
from typing import Any

import pytest

from tests.compiler.c_model import COMPILER
from tests.compiler.language import Twins, results

TEXT = (Path(__file__).parent / "constructs.py").read_text().split('"""', 2)[2].split("# ---- types", 1)[1]
NAMES = [name for name, _ in results(TEXT)]
FLOATS = (0.0, -0.0, 1.0, -1.5, 2.5, 0.3, 1e-310, 1e300, -7.25, math.inf, -math.inf, math.nan, 2.0**53, 4.5)
INTS = (0, 1, -1, 5, 7, -2, 3, 2**31, -(2**31), 2**53 + 1, -(2**53) - 1, 123456789012, -8, 2**59 + 12345)


@pytest.fixture(scope="module")
def twins(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return Twins("# ---- types" + TEXT, tmp_path_factory.mktemp("language"), "constructs_under_test")


def samples() -> Any:
    """Return inputs that meet each pair of special values, and both truths."""
    floats = list(itertools.product(FLOATS, FLOATS))
    ints = list(itertools.product(INTS, INTS))
    return [
        (*floats[k % len(floats)], *ints[(5 * k) % len(ints)], k % 2 == 0, k % 3 == 0)
        for k in range(2 * len(floats))
    ]  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_construct_gives_the_bits_of_cpython(twins: Any, name: Any) -> None:
    before = twins.raised
    differing = [line for inputs in samples() for line in twins.differing(inputs, only=name)]
    assert differing[:5] == []
    assert twins.raised - before < 0.95 * len(samples())


def test_there_is_a_compiler() -> None:
    assert COMPILER
