"""Studies: manoeuvres a second, ratio to running FMUs, what the sweep adds to the model, growth with their number.

Rates are wall time on an idle machine; the processor time beside them holds on a busy one too.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.results import record, size
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.studies.sweep.batch import compile_models, run_batch
from orchestrator.studies.sweep.disturbed import fault_numbers
from orchestrator.studies.sweep.engine import cores
from orchestrator.studies.sweep.job import Chunk, arrays, make_job
from orchestrator.studies.sweep.rows import FIRST_MEASURE
from orchestrator.studies.sweep.study.read_study import bind
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.study.study_file import StudyFile
from orchestrator.studies.sweep.sweep import Options, sweep

REPEATS = size(5, 1)
MANOEUVRES = size(2000, 20)
SIZES = size((1_000, 10_000, 100_000), (20,))
SHORT = 0.5
"""Length of the runs whose number is grown [s]."""


def study(count: int, **changes: Any) -> Study:
    runs = {"monte_carlo": {"n": count, "vehicle.start.y": {"uniform": [-0.01, 0.01]}}}
    return bind(StudyFile(name="bench", scenario="guo2015-case4", runs=runs, set=changes))


def bound(count: int, **changes: Any) -> tuple[Any, Chunk]:
    chosen = study(count, **changes)
    return make_job(chosen), Chunk(0, 0, chosen.design.values, chosen.design.seeds)


def measured(work: Callable[[], object], repeats: int = REPEATS) -> tuple[float, float]:
    """Return the medians of (wall, processor) time [s]."""
    walls, processors = [], []
    for _ in range(repeats):
        wall, processor = time.perf_counter(), time.process_time()
        work()
        walls.append(time.perf_counter() - wall)
        processors.append(time.process_time() - processor)
    return statistics.median(walls), statistics.median(processors)


def in_threads(rows: Any, parts: list[tuple[Any, Any, Any, Any]]) -> None:
    with ThreadPoolExecutor(cores()) as pool:
        list(pool.map(lambda part: rows(*part), parts))


def rates() -> None:
    job, chunk = bound(MANOEUVRES)
    begun = time.perf_counter()
    model = Scenario(**job.scenario)
    rows = compile_models(tuple(job.measures), model)
    print(f"models ready after {time.perf_counter() - begun:.1f} s (compiled once per source, then kept)")
    (parameters, times), faults = arrays(job, chunk), fault_numbers(job, chunk, model)
    out = np.empty((MANOEUVRES, FIRST_MEASURE + len(job.measures)))
    share = max(1, MANOEUVRES // (4 * cores()))
    places = [slice(at, at + share) for at in range(0, MANOEUVRES, share)]
    parts = [(parameters[place], times[place], faults[place], out[place]) for place in places]
    wall, processor = measured(lambda: rows(parameters, times, faults, out))
    record("case-4 manoeuvre, compiled, processor time", 1e3 * processor / MANOEUVRES, "ms")
    record("case-4 manoeuvres, compiled, one thread", MANOEUVRES / wall, "1/s")
    print(f"compiled, one thread       {MANOEUVRES / wall:8.0f} case-4 manoeuvres a second, "
          f"{1e3 * processor / MANOEUVRES:.2f} ms of processor each")  # fmt: skip
    many, processor = measured(lambda: in_threads(rows, parts))
    print(f"compiled, {cores()} threads        {MANOEUVRES / many:8.0f} a second, "
          f"{1e3 * processor / MANOEUVRES:.2f} ms of processor each")  # fmt: skip
    record(f"case-4 manoeuvres, compiled, {cores()} threads", MANOEUVRES / many, "1/s")
    steps = float(out[:, 1].sum()) / 1e7
    record("one exchange and step of the pair, processor time", 1e9 * processor / steps, "ns")
    print(f"one exchange and step of the pair: {1e9 * processor / steps:.0f} ns of processor")
    scenario = load_scenario("guo2015-case4")
    for kind in ("python", "native"):
        files = fmu_files(kind)
        alone, burnt = measured(lambda files=files, kind=kind: run_scenario(scenario, files, kind=kind), 3)
        record(f"case-4 manoeuvre, {kind} FMUs, processor time", 1e3 * burnt, "ms")
        print(f"{kind:6} FMUs, one process   {1.0 / alone:8.1f} a second, {1e3 * burnt:.0f} ms of processor each; "
              f"the batch needs {burnt * MANOEUVRES / processor:.0f} times less")  # fmt: skip


def overhead() -> None:
    job, chunk = bound(MANOEUVRES)
    model, mine = measured(lambda: run_batch(job, chunk))

    def whole() -> None:
        with tempfile.TemporaryDirectory() as folder:
            sweep(study(MANOEUVRES), Path(folder), Options(workers=1))

    wall, processor = measured(whole)
    record("processor time a sweep adds to its runs", 100.0 * (processor / mine - 1.0), "%")
    print(f"sweep of {MANOEUVRES} on one thread: {processor:.2f} s of processor, the runs alone {mine:.2f} s: "
          f"{100.0 * (processor / mine - 1.0):+.1f} % (wall {100.0 * (wall / model - 1.0):+.1f} %)")  # fmt: skip


def one_size(count: int) -> None:
    """Print time and memory of a study of ``count`` short runs as JSON."""
    import resource

    run_batch(*bound(1, stop_time=SHORT))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with tempfile.TemporaryDirectory() as folder:
        wall, processor = time.perf_counter(), time.process_time()
        swept = sweep(study(count, stop_time=SHORT), Path(folder), Options())
        assert swept.table is not None
        print(json.dumps({
            "wall": time.perf_counter() - wall,
            "processor": time.process_time() - processor,
            "before": before / 1024,
            "most": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        }))  # fmt: skip


def growth() -> None:
    print(f"runs of {SHORT} s, {cores()} threads, each size in a process of its own:")
    for count in SIZES:
        command = [sys.executable, "-m", "benchmarks.bench_sweep", str(count)]
        done = subprocess.run(command, check=True, capture_output=True, text=True, env=os.environ)
        found = json.loads(done.stdout)
        record(f"run of {SHORT} s among {count:,}, processor time", 1e6 * found["processor"] / count, "us")
        print(f"{count:8} runs {found['wall']:7.2f} s, {1e6 * found['processor'] / count:6.0f} us of processor each, "
              f"{found['most']:.0f} MB at most ({found['most'] - found['before']:+.0f} MB by the sweep)")  # fmt: skip


def main() -> None:
    """Print and record all."""
    rates()
    overhead()
    growth()


if __name__ == "__main__":
    if len(sys.argv) > 1:
        one_size(int(sys.argv[1]))
    else:
        main()
