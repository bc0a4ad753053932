"""Cost of one control step of each controller; the fuzzy law beside scikit-fuzzy, the QP beside cvxpy + OSQP and DAQP.

All in one process, in turn. Each controller is driven in closed loop first, from start to parked; the inputs
it saw are then played to it again, in CPython and by the C of the native FMU in a loop in C, and the step
is timed alone. Means over the drive: the MPC is solved in every fifth step only, the parking assist plans at
standstill. Medians over the rounds.
"""

import ctypes
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import cvxpy
import daqp
import numpy as np
import osqp
import scipy.sparse
import skfuzzy
from skfuzzy import control

from benchmarks.results import record, size
from benchmarks.rounds import in_turn, timed
from controller_fmu import MODEL
from controller_fmu.preview.fuzzy import infer
from controller_fmu.preview.rule_tables import STEERING_SYMMETRIC
from controller_fmu.zhang2022.qp import MAX_STAGES, solve
from fmus.native.libraries import declare_functions, memory_size, model_files
from fmus.native.library_cache import cache_library
from modelkit.variables import flatten, variables, with_values
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.simulation.cosim.recording import inputs_seen
from orchestrator.studies.bakeoff.entries import CONTROLLERS, scenario_of
from tests.controller.qp_problems import dense, random_problem

MOST_ROUNDS, REPEATS = size((15, 50), (1, 1))
PROBLEMS = size(30, 2)
PEAKS5, PEAKS7 = (-3.0, -1.5, 0.0, 1.5, 3.0), (-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0)
FUZZY = (PEAKS5, PEAKS5, PEAKS7, STEERING_SYMMETRIC)
NAMES = ("NB", "NM", "NS", "ZE", "PS", "PM", "PB")


def micros(works: dict[str, Callable[[], Any]], counts: dict[str, int]) -> dict[str, float]:
    """Return name -> median time [us] of one of the ``counts`` steps that each work does, all in turn."""
    times = in_turn({name: timed(work) for name, work in works.items()}, MOST_ROUNDS)
    return {name: 1e6 * statistics.median(times[name]) / counts[name] for name in works}


def scenarios() -> dict[str, Scenario]:
    """Return the drive of each controller."""
    found = {
        name: scenario_of(name, 7.7, "zhang2022", "kinematic", "far", "none")
        for name in size(CONTROLLERS, CONTROLLERS[:1])
    }
    return size({**found, "preview": load_scenario("preview", ["vehicle.body=kinematic"])}, found)


def seen_by_controller(scenario: Scenario) -> list[Any]:
    """Return what the controller is given in a closed loop, step by step, until the manoeuvre is over."""
    recording = run_scenario(scenario, fmu_files("native"), kind="native").recording
    final = np.isin(recording.signals[scenario.stop_condition.signal], scenario.stop_condition.final())
    over = int(np.argmax(final)) if final.any() else len(final)
    return inputs_seen(recording, "controller", MODEL)[:over]


class StepCost(NamedTuple):
    """Cost of one step of a controller in a drive."""

    python: float
    """Mean in CPython [us]."""
    slowest: float
    """Of the slowest step in CPython, of each step the shortest of the drives [ms]."""
    compiled: float
    """Mean in C [us]."""
    steps: int
    """How many the drive has."""


def step_cost(library: Any, scenario: Scenario) -> StepCost:
    """Return the cost of a step of a drive. Raises ``RuntimeError`` if the compiled code ends with other outputs."""
    params = with_values(MODEL.params, dict(scenario.controller))
    seen = seen_by_controller(scenario)
    in_c = compiled_replay(library, params, seen, scenario.step_ns)
    drives, ends = [], []

    def in_python() -> float:
        spent, outputs = replay(params, seen, scenario.step_ns)
        drives.append(spent)
        ends.append(outputs)
        return sum(spent)

    times = in_turn({"CPython": in_python, "compiled": timed(in_c)}, MOST_ROUNDS)
    if list(in_c()) != ends[0]:
        raise RuntimeError(f"{scenario.name}: compiled code ends with other outputs")
    python, fast = (1e6 * statistics.median(values) / len(seen) for values in times.values())
    return StepCost(python, 1e3 * max(map(min, zip(*drives, strict=True))), fast, len(seen))


