"""Cost of a 1 ms step of each body, in CPython and compiled, beside CommonRoad's right-hand sides in Python.

All in one process and thread, in turn, medians of CPU time. The first table steps bodies alone;
CommonRoad gives derivatives only, which an integrator calls once to four times a step. The second table
steps the whole vehicle (driver, steering, drive, sensors, outputs) by 10 ms, bodies with mass by their default.
The third drives a whole case with native FMUs.
"""

import ctypes
import statistics
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from vehiclemodels.init_mb import init_mb
from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
from vehiclemodels.vehicle_dynamics_ks import vehicle_dynamics_ks
from vehiclemodels.vehicle_dynamics_mb import vehicle_dynamics_mb
from vehiclemodels.vehicle_dynamics_st import vehicle_dynamics_st

from benchmarks.results import record, size
from benchmarks.rounds import in_turn, timed
from fmus.native.libraries import model_files
from fmus.native.library_cache import cache_library
from modelkit.vocabulary import Pose, Prompt
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from vehicle_fmu import MODEL
from vehicle_fmu.bodies.chassis import Build, ChassisParams, Motion, RoadParams, Stance
from vehicle_fmu.bodies.double_track import DoubleTrackParams, DoubleTrackState, step_double_track
from vehicle_fmu.bodies.kinematic import KinematicInput, KinematicState, move
from vehicle_fmu.bodies.single_track import SingleTrackParams, SingleTrackState, step_single_track
from vehicle_fmu.bodies.wheels import Wheel
from vehicle_fmu.effort import Effort

MOST_ROUNDS = size(30, 1)
WHEELBASE = 2.405
HELD = KinematicInput(1.0, 0.2)
MOVING = Motion(Pose(), 1.0, 0.0, 0.0)
NAMES = ("kinematic", "single_track", "double_track")
Rounds = dict[str, tuple[int, Callable[[int], Any]]]
"""Name -> how many steps a round has, and the round."""


def kinematic(n: int, state: Any) -> Any:
    """Return the car without tyre slip after ``n`` steps of 1 ms."""
    for _ in range(n):
        state = move(state, HELD, HELD, WHEELBASE, 0.001)
    return state


def single(n: int, state: Any, effort: Any, build: Any, p: Any) -> Any:
    """Return the single track after ``n`` steps of 1 ms."""
    for _ in range(n):
        state = step_single_track(state, 0.2, effort, build, p, 0.001)
    return state


def double(n: int, state: Any, effort: Any, build: Any, p: Any) -> Any:
    """Return the double track after ``n`` steps of 1 ms."""
    for _ in range(n):
        state = step_double_track(state, 0.2, effort, build, p, 0.001)
    return state


def bodies(n: int) -> Rounds:
    """Return the three bodies in CPython."""
    build, push = Build(Stance(WHEELBASE, 1.40), ChassisParams(), RoadParams()), Effort(200.0, 0.0)
    one, two = SingleTrackState(MOVING), DoubleTrackState(MOVING, (Wheel(1.0 / 0.344),) * 4)
    return {
        "kinematic": (n, lambda n: kinematic(n, KinematicState())),
        "single_track": (n, lambda n: single(n, one, push, build, SingleTrackParams())),
        "double_track": (n, lambda n: double(n, two, push, build, DoubleTrackParams())),
    }


def compiled() -> Any:
    """Return the loops of ``bodies.c``, compiled with the vehicle's C."""
    files = {**model_files(MODEL), "bodies.c": Path(__file__).with_name("bodies.c").read_text()}
    library = ctypes.CDLL(str(cache_library("bodies", "bodies.c", files)))
    for name in (*NAMES, "vehicle"):
        getattr(library, f"bench_{name}").restype = ctypes.c_double
    return library


def compiled_bodies(library: Any, n: int) -> Rounds:
    """Return the three bodies in C."""
    functions = {name: getattr(library, f"bench_{name}") for name in NAMES}
    return {name: (n, lambda n, f=f: f(ctypes.c_int64(n))) for name, f in functions.items()}  # type: ignore[misc]


