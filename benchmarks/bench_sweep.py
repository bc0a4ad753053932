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
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks.results import record, size
from benchmarks.rounds import in_turn
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.studies.sweep.batch import compile_models, own_choices, run_batch
from orchestrator.studies.sweep.disturbed import fault_numbers
from orchestrator.studies.sweep.engine import cores
from orchestrator.studies.sweep.job import Chunk, arrays, make_job
from orchestrator.studies.sweep.rows import FIRST_MEASURE
from orchestrator.studies.sweep.study.read_study import bind
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.study.study_file import StudyFile
from orchestrator.studies.sweep.study_code import STUDY_CODE_FROM
from orchestrator.studies.sweep.sweep import Options, sweep

MOST_ROUNDS = size(9, 1)
MANOEUVRES = size(1984, 20)
"""On one and on two threads each part of the runs fills its lanes."""
SIZES = size((1_000, 10_000, 100_000), (20,))
PLAIN, DISTURBED = "guo2015-case4", "apa-parallel-real"
STARTS = {PLAIN: (-0.01, 0.01), DISTURBED: (1.8, 1.85)}
"""Scenario -> range of the start's y [m]. The disturbed one has tyres, sensor noise and odometry error."""
DISTURBED_RUNS = size(192, 2)
SHORT = 0.5
"""Length of the runs whose number is grown [s]."""


def study(count: int, scenario: str = PLAIN, **changes: Any) -> Study:
    runs = {"monte_carlo": {"n": count, "vehicle.start.y": {"uniform": list(STARTS[scenario])}}}
    return bind(StudyFile.model_validate({"name": "bench", "scenario": scenario, "runs": runs, "set": changes}))


def bound(count: int, scenario: str = PLAIN, **changes: Any) -> tuple[Any, Chunk]:
    chosen = study(count, scenario, **changes)
    return make_job(chosen), Chunk(0, 0, chosen.design.values, chosen.design.seeds)


def measured(work: Callable[[], object]) -> tuple[float, float]:
    """Return the medians of (wall, processor) time [s]."""
    walls = []

    def once() -> float:
        wall, processor = time.perf_counter(), time.process_time()
        work()
        walls.append(time.perf_counter() - wall)
        return time.process_time() - processor

    processors = in_turn({"work": once}, MOST_ROUNDS)["work"]
    return statistics.median(walls[-len(processors) :]), statistics.median(processors)


class Prepared(NamedTuple):
    """The runs of a study, compiled, with the arrays that they take."""

    rows: Any
    arrays: tuple[Any, Any, Any]
    out: Any

    def run(self, threads: int) -> None:
        """Make all runs in parts, on ``threads`` threads."""
        share = max(1, len(self.out) // (4 * threads))
        parts = [slice(at, at + share) for at in range(0, len(self.out), share)]
        if threads == 1:
            self.rows(*self.arrays, self.out)
            return
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(lambda part: self.rows(*(item[part] for item in self.arrays), self.out[part]), parts))


def prepare(scenario: str, count: int) -> Prepared:
    """Return ``count`` runs of a scenario by code made for the study."""
    job, chunk = bound(count, scenario)
    model = Scenario(**job.scenario)
    parameters, times = arrays(job, chunk)
    choices = own_choices(job._replace(runs=STUDY_CODE_FROM), model, parameters)
    out = np.empty((count, FIRST_MEASURE + len(job.measures)))
    prepared = Prepared(
        compile_models(tuple(job.measures), model, choices), (parameters, times, fault_numbers(job, chunk, model)), out
    )
    prepared.run(1)
    return prepared


def rates() -> None:
    """Print and record runs a second: plain and disturbed, complete, sliced and in lanes, on one, two and all cores."""
    threads = sorted({1, 2, cores()})
    print(f"{'runs a second':39}" + "".join(f"{count:3} threads" for count in threads) + "  processor time of a run")
    for scenario, count in ((PLAIN, MANOEUVRES), (DISTURBED, DISTURBED_RUNS)):
        runs = prepare(scenario, count)
        own = runs.rows.own
        for name, rows in (("complete", runs.rows.complete), ("study code", own[-1]), ("study code in lanes", own[0])):
            if name == "study code in lanes" and len(own) == 1:
                continue  # no vectors here
            runs = runs._replace(rows=rows)
            found = [measured(partial(runs.run, n)) for n in threads]
            label = f"{scenario}, {name}"
            for number, (wall, _) in zip(threads, found, strict=True):
                record(f"{label}, {number} threads", count / wall, "1/s")
            each = 1e3 * found[0][1] / count
            record(f"{label}, one run, processor time", each, "ms")
            print(f"{label:39}" + "".join(f"{count / wall:11.0f}" for wall, _ in found) + f"  {each:.2f} ms")
            if scenario == PLAIN and name == "complete":
                processor, steps = found[0][1], float(runs.out[:, 1].sum()) / 1e7
    record("one exchange and step of the pair, processor time", 1e9 * processor / steps, "ns")
    print(f"one exchange and step of the pair: {1e9 * processor / steps:.0f} ns of processor")
    case4 = load_scenario(PLAIN)
    for kind in ("python", "native"):
        files = fmu_files(kind)
        alone, burnt = measured(partial(run_scenario, case4, files, kind=kind))
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
