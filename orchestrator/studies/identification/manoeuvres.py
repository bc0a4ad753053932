"""Manoeuvres that a further log could have, and the information of each about parameters (design of experiments)."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.identification.problem import Problem
from orchestrator.studies.identification.signals import FRAMES, TYPICAL_NOISE, MeasuredDrive, Series, unit_of

SAMPLE_TIME = 0.02
"""Of the log that a manoeuvre would give [s]."""
FURTHER_SIGNALS = (*FRAMES["pose"], "speed", "steering_wheel_angle", *FRAMES["odometry"], "measured_speed")
"""Signals that a log could have besides, with typical noise."""


class Manoeuvre(NamedTuple):
    """Steering wheel and speed over time, straight between corners."""

    name: str
    text: str
    """The drive in words."""
    corners: tuple[tuple[float, float, float], ...]
    """Time [s], steering-wheel angle as a share of its limit, speed [m/s]."""


def _steps(*shares: float) -> tuple[tuple[float, float, float], ...]:
    """Return corners of a drive at 1 m/s, the wheel turned within 0.8 s to each share and held for 1.7 s."""
    found: list[tuple[float, float, float]] = [(0.0, 0.0, 0.0), (1.0, 0.0, 1.0)]
    for share in shares:
        time = found[-1][0]
        found += [(time + 0.8, share, 1.0), (time + 2.5, share, 1.0)]
    return (*found, (found[-1][0] + 1.0, found[-1][1], 0.0))


MANOEUVRES = (
    Manoeuvre("straight line", "20 m straight ahead and back", (
        (0.0, 0.0, 0.0), (1.0, 0.0, 1.0), (20.0, 0.0, 1.0), (22.0, 0.0, -1.0), (41.0, 0.0, -1.0), (42.0, 0.0, 0.0),
    )),
    Manoeuvre("steering steps", "at 1 m/s, turn the wheel quickly by half its range to either side and hold it", _steps(
        0.5, -0.5, 0.25, -0.25, 0.5, 0.0
    )),
    Manoeuvre("speed steps", "accelerate to 1.5 m/s and brake to standstill, three times, ahead and back", (
        (0.0, 0.0, 0.0), (1.0, 0.0, 1.5), (4.0, 0.0, 1.5), (4.5, 0.0, 0.0), (5.5, 0.0, 0.0), (6.5, 0.0, -1.5),
        (9.5, 0.0, -1.5), (10.0, 0.0, 0.0), (11.0, 0.0, 0.0), (12.0, 0.0, 1.5), (15.0, 0.0, 1.5), (15.5, 0.0, 0.0),
    )),
    Manoeuvre("full-lock circles", "at full lock and at a third of it, to either side, at 1 m/s, 15 m each", (
        (0.0, 0.0, 0.0), (2.0, 1.0, 0.0), (3.0, 1.0, 1.0), (18.0, 1.0, 1.0), (20.0, 0.33, 1.0), (35.0, 0.33, 1.0),
        (37.0, -0.33, 1.0), (52.0, -0.33, 1.0), (54.0, -1.0, 1.0), (69.0, -1.0, 1.0), (70.0, -1.0, 0.0),
    )),
)  # fmt: skip


def manoeuvre_information(problem: Problem, theta: Array, noise: Mapping[str, float], choice: Manoeuvre) -> Array:
    """Return the Fisher information of a manoeuvre, logged with the signals and the noise of the problem's log."""
    drive = _drive(problem, choice, tuple(problem.drive.compared))
    return _information(problem, drive, theta, noise)


def further_information(problem: Problem, theta: Array, noise: Mapping[str, float], choice: Manoeuvre) -> Array:
    """Return the Fisher information of a manoeuvre of which all signals are logged."""
    names = tuple(name for name in FURTHER_SIGNALS if name not in problem.drive.followed)
    known = {name: noise.get(name, TYPICAL_NOISE[unit_of(name)]) for name in names}
    return _information(problem, _drive(problem, choice, names), theta, known)


def has_effect(problem: Problem, theta: Array, place: int) -> bool:
    """Return whether any manoeuvre shows any effect of the parameter at ``place`` on any output."""
    item = problem.candidates[place]
    moved = theta.copy()
    moved[place] = min(theta[place] + item.accuracy, item.bounds[1])
    for choice in MANOEUVRES:
        drive = _drive(problem, choice, tuple(problem.drive.compared))
        planned = Problem(problem.vehicle, drive, problem.candidates, problem.known | {"odometry.ideal": 0.0})
        if not np.array_equal(planned.simulation(theta).rows, planned.simulation(moved).rows):
            return True
    return False


def _information(problem: Problem, drive: MeasuredDrive, theta: Array, noise: Mapping[str, float]) -> Array:
    empty = Problem(problem.vehicle, drive, problem.candidates, problem.known)
    simulated = empty.outputs(theta, noise)
    compared = {name: item._replace(values=simulated[name]) for name, item in drive.compared.items()}
    planned = Problem(problem.vehicle, drive._replace(compared=compared), problem.candidates, problem.known)
    jacobian = planned.jacobian(theta, noise)
    found: Array = jacobian.T @ jacobian
    return found


def _drive(problem: Problem, choice: Manoeuvre, names: tuple[str, ...]) -> MeasuredDrive:
    """Return a manoeuvre as a log without measurements."""
    times, shares, speeds = np.array(choice.corners).T
    t = np.arange(0.0, times[-1], SAMPLE_TIME)
    limit = problem.known["car.steering.angle_limit"]
    angle = Series(t, limit * np.interp(t, times, shares), choice.name)
    speed = Series(t, np.interp(t, times, speeds), choice.name)
    original = problem.drive
    inputs = {} if original.follows_steering else {"steering_wheel_request": angle}
    if not original.follows_speed:
        inputs["speed_request"] = speed
    followed = {name: angle if name == "steering_wheel_angle" else speed for name in original.followed}
    compared = {name: Series(t, np.zeros(len(t)), choice.name) for name in names}
    return MeasuredDrive(inputs, followed, compared, float(t[-1]))
