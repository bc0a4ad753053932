"""WebAssembly against the native FMUs, and against the same C with the same mathematics library on this machine."""

import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from live_module import STANDSTILL, STOP_TIME, LiveModule, disturbed, names_of, parameters, setup, times_of

from fmus.native.platforms import CompileTarget
from fmus.native.web import live_library
from orchestrator.cosim.fmu_files import fmu_files
from orchestrator.live.situation import shipped
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.scenario.models import MODELS
from orchestrator.session.session import run_scenario

SHIPPED = [scenario.name for scenario in (*shipped(), *shipped("valet"))]
WITHIN = {"preview-geometry": 1e-3}
"""Largest difference of a signal [SI]. 960 m in a loop of high gain: wheel 5e-5 rad, force 1e-3 N, pose 5e-7 m."""
GROWS = "preview-camera"
"""A loop on the edge, with a picture 20 ms old: it swings, and grows the last bit of a sine to centimetres."""
STATIC = CompileTarget("x86_64-linux-musl", ("-static", "-Wl,-s"))


@pytest.fixture(scope="module")
def run_of_page():
    modules = cache(lambda models: LiveModule(dict(models)))

    def run(scenario):
        names = names_of(scenario)
        return names, *modules(tuple(scenario.models.items())).run(scenario, names)

    return run


@pytest.mark.parametrize("name", [name for name in SHIPPED if name != GROWS])
def test_runs_as_the_native_fmus_do(name, run_of_page):
    scenario = load_scenario(name)
    recording = run_scenario(scenario, fmu_files("native"), kind="native").recording
    names, end, lines = run_of_page(scenario)
    assert end == {"stop_time": STOP_TIME, "standstill": STANDSTILL}[recording.info["end"]["reason"]]
    assert (lines[:, 0] == recording.t).all()
    assert set(recording.signals) <= set(names)
    for signal, theirs in recording.signals.items():
        ours = lines[:, 1 + names.index(signal)]
        exact = recording.variables[signal].kind is not float
        within = 0.0 if exact else WITHIN.get(name, 1e-6)
        with np.errstate(invalid="ignore"):
            is_near = bool((np.abs(ours - theirs) <= within).all())  # quicker than what says where
        if not is_near:
            np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=within, equal_nan=True, err_msg=signal)


@pytest.fixture(scope="module")
def static(tmp_path_factory):
    main = (Path(__file__).parent / "static.c").read_text(encoding="utf-8")
    built = live_library(MODELS, STATIC, ".program", {"main_unit.c": main})
    program = tmp_path_factory.mktemp("static") / "live"
    program.write_bytes(built.read_bytes())
    program.chmod(0o755)
    return program


@pytest.mark.parametrize(
    "name", ["guo2015-case4", "apa-parallel-real", "zhang2022-double-track", "fault-pose-noise", GROWS]
)
def test_has_the_bits_of_this_machine_with_the_same_mathematics_library(name, static, run_of_page):
    scenario = load_scenario(name)
    names, end, lines = run_of_page(scenario)
    room = scenario.stop_ns // scenario.step_ns + 1
    parts = [
        setup(scenario, names),
        parameters(scenario),
        times_of(scenario),
        disturbed(scenario),
        [room, 1 + len(names)],
    ]
    sent = b"".join(np.array([len(part), *part], dtype=float).tobytes() for part in parts)
    done = subprocess.run([static], input=sent, capture_output=True, check=True)
    found = np.frombuffer(done.stdout, dtype=float)
    assert found[0] == end
    assert found[2:].tobytes() == lines.tobytes()
