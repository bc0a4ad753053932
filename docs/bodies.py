"""Writes docs/bodies.md and its pictures: every case of Guo 2015 on all three bodies. ``python docs/bodies.py``.

The models run in process, the vehicle compiled (the same bits, in a tenth of the time).
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import shapely

from fmus.native.libraries import load_model, memory_size
from modelkit.model import Model
from modelkit.variables import constructor, flatten, variables
from orchestrator.cosim.recording import Recording
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.scenario.models import MODELS
from orchestrator.session.session import run_scenario
from orchestrator.verdict.summary import Summary, summarize

FOLDER = Path(__file__).parent
BODIES = ("kinematic", "single_track", "double_track")
COLOURS = {"kinematic": "#1f5fbf", "single_track": "#d1602a", "double_track": "#2b8a5a"}
CASES = [f"guo2015-case{n}{rate}" for n in (1, 2, 3, 4, 5) for rate in ("", "-105")]
CASES.insert(2, "guo2015-case1-cwpt")
SLOW = [case for case in CASES if "-105" not in case]
REAL = {
    "steering.dead_time": 0.06,
    "steering.lag": 0.08,
    "steering.backlash": "4 deg",
    "odometry.perfect": "false",
    "odometry.radius_error": 0.003,
    "odometry.tick": 0.02,
}
"""An actuator and an odometry as a real car has them, for the last table."""
HEAD = "| case | body | outcome | time [s] | shifts | lateral [cm] | along [cm] | heading [deg] | path apart [cm] |"
PAGE = """# What the better vehicle changes

Every case of Guo 2015 on all three bodies, with the same controller and driver; written by `docs/bodies.py`.
*Lateral*, *along* and *heading* are the final pose against the target; *path apart* is the largest distance from
this body's path to the kinematic one's. Tyres, masses and brakes are the defaults of `vehicle_fmu`: the paper gives
none.

<PLAIN>

Read from it:

- At parking speed tyres change little: at 1.5 m/s on the paper's radius a slip angle is 0.1 deg. What changes the
  paths is that a car with mass neither starts nor stops as asked. Its brake lags, so it stops a few centimetres
  later, and rocks on its tyres for a third of a second; each switching point moves by that. Where the kinematic car
  ends 2 cm short of Q3 the others end within 0.6 cm of it.