def bench_controllers(library: Any) -> None:
    """Print the cost of one step of each controller."""
    print(f"\n{'control step [us]':24s}{'CPython':>10s}{'compiled':>10s}{'steps':>10s}{'slowest [ms]':>14s}")
    for name, scenario in scenarios().items():
        cost = step_cost(library, scenario)
        record(f"control step, {name}, CPython", cost.python, "us")
        record(f"control step, {name}, compiled", cost.compiled, "us")
        print(f"{name:24s}{cost.python:10.1f}{cost.compiled:10.2f}{cost.steps:10d}{cost.slowest:14.2f}", flush=True)


def replay(params: Any, seen: list[Any], step_ns: int) -> tuple[list[float], list[float]]:
    """Step the controller in CPython through the inputs it saw; return the times of the steps [s], the last outputs."""
    state, outputs = MODEL.initialize(params)
    spent = []
    step = MODEL.stepper(None)
    for inputs in seen:
        begun = time.perf_counter()
        state, outputs = step(state, inputs, params, step_ns)
        spent.append(time.perf_counter() - begun)
    return spent, [float(value) for value in flatten(outputs)]


def compiled() -> Any:
    """Return the controller's C with the loops of ``controllers.c``."""
    files = {**model_files(MODEL), "controllers.c": Path(__file__).with_name("controllers.c").read_text()}
    library = declare_functions(ctypes.CDLL(str(cache_library("controllers", "controllers.c", files))))
    pointer, long, double = ctypes.c_void_p, ctypes.c_int64, ctypes.c_double
    library.bench_inputs.argtypes = [pointer, long, pointer]
    library.bench_inputs_size.restype = long
    library.bench_replay.argtypes = [pointer, pointer, long, long, pointer]
    library.bench_infer.argtypes = [pointer, long]
    library.bench_solve.argtypes = [long, double, double, double, pointer, pointer]
    library.bench_infer.restype = library.bench_solve.restype = double
    return library


def compiled_replay(library: Any, params: Any, seen: list[Any], step_ns: int) -> Callable[[], Any]:
    """Return the same by the controller's C."""
    memory, y = np.zeros(memory_size(library), dtype=np.uint8), np.zeros(len(variables(MODEL.outputs)))
    p = numbers(params)
    rows = np.array([flatten(inputs) for inputs in seen], dtype=float)
    u = np.zeros(len(rows) * library.bench_inputs_size(), dtype=np.uint8)
    library.bench_inputs(rows.ctypes.data, len(rows), u.ctypes.data)
    instance, inputs, parameters, outputs = (array.ctypes.data for array in (memory, u, p, y))

    def work(_held: Any = (memory, u, p)) -> Any:
        library.model_start(instance, parameters, outputs)
        library.bench_replay(instance, inputs, len(rows), step_ns, outputs)
        return y

    return work


def numbers(value: Any) -> Any:
    """Return the scalars of nested tuples as doubles."""
    return np.array(flatten(value), dtype=float)


def bench_fuzzy(library: Any) -> None:
    """Print the cost of one fuzzy inference."""
    points = np.random.default_rng(1).uniform(-3.0, 3.0, (200, 2)).tolist()
    array = np.array(points)
    simulation = scikit_fuzzy()

    def ours() -> None:
        for a, b in points:
            infer(a, b, *FUZZY)

    def theirs() -> None:
        for a, b in points:
            simulation.input["row"], simulation.input["column"] = a, b
            simulation.compute()

    works = {"C": lambda: library.bench_infer(array.ctypes.data, len(array)), "CPython": ours, "scikit-fuzzy": theirs}
    machine, python, other = micros(works, dict.fromkeys(works, len(points))).values()
    print(f"\n{'fuzzy inference [us]':24s}{'CPython':>10s}{'compiled':>10s}{'scikit-fuzzy':>14s}")
    print(f"{'5 x 5 rules':24s}{python:10.1f}{machine:10.2f}{other:14.0f}   {other / python:.0f} times ours in CPython")