def commonroad(n: int) -> Rounds:
    """Return CommonRoad's right-hand sides, in Python."""
    car = parameters_vehicle2()
    state = [0.0, 0.0, 0.05, 5.0, 0.0, 0.1, 0.0]
    big = init_mb(state, car)
    return {
        "KS": (n, lambda n: [vehicle_dynamics_ks(state[:5], [0.0, 0.1], car) for _ in range(n)]),
        "ST": (n, lambda n: [vehicle_dynamics_st(state, [0.0, 0.1], car) for _ in range(n)]),
        "MB": (n, lambda n: [vehicle_dynamics_mb(list(big), [0.0, 0.1], car) for _ in range(n)]),
    }


def vehicles(library: Any, n: int) -> Rounds:
    """Return the whole vehicle in C with each body, stepped ``n`` times 10 ms."""
    forward, step = ctypes.c_int64(int(Prompt.FORWARD)), library.bench_vehicle
    numbers = {name: ctypes.c_int64(body) for body, name in enumerate(NAMES)}
    return {name: (n, lambda n, b=b: step(ctypes.c_int64(n), b, forward)) for name, b in numbers.items()}  # type: ignore[misc]


def medians(groups: dict[str, Rounds]) -> dict[str, float]:
    """Return label -> microseconds a step, every round in turn."""
    every = {f"{group} {name}": run for group, rounds in groups.items() for name, run in rounds.items()}
    works = {label: timed(partial(run, n), time.thread_time) for label, (n, run) in every.items()}
    times = in_turn(works, MOST_ROUNDS)
    return {label: statistics.median(times[label]) / n * 1e6 for label, (n, _) in every.items()}


def native_factors() -> dict[str, float]:
    """Return how many times faster than real time the native FMUs drive case 4 with each body, by wall time.

    The whole pair runs under the compiled master, every signal recorded, no log.
    """
    files = fmu_files("native")
    cases = {name: load_scenario("guo2015-case4", [f"vehicle.body={name}"]) for name in NAMES}
    ends = {name: float(run_scenario(case, files, kind="native").recording.t[-1]) for name, case in cases.items()}
    runs = {name: partial(_wall_time, case, files) for name, case in cases.items()}
    return {name: ends[name] / statistics.median(times) for name, times in in_turn(runs, MOST_ROUNDS).items()}


def _wall_time(case: Scenario, files: dict[str, Path]) -> float:
    return run_scenario(case, files, kind="native").wall_time


def main() -> None:
    """Print the tables."""
    library = compiled()
    found = medians(
        {
            "CPython": bodies(size(300, 10)),
            "compiled": compiled_bodies(library, size(30_000, 100)),
            "CommonRoad": commonroad(size(300, 10)),
            "vehicle": vehicles(library, size(2_000, 100)),
        }
    )
    print("one 1 ms step of a body [us]")
    print(f"  {'':14}{'CPython':>10}{'compiled':>10}{'times real time':>18}{'CommonRoad RHS':>17}{'RHS / step':>12}")
    for name, theirs in zip(NAMES, ("KS", "ST", "MB"), strict=True):
        python, fast, rhs = found[f"CPython {name}"], found[f"compiled {name}"], found[f"CommonRoad {theirs}"]
        record(f"1 ms step, {name}, CPython, processor time", python, "us")
        record(f"1 ms step, {name}, compiled, processor time", fast, "us")
        ratio = f"{rhs / python:.2f} | {rhs / fast:.0f}"
        print(f"  {name:14}{python:10.1f}{fast:10.3f}{1000.0 / fast:18.0f}{f'{theirs} {rhs:.1f}':>17}{ratio:>12}")
    print("the whole vehicle, compiled, one communication step of 10 ms")
    for name in NAMES:
        cost = found[f"vehicle {name}"]
        record(f"10 ms step of the whole vehicle, {name}, compiled, processor time", cost, "us")
        print(f"  {name:14}{cost:10.2f} us{1e4 / cost:12.0f} times real time")
    print("case 4 with native FMUs under the compiled master, every signal recorded")
    for name, factor in native_factors().items():
        record(f"case 4, native FMUs, {name}", factor, "times real time")
        print(f"  {name:14}{factor:25.0f} times real time")


if __name__ == "__main__":
    main()
