"""A type checker holds a model's functions against its types, and a system's three against one another."""

from pathlib import Path

import pytest
from mypy import api

ROOT = Path(__file__).parents[2]
START = """
import sys
from enum import IntEnum
from typing import NamedTuple
from modelkit.model import Model, SampledSystem

class State(NamedTuple):
    x: float = 0.0

class Params(NamedTuple):
    k: float = 1.0

class Input(NamedTuple):
    u: float = 0.0

class Output(NamedTuple):
    y: float = 0.0

def initialize(params: Params) -> tuple[State, Output]:
    return State(), Output()

def step(state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    return state, Output()

def start(params: Params) -> State:
    return State()

def sample(own: State, inputs: Input, params: Params, period_ns: int) -> State:
    return own

def outputs(own: State, params: Params) -> Output:
    return Output()

def other_outputs(own: Input, params: Params) -> Output:
    return Output()

def swapped(state: State, inputs: Params, params: Input, dt_ns: int) -> tuple[State, Output]:
    return state, Output()

def careless(params: Params) -> tuple[State, Params]:
    return State(), params

class Choice(IntEnum):
    OWN = 0

here = sys.modules[__name__]
"""
MODEL = 'Model("M", "", here, State, Params, Input, Output, {initialize}, {step}, 0.01, 1.0)'


def mistakes(folder: Path, line: str) -> str:
    (folder / "wrong.py").write_text(f"{START}\nmade = {line}\n")
    cache = str(ROOT / ".mypy_cache" / "typed")
    found, _, _ = api.run(["--strict", "--cache-dir", cache, "--no-error-summary", str(folder / "wrong.py")])
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("line", "fits"),
    [
        (MODEL.format(initialize="initialize", step="step"), True),
        (MODEL.format(initialize="initialize", step="swapped"), False),
        (MODEL.format(initialize="careless", step="step"), False),
        ('SampledSystem("own", Choice, ("",), State, Params, Input, Output, start, sample, outputs)', True),
        ('SampledSystem("own", Choice, ("",), State, Params, Input, Output, start, sample, other_outputs)', False),
    ],
)
def test_functions_and_types_of_a_model_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: str, fits: bool
) -> None:
    monkeypatch.setenv("MYPYPATH", str(ROOT))
    found = mistakes(tmp_path, line)
    assert found == "" if fits else "error: " in found, found
