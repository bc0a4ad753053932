"""Slices of models: what they omit, and that what they keep has the same bits."""

import math
import subprocess
from pathlib import Path
from typing import NamedTuple

import pytest

import tests.compiler.test_slicing as here
from controller_fmu import MODEL as CONTROLLER
from fmus.compiler import Translation, live_inputs, translate
from fmus.compiler.slicing import Slice
from fmus.native.compilers import FLAGS, LINUX_ALONE, find_compiler
from fmus.native.platforms import host_target
from fmus.native.sources import translate_model
from modelkit.model import Model
from modelkit.variables import variables
from vehicle_fmu import MODEL as VEHICLE


class Filter(NamedTuple):
    """A memory that only one output needs."""

    mean: float = 0.0
    samples: int = 0


class State(NamedTuple):
    """What the model remembers."""

    x: float = 1.0
    filter: Filter = Filter()


class Inputs(NamedTuple):
    """Inputs."""

    rate: float = 1.0
    noise: float = 0.0


class Params(NamedTuple):
    """Parameters."""

    gain: float = 2.0
    limit: float = 5.0


class Outputs(NamedTuple):
    """Outputs."""

    x: float = 0.0
    mean: float = 0.0
    far: bool = False


def averaged(old: Filter, value: float) -> Filter:
    """Return the mean with one more value."""
    mean = (old.mean * old.samples + math.exp(value)) / (old.samples + 1)
    return Filter(mean, old.samples + 1)


def limited(x: float, limit: float) -> tuple[float, bool]:
    """Return ``x`` within ``limit``, and whether it was beyond."""
    beyond = False
    for _ in range(3):
        if x > limit:
            x = x - 1.0
            beyond = True
    return x, beyond


def initialize(params: Params) -> tuple[State, Outputs]:
    """Return the start."""
    return State(), Outputs(x=1.0)


def step(state: State, inputs: Inputs, params: Params, dt_ns: int) -> tuple[State, Outputs]:
    """Return the next state."""
    x, beyond = limited(state.x + params.gain * inputs.rate * dt_ns * 1e-9, params.limit)
    kept = state.filter
    if inputs.noise > 0.0:
        kept = averaged(kept, inputs.noise)
    return State(x, kept), Outputs(x, kept.mean, beyond)


MODEL = Model("Sliced", "a model", here, State, Params, Inputs, Outputs, initialize, step, 0.01, 1.0)
MAIN = """
#include <stdio.h>
#include "Sliced.h"
int main(void) {
    static Sliced m;
    Sliced_defaults(&m.params, &m.inputs);
    Sliced_initialize(&m.params, &m.state, &m.outputs);
    for (int k = 0; k < 500; k++) {
        m.inputs.noise = (k % 3) * 0.1;
        Sliced_step(&m.state, &m.inputs, &m.params, 10000000, &m.outputs);
        printf("%a %a %d\\n", m.outputs.x, m.outputs.mean, m.outputs.far);
    }
    return 0;
}
"""


@pytest.mark.parametrize(
    ("live", "absent", "inputs"),
    [
        ({"x"}, ("averaged", "exp("), {"rate"}),
        ({"far"}, ("averaged", "exp("), {"rate"}),
        ({"mean"}, ("limited",), {"noise"}),
        ({"x", "mean", "far"}, (), {"rate", "noise"}),
        (set(), ("averaged", "limited"), set()),
    ],
)
def test_slices_omit_what_only_dead_outputs_need(live: set[str], absent: tuple[str, ...], inputs: set[str]) -> None:
    source = translate(MODEL, Slice(frozenset(live))).source
    assert all(word in translate(MODEL).source for word in absent)
    assert not [word for word in absent if word in source]
    assert live_inputs(MODEL, Slice(frozenset(live))) == inputs


def test_live_outputs_of_a_slice_have_the_same_bits(tmp_path: Path) -> None:
    whole = printed(translate(MODEL), tmp_path / "whole")
    for live, columns in (({"x"}, [0]), ({"mean"}, [1]), ({"far"}, [2]), ({"x", "far"}, [0, 2])):
        sliced = printed(translate(MODEL, Slice(frozenset(live))), tmp_path / "_".join(sorted(live)))
        assert [[row[at] for at in columns] for row in sliced] == [[row[at] for at in columns] for row in whole]
        dead = [at for at in range(3) if at not in columns and len({row[at] for row in whole}) > 1]
        assert all({row[at] for row in sliced} != {row[at] for row in whole} for at in dead)


def test_the_vehicle_without_sensors_measures_nothing() -> None:
    used = frozenset(item.name for item in variables(VEHICLE.outputs) if not item.name.startswith("ultrasonic"))
    whole, sliced = translate_model(VEHICLE), translate_model(VEHICLE, Slice(used))
    assert "cone_gap(" in whole.source
    assert "cone_gap(" not in sliced.source
    assert sliced.header == whole.header, "the layout stays"


def test_a_system_reads_its_own_inputs_only() -> None:
    assert not [name for name in live_inputs(CONTROLLER, Slice(frozenset({"steering_wheel_request"}), frozenset({0})))
                if name.startswith("ultrasonic")]  # fmt: skip
    chosen = translate(CONTROLLER, Slice(frozenset({"steering_wheel_request"}), frozenset({0}))).source
    assert len(chosen) < 0.25 * len(translate_model(CONTROLLER).source)


def printed(code: Translation, folder: Path) -> list[list[str]]:
    """Return the words that a program of a translation prints, line by line."""
    folder.mkdir()
    for file, text in {"Sliced.h": code.header, "Sliced.c": code.source, "main.c": MAIN}.items():
        (folder / file).write_text(text)
    compiler = find_compiler()
    alone = LINUX_ALONE if compiler.is_zig and "linux" in host_target().triple else ()
    compiler.run([*FLAGS, "-o", "main", "main.c", "Sliced.c", "-lm", *alone], folder)
    text = subprocess.run([str(folder / "main")], capture_output=True, text=True, check=True).stdout
    return [line.split() for line in text.splitlines()]
