"""How long the valet plans, sample by sample, and how it drives: ``python -m benchmarks.bench_valet [FILE.yaml ...]``.

The scenarios are those of ``apa import tpcap``, or any with ``system: valet``; without a file, the shipped ones.
Times are of the processor, compiled; samples are measured in three passes, of which the least counts, since other
programs take their share.
"""

import argparse
import statistics
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.results import record, size
from fmus.native.libraries import load_model, memory_size
from modelkit.variables import flatten, variables, with_values
from orchestrator.evaluation.verdict.geometry import CarOutline, vehicle_parameters
from orchestrator.evaluation.verdict.polygons import polygon_clearances
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files

STEP_NS = 10_000_000
PASSES = size(3, 1)
LONGEST = 6000
ERRORS = (
    "vehicle.body=double_track",
    "vehicle.steering.dead_time=40 ms",
    "vehicle.steering.lag=50 ms",
    "vehicle.steering.backlash=0.03",
    "vehicle.drive.brake_lag=80 ms",
    "vehicle.odometry={ideal: false, radius_error: 0.001, steering_offset: 0.0002, tick: 0.01}",
)
HEAD = "| case | samples | planned in | slowest sample | steps | margin | length | cusps | driven in | clearance |"


def planned(scenario: Any) -> Any:
    """Return what the outputs say when the path is found, and the processor time [s] of each sample until then."""
    model = scenario.models["controller"]
    library, names = load_model(model), [item.name for item in variables(model.outputs)]
    params = np.array(flatten(with_values(model.params, scenario.controller)), dtype=float)
    inputs = dict.fromkeys((item.name for item in variables(model.inputs)), 0.0) | {"gear": 3.0}
    inputs |= {f"ultrasonic[{number}]": 5.0 for number in range(1, 13)}
    inputs |= {f"odometry.{axis}": scenario.vehicle.get(f"start.{axis}", 0.0) for axis in ("x", "y", "heading")}
    u, y = np.array(list(inputs.values()), dtype=float), np.zeros(len(names))
    memory = np.zeros(memory_size(library), dtype=np.uint8)
    library.model_start(memory.ctypes.data, params.ctypes.data, y.ctypes.data)
    found = names.index("valet.pieces"), names.index("reason")
    times: list[float] = []
    while not y[found[0]] and not y[found[1]] and len(times) < LONGEST:
        begun = time.thread_time()
        library.model_step(memory.ctypes.data, u.ctypes.data, y.ctypes.data, STEP_NS)
        times.append(time.thread_time() - begun)
    return dict(zip(names, y.tolist(), strict=True)), times


def shipped() -> list[str]:
    """Return the names of the shipped scenarios of the valet."""
    return size([name for name in scenario_names() if name.startswith("valet-")], ["valet-parallel"])


def driven(scenario: Any, files: Any) -> Any:
    """Return the summary of a drive, its clearance [m] to polygons and scene, its length [m] and cusps."""
    ran = run_scenario(scenario, files, kind="native")
    signals = ran.recording.signals
    poses = np.column_stack([signals[f"vehicle.pose.{axis}"] for axis in ("x", "y", "heading")])
    car = CarOutline.of(vehicle_parameters(scenario, ran.recording.parameters_of("vehicle")))
    clear = np.nanmin([*polygon_clearances(poses, scenario.obstacles, car), signals["vehicle.clearance"].min()])
    speed = signals["controller.speed_request"]
    signs = np.sign(speed[speed != 0.0])
    cusps = int((signs[1:] != signs[:-1]).sum())
    return summarize(ran.recording, scenario, ran.wall_time), clear, signals["vehicle.distance"][-1], cusps


def main(arguments: Sequence[str] = ()) -> None:
    """Print a table of the files among ``arguments``, or of the shipped scenarios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*")
    parser.add_argument("--perfect", action="store_true", help="drive without errors of sensors and actuators")
    parser.add_argument("--set", action="append", default=[])
    asked = parser.parse_args(arguments)
    files, rows = fmu_files("native", lambda text: None), []
    print(HEAD, "|---:" * 10 + "|", sep="\n")
    for name in asked.files or shipped():
        scenario = load_scenario(name, asked.set)
        passes = [planned(scenario) for _ in range(PASSES)]
        told, times = passes[0][0], np.min([item[1] for item in passes], axis=0)
        errors = [] if asked.perfect else list(ERRORS)
        summary, clear, length, cusps = driven(load_scenario(name, [*errors, *asked.set]), files)
        rows.append((times.sum(), times.max(), summary.outcome))
        print(
            f"| {Path(name).stem.removeprefix('Case')} | {len(times)} | {times.sum() * 1e3:.1f} ms | "
            f"{times.max() * 1e3:.2f} ms | {told['valet.searched']:.0f} | {told['valet.margin'] * 100:.0f} cm | "
            f"{length:.1f} m | {cusps} | {summary.duration:.0f} s{'' if summary.is_done else ' ' + summary.reason} | "
            f"{clear * 100:.1f} cm |",
            flush=True,
        )
    middle = statistics.median(row[0] for row in rows)
    record("planning, median of the scenarios, processor time", middle * 1e3, "ms")
    record("planning, slowest sample, processor time", max(row[1] for row in rows) * 1e3, "ms")
    print(
        f"\nmedian {middle * 1e3:.1f} ms, longest {max(row[0] for row in rows):.2f} s, "
        f"slowest sample {max(row[1] for row in rows) * 1e3:.2f} ms, {sum(row[2] == 'parked' for row in rows)} of "
        f"{len(rows)} parked"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
