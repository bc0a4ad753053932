"""The driver's pass: the straight strip that the car sweeps while it searches, and when it is where.

For a slot on the right, whatever the side: y is taken away from the slot.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array

F = Mapping[str, Array]
CLEAR_OF_PASS = 0.3
"""What stands beside the road keeps this far [m] from the car that passes: the least that a driver leaves."""
ADVISED_SPEED = 10.0 / 3.6
"""A driver who slows down when prompted searches no slower than this [m/s]."""
LET_PASS = 0.5
"""Who waits sets out this long [s] after the car has passed."""
BEYOND_SLOT = 12.0
"""The driver passes the slot by so much [m]."""


class DriverPass(NamedTuple):
    """Pose of the rear axle's middle at the start, speed, and the car's size; SI units."""

    x: Array
    y: Array
    slope: Array
    """Tangent of the heading, positive away from the slot."""
    half_width: Array
    """Of the car, measured along y."""
    front: Array
    rear: Array
    end: Array
    """The rear axle passes no farther than this x [m]."""
    speed: Array
    acceleration: Array


def driver_pass(f: F, found: F, slot: Array) -> DriverPass:
    """Return the pass of each run beside a slot of length ``slot`` [m]."""
    heading = np.radians(f["heading"])
    front = found["vehicle.car.wheelbase"] + found["vehicle.car.front_overhang"]
    return DriverPass(
        found["vehicle.start.x"],
        found["vehicle.start.y"] * (1.0 - 2.0 * f["side"]),
        np.tan(heading),
        0.5 * found["vehicle.car.width"] / np.cos(heading),
        front,
        np.asarray(found["vehicle.car.rear_overhang"]),
        slot + BEYOND_SLOT,
        np.asarray(found["vehicle.driver.profile[1].speed"]),
        np.asarray(found["vehicle.drive.acceleration_limit"]),
    )


def near_edge(swept: DriverPass, low: Array, high: Array) -> Array:
    """Return the least y [m] of the swept strip between two x [m]."""
    corner = np.abs(swept.slope) * swept.half_width  # the outline's corners lie ahead of and behind its axis
    first = np.clip(low, swept.x - swept.rear - corner, None)
    last = np.clip(high, None, swept.end + swept.front + corner)
    lowest = np.where(swept.slope > 0.0, first, last)
    return np.asarray(swept.y + (lowest - swept.x) * swept.slope - swept.half_width)


def far_edge(swept: DriverPass, low: Array, high: Array) -> Array:
    """Return the greatest y [m] of the swept strip between two x [m]."""
    return near_edge(swept, low, high) + 2.0 * swept.half_width + np.abs((high - low) * swept.slope)


def first_time_at(swept: DriverPass, x: Array) -> Array:
    """Return when [s] a driver who goes on as in his profile has brought the rear axle to ``x`` [m]."""
    return _time_at(swept, x, swept.speed)


def last_time_at(swept: DriverPass, x: Array) -> Array:
    """Return when [s] a driver who slows down from the start, and does not stop, has brought the rear axle there."""
    return _time_at(swept, x, np.minimum(swept.speed, ADVISED_SPEED))


def _time_at(swept: DriverPass, x: Array, speed: Array) -> Array:
    distance = np.maximum(x - swept.x, 0.0)
    ramp = 0.5 * speed**2 / swept.acceleration
    on_ramp = np.sqrt(2.0 * distance / swept.acceleration)
    return np.where(distance < ramp, on_ramp, speed / swept.acceleration + (distance - ramp) / speed)
