"""How long before a touch sensors could have told of who moves."""

import numpy as np
import pytest

from orchestrator.cosim.recording import Recording
from orchestrator.grid.world.heard import NEARER, READINGS, heard_before, readings
from vehicle_fmu.interface import VehicleParams

CAR = VehicleParams().car
CYCLE = CAR.ultrasonic.cycle
SETS_OUT, SPEED, FAR = 1.0, 1.0, 2.0
TAIL = -CAR.rear_overhang
WIDE = 0.5


def standing(number: int, **more: float) -> Recording:
    """Return a car that stands at the origin, and somebody behind it who comes until he touches it."""
    centre = TAIL - FAR - 0.5 * WIDE
    box = {"x": centre, "length": WIDE, "width": 2.0, "speed_x": SPEED, "moves_at": SETS_OUT, "halts_at": 9.0, **more}
    t_ns = np.arange(0, 3_010_000_000, 10_000_000)
    return Recording(
        t_ns,
        {f"vehicle.pose.{axis}": np.zeros(len(t_ns)) for axis in ("x", "y", "heading")},
        {f"vehicle.scene.boxes[{number}].{name}": value for name, value in box.items()},
        {},
    )


TOUCHED = SETS_OUT + FAR / SPEED


def test_a_neighbour_is_heard_as_soon_as_he_has_come_nearer() -> None:
    heard = heard_before(standing(2), "second neighbour", TOUCHED)
    late = NEARER / SPEED + READINGS * CYCLE
    assert FAR / SPEED - late - 0.011 <= heard <= FAR / SPEED - NEARER / SPEED - (READINGS - 1) * CYCLE


def test_a_person_is_heard_when_he_is_there_at_all() -> None:
    appears = 1.5
    heard = heard_before(standing(4, appear_at=appears), "person", TOUCHED)
    assert heard == pytest.approx(TOUCHED - appears - READINGS * CYCLE, abs=CYCLE + 0.011)


def test_who_comes_where_no_sensor_hears_is_never_told() -> None:
    recording = standing(2, y=40.0)
    assert heard_before(recording, "second neighbour", TOUCHED) == 0.0
    found = readings(recording, "second neighbour", TOUCHED)
    assert found.moving.shape == found.stayed.shape == (len(found.t), 12)
    assert found.t[-1] <= TOUCHED


def test_one_reading_is_no_word() -> None:
    """Who is there for less than so many readings is not told of."""
    brief = {"appear_at": 1.5, "disappear_at": 1.5 + (READINGS - 1) * CYCLE}
    assert heard_before(standing(4, **brief), "person", TOUCHED) == 0.0
    assert heard_before(standing(4, appear_at=1.5, disappear_at=1.5 + 2 * READINGS * CYCLE), "person", TOUCHED) > 0.0
