"""The shipped models in C give CPython's bits: every state and output, at every step of closed-loop runs."""

from pathlib import Path
from typing import Any

import pytest

from fmus.native.sources import translate_model
from modelkit.variables import flatten
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.session.session import run_scenario
from tests.compiler.c_model import WARNINGS, ZIG, CModel, compiled

SCENARIOS = {
    "guo2015-case4-105": ("stop_time=10",),
    "zhang2022-double-track": ("stop_time=5",),
    "hsic-straight": ("stop_time=12",),
    "preview": ("stop_time=1.5",),
    "adaptive": (),
    "fault-pose-nan": (),
}
"""Every system of the shared controller and every body of the vehicle, with what is set to make the run short.

Controllers that are models of their own, as parking is, are compared by all their outputs in ``tests/twin``.
"""
EACH_CHANGE = ("guo2015-case4-105", "zhang2022-double-track")
"""The outputs of the others, at every step, are those of the same C in ``tests/twin/test_same_bits.py``."""


@pytest.fixture(scope="module")
def translations() -> Any:
    return {name: translate_model(model) for name, model in MODELS.items()}


@pytest.fixture(scope="module")
def in_c(translations: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Place in a run -> the model compiled."""
    folder = tmp_path_factory.mktemp("c")
    return {name: CModel(model, translations[name], folder) for name, model in MODELS.items()}


def watched(model: Any, twin: Any) -> Any:
    """Return ``model`` whose functions also step ``twin`` and compare."""

    def initialize(params: Any) -> Any:
        state, outputs = model.initialize(params)
        twin.initialize(params)
        assert twin.differing(state, outputs) == []
        twin.steps = 0
        return state, outputs

    def step(state: Any, inputs: Any, params: Any, dt_ns: Any) -> Any:
        state, outputs = model.step(state, inputs, params, dt_ns)
        twin.step(inputs, dt_ns)
        assert twin.differing(state, outputs) == []
        twin.steps += 1
        return state, outputs

    return model._replace(initialize=initialize, step=step)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in EACH_CHANGE else pytest.mark.release) for name in SCENARIOS]
)
def test_closed_loop_in_c_equals_cpython(name: Any, in_c: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    for place, model in MODELS.items():
        monkeypatch.setitem(MODELS, place, watched(model, in_c[place]))
    scenario = load_scenario(name, list(SCENARIOS[name]))
    assert set(scenario.models.values()) == set(MODELS.values())
    ran = run_scenario(scenario)
    assert not ran.end.reason.startswith("error"), ran.end
    assert all(twin.steps > 100 for twin in in_c.values())


def test_start_values_are_the_defaults_of_the_types(in_c: Any) -> None:
    for twin in in_c.values():
        params, inputs = twin.defaults()
        assert list(params) == flatten(twin.model.params())
        assert list(inputs) == flatten(twin.model.inputs())


def test_both_headers_may_be_included_in_one_file(translations: Any, tmp_path: Path) -> None:
    for item in translations.values():
        (tmp_path / f"{item.name}.h").write_text(item.header)
    text = '#include "Vehicle.h"\n#include "Controller.h"\nVehicle vehicle;\nController controller;\n'
    (tmp_path / "both.c").write_text(text)
    compiled(tmp_path, "both", "both.c")


def test_the_other_compiler_has_nothing_to_say(translations: Any, tmp_path: Path) -> None:
    """``in_c`` is compiled by the first one with the same warnings."""
    for item in translations.values():
        (tmp_path / f"{item.name}.h").write_text(item.header)
        (tmp_path / f"{item.name}.c").write_text(item.source)
        ZIG.run(["-std=c99", "-O0", *WARNINGS, "-c", f"{item.name}.c", "-o", "unit.o"], tmp_path)
