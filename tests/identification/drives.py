"""Random cars and random drives, with the noise of sensors: logs whose true parameters are known."""

from typing import NamedTuple

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.identification.compiled_vehicle import INPUTS, OUTPUTS, CompiledVehicle, InputSequence
from orchestrator.studies.identification.signals import MeasuredDrive, Series, drive_of

STEP = 0.01
RANGES = {
    "car.wheelbase": (2.3, 3.1),
    "car.steering.ratio": (13.0, 20.0),
    "steering.lag": (0.04, 0.25),
    "steering.dead_time": (0.02, 0.15),
    "odometry.radius_error": (-0.03, 0.03),
    "odometry.steering_offset": (-0.01, 0.01),
    "drive.drive_lag": (0.05, 0.3),
}
NOISE = {
    "pose.x": 0.01,
    "pose.y": 0.01,
    "pose.heading": 0.002,
    "speed": 0.01,
    "measured_speed": 0.01,
    "steering_wheel_angle": 0.003,
    "odometry.x": 0.003,
    "odometry.y": 0.003,
    "odometry.heading": 0.001,
}
CAR = {"car.wheelbase": 2.62, "car.steering.ratio": 17.3, "odometry.radius_error": 0.01, "odometry.ideal": 0.0}
CAR |= {"odometry.steering_offset": 0.004}
FOLLOWED = ("pose.x", "pose.y", "pose.heading", "measured_speed", "steering_wheel_angle")
SINGLE_TRACK = 1


class Pair(NamedTuple):
    """A car and a drive."""

    true: dict[str, float]
    drive: MeasuredDrive
    names: list[str]
    """Parameters that are unknown."""
    known: dict[str, float]


def pair(seed: int, vehicle: CompiledVehicle) -> Pair:
    """Return a random pair; by its seed with requests, with measurements only, or with a car that has mass."""
    random = np.random.default_rng(seed)
    true = {name: random.uniform(*bounds) for name, bounds in RANGES.items()} | {"odometry.ideal": 0.0}
    kind = ("requests", "measurements", "requests", "measurements", "mass")[seed % 5]
    names = list(RANGES)[:-1]
    known: dict[str, float] = {}
    if kind == "mass":
        known = {"body": SINGLE_TRACK, "car.wheelbase": true["car.wheelbase"]}
        names = ["car.steering.ratio", "steering.lag", "steering.dead_time", "drive.drive_lag"]
    if kind == "measurements":
        names = [name for name in names if not name.startswith("steering.")]
    log = simulated_log({**true, **known}, random_drive(random), random, vehicle)
    if kind == "measurements":
        log = measurements_only(log, true)
    if kind == "mass":
        log = {name: item for name, item in log.items() if not name.startswith(("odometry", "measured"))}
    return Pair(true, drive_of(log, "log"), names, known)


def random_drive(random: np.random.Generator, largest: float = 8.0, longest: float = 40.0) -> tuple[Array, Array]:
    """Return requests of steering-wheel angle [rad] and speed [m/s] at every step: random levels, held for a time."""
    count = int(random.uniform(20.0, longest) / STEP)
    angle, speed = levels(random, count, largest, (1.0, 4.0)), levels(random, count, 1.5, (3.0, 8.0))
    angle[:50], speed[:50] = 0.0, 0.0
    return angle, speed


def levels(random: np.random.Generator, count: int, largest: float, times: tuple[float, float]) -> Array:
    found, at = np.zeros(count), 0
    while at < count:
        length = int(random.uniform(*times) / STEP)
        found[at : at + length] = random.uniform(-largest, largest)
        at += length
    return found


def simulated_log(
    true: dict[str, float], drive: tuple[Array, Array], random: np.random.Generator, vehicle: CompiledVehicle
) -> dict[str, Series]:
    """Return the signals of a drive with noise, and its requests."""
    angle, speed = drive
    t = np.arange(len(angle) + 1, dtype=np.float64) * STEP
    rows = np.zeros((len(angle), len(INPUTS)))
    rows[:, INPUTS["steering_wheel_request"]], rows[:, INPUTS["speed_request"]] = angle, speed
    rows[:, [INPUTS["steering_active"], INPUTS["speed_control_active"]]] = 1.0
    outputs = vehicle.outputs(true, InputSequence(np.rint(t * 1e9).astype(np.int64), rows))
    log = {
        name: Series(t, outputs[:, OUTPUTS[name]] + random.normal(0.0, sigma, len(t)), name)
        for name, sigma in NOISE.items()
    }
    requests = {"steering_wheel_request": angle, "speed_request": speed}
    return log | {name: Series(t[:-1], values, name) for name, values in requests.items()}


def measurements_only(log: dict[str, Series], true: dict[str, float]) -> dict[str, Series]:
    """Return a log without requests, whose sensor of the steering-wheel angle has an offset."""
    angle = log["steering_wheel_angle"]
    offset = true["car.steering.ratio"] * true["odometry.steering_offset"]
    kept = {name: item for name, item in log.items() if name in FOLLOWED}
    return kept | {"steering_wheel_angle": angle._replace(values=angle.values + offset)}
