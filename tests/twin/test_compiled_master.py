"""The compiled master is the Python master, block by block: recordings, endings, errors, multi-rate, threads."""

import threading
from typing import Any

import pytest

from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import RunError
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim import compiled_master
from orchestrator.simulation.cosim.algorithm import CoSimulation
from orchestrator.simulation.cosim.compiled_master import CompiledMaster
from orchestrator.simulation.cosim.local_instance import LocalInstance
from tests.twin.test_same_bits import differing

NAME = "guo2015-case4-105"


def both(files: Any, *changes: Any) -> Any:
    """Return the same run by the Python master and by the compiled one."""
    scenario = load_scenario(NAME, list(changes))
    return run_scenario(scenario, files, kind="python"), run_scenario(scenario, files, kind="native")


@pytest.fixture
def loops(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The compiled calls made, as numbers of rows."""
    calls = []
    advance = compiled_master._Plan.advance

    def counted(self: Any, first: Any) -> Any:
        calls.append(advance(self, first))
        return calls[-1]

    monkeypatch.setattr(compiled_master._Plan, "advance", counted)
    return calls


@pytest.mark.parametrize("kind", ["native", "python"])
def test_whole_run(fmus: Any, loops: Any, kind: str) -> None:
    expected, found = both(fmus[kind], "stop_time=12")
    assert found.end == expected.end
    assert differing(found.recording, expected.recording) == {}
    assert sum(loops) == len(found.recording.t_ns) == 1201
    assert set(loops[:-1]) == {compiled_master.EXCHANGES_PER_CALL}


def test_an_ending_in_mid_block(fmus: Any, loops: Any) -> None:
    expected, found = both(fmus["native"])
    assert found.end == expected.end
    assert found.end.reason == "standstill"
    assert len(found.recording.t_ns) == len(expected.recording.t_ns) < sum(loops)


def test_multi_rate(fmus: Any, loops: Any) -> None:
    expected, found = both(fmus["native"], "stop_time=12", "decimation.controller=3")
    assert differing(found.recording, expected.recording) == {}
    assert loops


@pytest.mark.parametrize("kind", ["native", "python"])
def test_the_last_step_ends_at_the_stop_time(fmus: Any, loops: Any, kind: str) -> None:
    expected, found = both(fmus[kind], "stop_time=1.0137", "decimation.controller=3", "decimation.vehicle=7")
    assert found.end == expected.end == ("stop_time", 1_013_700_000)
    assert differing(found.recording, expected.recording) == {}
    assert loops


def test_faults_take_the_python_loop(fmus: Any, loops: Any) -> None:
    scenario = load_scenario("fault-pose-frozen", ["stop_time=3"])
    assert run_scenario(scenario, fmus["native"], kind="native").end.t_ns > 0
    assert loops == []


def slaves(files: Any, log: Any) -> Any:
    return [LocalInstance(name, path, {}, log) for name, path in files.items()]


class Seen:
    """Observer that counts."""

    def __init__(self) -> None:
        self.times: list[int] = []

    def on_communication_point(self, t_ns: Any) -> None:
        self.times.append(t_ns)

    def closed(self, end: Any) -> None:
        self.end = end


def drive(make: Any, files: Any, after: Any = None) -> Any:
    """Run 3 s with ``make``'s master; ``after`` may break something once time is zero. Return times, error, log."""
    log = []
    master = make(slaves(files, lambda *words: log.append(words)), 10_000_000, 3_000_000_000)
    seen = Seen()
    master.observers.append(seen)
    error = ""
    try:
        master.initialize()
        if after is not None:
            after(master)
        master.run()
    except RunError as raised:
        error = str(raised)
    finally:
        master.free()
    return seen.times, error, log


@pytest.mark.parametrize("stop_ns", [4_990_000_000, 6_500_000_000, 6_510_000_000])
def test_a_run_that_nobody_watches_ends_with_the_same_values(fmus: Any, stop_ns: int) -> None:
    ends = []
    for make in (CoSimulation, CompiledMaster):
        master = make(list(slaves(fmus["native"], print)), 10_000_000, stop_ns)
        try:
            master.initialize()
            assert master.run() == ("stop_time", stop_ns)
            ends.append(master.values.tobytes())
        finally:
            master.free()
    assert ends[0] == ends[1]


def break_vehicle(master: Any) -> None:
    """Bring the vehicle 1.5 s ahead of the master's clock."""
    master.instances[0].step(0, 1_500_000_000)


def test_a_refused_step_ends_the_run_with_the_fmus_words(fmus: Any) -> None:
    expected, found = (
        drive(CoSimulation, fmus["native"], break_vehicle),
        drive(CompiledMaster, fmus["native"], break_vehicle),
    )
    assert found == expected
    assert found[0] == [0]
    assert "vehicle failed at 0 s: fmi2DoStep: called at 0.0" in found[1]


def test_runs_on_several_threads_at_once(fmus: Any) -> None:
    expected = run_scenario(load_scenario(NAME, ["stop_time=12"]), fmus["native"], kind="native").recording
    found = {}

    def job(number: Any) -> None:
        scenario = load_scenario(NAME, ["stop_time=12"])
        found[number] = run_scenario(scenario, fmus["native"], kind="native").recording

    threads = [threading.Thread(target=job, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4
    assert all(differing(recording, expected) == {} for recording in found.values())


def test_without_a_compiler_the_python_loop_does_it(fmus: Any, monkeypatch: pytest.MonkeyPatch, loops: Any) -> None:
    def absent() -> None:
        raise RuntimeError("no compiler")

    monkeypatch.setattr("fmus.native.library_cache.master_library", absent)
    times, error, _ = drive(CompiledMaster, fmus["native"])
    assert (len(times), error, loops) == (301, "", [])
