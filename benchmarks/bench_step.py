"""Cost of one co-simulation step of the pair, all signals exchanged, in every way we can drive it; side by side.

Case 4 with its step of 10 ms, run to the same number of steps each time, in turn; medians. The limit is the
same machine code without any FMI between, and hands over connected signals only. Last, whole runs: case 4 up to
its end, recorded and written to a log, from initialization on.
"""

import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level

from benchmarks.results import record, size
from benchmarks.rounds import in_turn, new_log
from fmus.compiled_batch import compile_rows
from fmus.systems.ssp import write_ssp
from modelkit.variables import variables, with_values
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.presentation.export.system_of import system_of
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.algorithm import CoSimulation
from orchestrator.simulation.cosim.compiled_master import CompiledMaster
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.simulation.cosim.local_instance import LocalInstance

MOST_ROUNDS = size(15, 1)
STEPS = size(2000, 50)
PAIRS = size(60, 1)
Files = dict[str, Path]
Loop = Callable[[], float]
"""Drives STEPS steps and returns the seconds they took, without loading and initializing."""


def master_loop(make: type[CoSimulation], files: Files, scenario: Scenario, clock: Loop = time.perf_counter) -> Loop:
    """Return a loop by one of our masters."""

    def loop() -> float:
        instances = [
            LocalInstance(name, path, getattr(scenario, name), lambda *_: None, MODELS[name])
            for name, path in files.items()
        ]
        master = make(list(instances), scenario.step_ns, STEPS * scenario.step_ns)
        master.initialize()
        begun = clock()
        master.run()
        taken = clock() - begun
        master.free()
        return taken

    return loop


def libcosim_loop(ssp: Path) -> Loop:
    """Return a loop by libcosim, inside its C++ code."""

    def loop() -> float:
        execution = CosimExecution.from_ssp_file(ssp_path=str(ssp))
        execution.step(1)
        begun = time.perf_counter()
        execution.step(STEPS)
        return time.perf_counter() - begun

    return loop


def in_process_loop(scenario: Scenario, clock: Loop = time.perf_counter) -> Loop:
    """Return the limit: the models' machine code and the exchange in one compiled loop, no FMI."""
    rows = compile_rows(MODELS, None, [])
    values = [
        float(item.start)
        for name, model in MODELS.items()
        for item in variables(model.params, with_values(model.params, getattr(scenario, name)))
    ]
    parameters = np.array([values])
    times = np.array([[scenario.step_ns, STEPS * scenario.step_ns, 1, 1]], dtype=np.int64)
    faults, out = np.empty((1, 0)), np.empty((1, 2))

    def loop() -> float:
        begun = time.perf_counter()
        rows(parameters, times, faults, out)
        return time.perf_counter() - begun

    return loop


def main() -> None:
    """Print both tables."""
    log_output_level(CosimLogLevel.FATAL)
    scenario = load_scenario("guo2015-case4", [])
    python, native = (fmu_files(kind, print) for kind in ("python", "native"))
    folder = Path(tempfile.mkdtemp(prefix="apa_bench_"))
    loops = {
        "PythonFMUs, our Python master": master_loop(CoSimulation, python, scenario),
        "native, FMI calls from Python": master_loop(CoSimulation, native, scenario),
        "native, libcosim": libcosim_loop(write_ssp(system_of(scenario, folder, "native"), folder / "native.ssp")),
        "native, compiled master": master_loop(CompiledMaster, native, scenario),
        "limit: no FMI at all": in_process_loop(scenario),
    }
    times = in_turn(loops, MOST_ROUNDS)
    median = {name: statistics.median(values) / STEPS * 1e6 for name, values in times.items()}
    least = {name: min(values) / STEPS * 1e6 for name, values in times.items()}
    ours = median["native, compiled master"]
    print(f"one step of the pair, {STEPS} steps, median (and least) of {len(times['native, libcosim'])} rounds")
    for name, cost in median.items():
        record(f"one step, {name}", cost, "us")
        print(f"  {name:30} {cost:8.2f} us ({least[name]:8.2f})  {cost / ours:8.2f} times the compiled master")
    master_to_limit(scenario, native)
    whole_runs(scenario, python, native, folder)


def master_to_limit(scenario: Scenario, native: Files) -> None:
    """Print what the compiled master takes over the limit, by processor time: it holds on a busy machine."""
    loops = (
        master_loop(CompiledMaster, native, scenario, time.process_time),
        in_process_loop(scenario, time.process_time),
    )
    pairs = [[loop() / STEPS * 1e9 for loop in loops] for _ in range(PAIRS)]
    master, limit = (min(pair[side] for pair in pairs) for side in (0, 1))
    record("one step, compiled master, least processor time", master, "ns")
    record("one step, no FMI at all, least processor time", limit, "ns")
    print(
        f"processor time, the quickest of {PAIRS} rounds: compiled master {master:.0f} ns, limit {limit:.0f} ns", end=""
    )
    print(f", {master / limit:.2f} times (median {statistics.median(one / other for one, other in pairs):.2f})")


def whole_runs(scenario: Scenario, python: Files, native: Files, folder: Path) -> None:
    """Print wall times of case 4 to its end, recorded, without and with the log."""
    kinds = {"python": python, "native": native}

    def run(kind: str, is_logged: bool) -> Loop:
        return lambda: (
            run_scenario(scenario, kinds[kind], kind=kind, log=new_log(folder) if is_logged else None).wall_time
        )

    asked = {"without log": False, "with the log": True}
    walls = in_turn({f"{kind} {what}": run(kind, log) for what, log in asked.items() for kind in kinds}, MOST_ROUNDS)
    print(f"case 4 to its end, recorded; medians of {len(walls['native with the log'])}")
    for what in asked:
        one, other = (statistics.median(walls[f"{kind} {what}"]) * 1e3 for kind in kinds)
        record(f"case 4 to its end, PythonFMUs, {what}", one, "ms")
        record(f"case 4 to its end, native FMUs, {what}", other, "ms")
        print(f"  {what:14} PythonFMUs {one:7.1f} ms   native {other:7.1f} ms   {one / other:5.1f} times faster")


if __name__ == "__main__":
    main()
