"""The imperfect car of the studies of slots: its body, and what its steering, brake, sensors and odometry get wrong."""

import random
from typing import Any

from orchestrator.studies.parking.cases import BODY, SEED_COUNT


def imperfect(seed: int, draw: random.Random) -> dict[str, Any]:
    """Return parameters of the vehicle; ``seed`` is that of the sensors' noise, odometry's errors are drawn."""
    return {
        "body": BODY["double_track"],
        "ultrasonic.noise": 0.01,
        "ultrasonic.dropout": 0.01,
        "ultrasonic.seed": seed % SEED_COUNT,
        "steering.dead_time": 0.04,
        "steering.lag": 0.05,
        "steering.backlash": 0.03,
        "drive.brake_lag": 0.08,
        "odometry.ideal": False,
        "odometry.radius_error": draw.uniform(-0.002, 0.002),
        "odometry.steering_offset": draw.uniform(-0.0004, 0.0004),
        "odometry.tick": 0.01,
    }