- What parks on one body parks on every body. Case 1 (Table 1's rate, path tracking only) and case 2 do not, on any.
- Cases 3 and 5 end where the chart first finds the pose right, anywhere ahead of Q3. That place along the slot is
  sensitive: 5 cm in case 3 and 0.7 m in case 5 at 105 deg/s; in case 3 at 105 deg/s the kinematic car stays 1.5 m
  ahead, the others find the pose right only past Q4 and are led back to Q3. In case 5 at Table 1's rate the driver
  shuffles at 1.5 m/s: two shifts more on the single track, one less, and 2.3 m further ahead, on the double track.

![case 4](images/bodies-case4.png)

![case 5](images/bodies-case5.png)

![case 2](images/bodies-case2.png)

## Case 4 at 105 deg/s: where the chart switches

<EVENTS>

## With a real actuator and odometry

Dead time 60 ms, lag 80 ms, backlash 4 deg at the wheel, wheel radius wrong by 0.3 %, ticks of 2 cm. The wheel is
then up to 80 deg behind its request: late, no fault, and learnt by the controller's monitor of the steering.

<REAL>

This costs up to 2.4 cm at the end of what parks. Case 5, with its shuffling at 1.5 m/s, no longer parks
on any body, the kinematic one included: it is not the tyres. The controller gives up after its limit
of shifts.
"""


class Run(NamedTuple):
    """One case on one body."""

    case: str
    body: str
    recording: Recording
    summary: Summary


def main() -> None:
    """Run, draw, write."""
    MODELS["vehicle"] = compiled(MODELS["vehicle"])
    plain = {(case, body): drive(case, body, {}, {}) for case in CASES for body in BODIES}
    real = {(case, body): drive(case, body, REAL, {}) for case in SLOW for body in BODIES}
    images = FOLDER / "images"
    images.mkdir(exist_ok=True)
    for number in (2, 4, 5):
        draw(f"guo2015-case{number}", plain, images / f"bodies-case{number}.png")
    (FOLDER / "bodies.md").write_text(page(plain, real), encoding="utf-8")


def compiled(model: Model) -> Model:
    """Return ``model`` with its two functions compiled; its state is the memory of an instance."""
    library, outputs, count = load_model(model), constructor(model.outputs), len(variables(model.outputs))

    def numbers(value: Any) -> np.ndarray:
        return np.array([float(scalar) for scalar in flatten(value)])

    def initialize(params: Any) -> tuple[Any, Any]:
        p, y, memory = numbers(params), np.zeros(count), np.zeros(memory_size(library), dtype=np.uint8)
        library.model_start(*(array.ctypes.data for array in (memory, p, y)))
        return memory, outputs(y.tolist())

    def step(state: Any, inputs: Any, params: Any, dt_ns: int) -> tuple[Any, Any]:
        memory, u, y = state.copy(), numbers(inputs), np.zeros(count)
        library.model_step(*(array.ctypes.data for array in (memory, u, y)), dt_ns)
        return memory, outputs(y.tolist())

    return model._replace(initialize=initialize, step=step)


def drive(case: str, body: str, vehicle: Mapping[str, object], controller: Mapping[str, object]) -> Run:
    """Return one run of ``case`` on ``body``."""
    sets = [f"vehicle.body={body}", *(f"vehicle.{name}={value}" for name, value in vehicle.items())]
    sets += [f"controller.{name}={value}" for name, value in controller.items()]
    scenario = load_scenario(case, sets)
    ran = run_scenario(scenario)
    print(case, body, ran.recording.t[-1], flush=True)
    return Run(case, body, ran.recording, summarize(ran.recording, scenario, ran.wall_time))


def path_of(run: Run) -> np.ndarray:
    """Return the (x, y) the rear axle went through."""
    signals = run.recording.signals
    return np.column_stack([signals["vehicle.pose.x"], signals["vehicle.pose.y"]])


def apart(run: Run, other: Run) -> float:
    """Return the largest distance [m] from the path of ``run`` to the path of ``other``."""
    line = shapely.LineString(path_of(other))
    return max(float(line.distance(shapely.Point(point))) for point in path_of(run)[::5])


def table(runs: dict[tuple[str, str], Run]) -> list[str]:
    """Return the lines of a table of all cases."""
    lines = [HEAD, "|---|---|---|---:|---:|---:|---:|---:|---:|"]
    for (case, body), run in runs.items():
        final, summary, name = run.summary.final, run.summary, case.removeprefix("guo2015-")
        outcome = f"failed: {summary.reason}" if summary.outcome == "failed" else summary.outcome
        away = 100.0 * apart(run, runs[case, "kinematic"])
        lines.append(
            f"| {name} | {body} | {outcome} | {summary.duration:.1f} | {summary.shifts} "
            f"| {100.0 * final.lateral_error:+.1f} | {100.0 * final.longitudinal_error:+.1f} "
            f"| {np.degrees(final.heading_error):+.2f} | {away:.1f} |"
        )
    return lines


def events(runs: dict[tuple[str, str], Run]) -> list[str]:
    """Return the lines of a table of the switching poses of case 4 at 105 deg/s."""
    lines = [
        "| body | event | t [s] | x [m] | y [m] | heading [rad] |",
        "|---|---|---:|---:|---:|---:|",
    ]
    for body in BODIES:
        for event in runs["guo2015-case4-105", body].summary.events:
            lines.append(
                f"| {body} | {event.to} | {event.t:.2f} | {event.x:.3f} | {event.y:.3f} | {event.heading:.3f} |"
            )
    return lines


def draw(case: str, runs: dict[tuple[str, str], Run], file: Path) -> None:
    """Draw paths, speeds and steering-wheel angles of ``case`` on the three bodies."""
    figure, (path, speed) = plt.subplots(1, 2, figsize=(11.0, 4.2), layout="constrained", width_ratios=(1.3, 1.0))
    for body in BODIES:
        run = runs[case, body]
        signals, t = run.recording.signals, run.recording.t
        path.plot(*path_of(run).T, color=COLOURS[body], linewidth=1.3, label=body)
        speed.plot(t, signals["vehicle.speed"], color=COLOURS[body], linewidth=1.2)
    path.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", title="path of the rear axle")
    speed.set(xlabel="t [s]", ylabel="speed [m/s]", title="speed")
    for axis in (path, speed):
        axis.grid(alpha=0.25, linewidth=0.6)
        axis.spines[["top", "right"]].set_visible(False)
    path.legend(frameon=False)
    figure.suptitle(case, fontweight="bold")
    figure.savefig(file, dpi=110)
    plt.close(figure)


def page(plain: dict[tuple[str, str], Run], real: dict[tuple[str, str], Run]) -> str:
    """Return the text of the page."""
    words = PAGE
    parts = {"PLAIN": table(plain), "EVENTS": events(plain), "REAL": table(real)}
    for name, lines in parts.items():
        words = words.replace(f"<{name}>", "\n".join(lines))
    return words


if __name__ == "__main__":
    main()