def scikit_fuzzy() -> Any:
    """Return the steering controller in scikit-fuzzy, universe of 601 points."""
    row, column = (control.Antecedent(np.linspace(-3.0, 3.0, 601), name) for name in ("row", "column"))
    out = control.Consequent(np.linspace(-3.0, 3.0, 601), "out")
    for variable, peaks, names in ((row, PEAKS5, NAMES[::1][:5]), (column, PEAKS5, NAMES[:5]), (out, PEAKS7, NAMES)):
        corners = (peaks[0], *peaks, peaks[-1])
        for place, name in enumerate(names):
            variable[name] = skfuzzy.trimf(variable.universe, corners[place : place + 3])
    rules = [
        control.Rule(row[NAMES[i]] & column[NAMES[j]], out[NAMES[STEERING_SYMMETRIC[5 * i + j]]])
        for i in range(5)
        for j in range(5)
    ]
    return control.ControlSystemSimulation(control.ControlSystem(rules), cache=False)


def bench_qp(library: Any) -> None:
    """Print the cost of one QP of the MPC, 12 steps, tolerance 1e-10 (ours) and 1e-6 (OSQP)."""
    rng = np.random.default_rng(1)
    problems = [random_problem(rng) for _ in range(PROBLEMS)]
    matrices = [dense(*problem) for problem in problems]

    def ours() -> None:
        for problem in problems:
            solve(*problem, 1e-10, 40)

    flat = [(now, numbers(stages), numbers(weights)) for now, stages, weights in problems]

    def by_c() -> None:
        for now, stages, weights in flat:
            library.bench_solve(REPEATS, *now, stages.ctypes.data, weights.ctypes.data)

    def by_daqp() -> None:
        for h, f, g, limit in matrices:
            daqp.solve(h, f, g, limit, np.full_like(limit, -1e30))

    def by_osqp() -> None:
        for h, f, g, limit in matrices:
            solver = osqp.OSQP()
            upper = scipy.sparse.triu(h, format="csc")
            low = np.full_like(limit, -np.inf)
            solver.setup(upper, f, scipy.sparse.csc_matrix(g), low, limit, eps_abs=1e-6, eps_rel=1e-6, verbose=False)
            solver.solve(raise_error=False)

    def by_cvxpy() -> None:
        for h, f, g, limit in matrices:
            x = cvxpy.Variable(2 * MAX_STAGES)
            cost = 0.5 * cvxpy.quad_form(x, cvxpy.psd_wrap(h)) + f @ x
            cvxpy.Problem(cvxpy.Minimize(cost), [g @ x <= limit]).solve(solver=cvxpy.OSQP, eps_abs=1e-6, eps_rel=1e-6)

    solvers = {"ours, CPython": ours, "DAQP": by_daqp, "OSQP, set-up and solve": by_osqp, "cvxpy + OSQP": by_cvxpy}
    works = {"ours, compiled": by_c, **solvers}
    counts = {name: len(problems) * (REPEATS if work is by_c else 1) for name, work in works.items()}
    print(f"\n{'QP of 12 steps [us]':24s}{'time':>10s}")
    for name, cost in micros(works, counts).items():
        if name in solvers:
            record(f"QP of 12 steps, {name}", cost, "us")
        print(f"{name:24s}{cost:10.0f}")


def main() -> None:
    """Print and record all."""
    made = compiled()
    bench_fuzzy(made)
    bench_qp(made)
    bench_controllers(made)


if __name__ == "__main__":
    main()
