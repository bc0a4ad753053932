"""Random programs of the model language run in CPython and in C: the same bits for any input."""

import itertools
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from tests.compiler.language import Twins
from tests.compiler.programs import programs

numbers = itertools.count()
FLOATS = st.floats() | st.sampled_from((0.0, -0.0, 1.0, -1.0, 0.5, 2.5, 1e308, 5e-324, float("inf"), float("nan")))
INTS = st.integers(-(2**31), 2**31) | st.integers(-4, 12)
INPUTS = st.tuples(FLOATS, FLOATS, INTS, INTS, st.booleans(), st.booleans())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return tmp_path_factory.mktemp("programs")


@settings(
    max_examples=4,
    derandomize=True,
    database=None,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)
@given(programs(functions=12), st.lists(INPUTS, min_size=30, max_size=30))
def test_random_programs_give_the_bits_of_cpython(folder: Any, text: Any, inputs: Any) -> None:
    twins = Twins(text, folder, f"program_{next(numbers)}", warnings=("-w",))
    assert [line for item in inputs for line in twins.differing(item)] == []
