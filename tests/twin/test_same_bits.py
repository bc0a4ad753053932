"""Python in process, PythonFMU, native FMU, compiled master: the same bits in every signal of every scenario."""

from pathlib import Path

import numpy as np
import pytest

import orchestrator
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario

SCENARIOS = sorted(path.stem for path in (Path(orchestrator.__file__).parent / "scenarios").glob("*.yaml"))
PYTHON_FMU_TOO = ("guo2015-case4", "guo2015-case4-105", "fault-pose-nan", "fault-driver-takes-over")
"""The PythonFMU runs the very functions that run in process, so some scenarios are enough for it."""


def differing(one, other):
    """Return the signals whose bits differ, with the first row in which they do."""
    assert one.signals.keys() == other.signals.keys()
    assert np.array_equal(one.t_ns, other.t_ns)
    found = {}
    for name, values in one.signals.items():
        same = np.ascontiguousarray(values).view(np.int64) == np.ascontiguousarray(other.signals[name]).view(np.int64)
        same |= np.isnan(values) & np.isnan(other.signals[name])
        if not same.all():
            found[name] = int(np.argmin(same))
    return found


@pytest.mark.parametrize("name", SCENARIOS)
def test_native_fmus_and_compiled_master_equal_the_models_in_process(fmus, name):
    scenario = load_scenario(name, [])
    expected, found = run_scenario(scenario), run_scenario(scenario, fmus["native"], kind="native")
    assert found.end == expected.end
    assert differing(found.recording, expected.recording) == {}


@pytest.mark.parametrize("name", PYTHON_FMU_TOO)
def test_native_fmus_equal_python_fmus(fmus, name):
    scenario = load_scenario(name, [])
    expected = run_scenario(scenario, fmus["python"], kind="python")
    found = run_scenario(scenario, fmus["native"], kind="native")
    assert found.end == expected.end
    assert len(found.recording.t_ns) > 100
    assert differing(found.recording, expected.recording) == {}
