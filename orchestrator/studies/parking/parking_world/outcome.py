"""What became of a run, whatever system drove it: contact first, then a claim, judged by the scene.

Contact is any contact. Moving means above ``MOVING_SPEED``. ``valid`` follows from the scene alone: ISO 16787's
shortest slot for the car, less what stands out into it, nothing in it, and no wheel stop under the tail, as in
``apa-world``. A claim is judged by where the vehicle stands, in slots shorter than that as well. Where there are bay
lines, they are the truth: one bay, whichever. A contact is ``unavoidable`` if a moving object would have touched the
car even if that had stood for ``STOOD_FOR``; where it would have stood follows from its speed and steering angle at
the contact.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from controller_fmu.parking.geometry.outline import pose_along_arc
from modelkit.geometry import boxes_overlap, outline
from modelkit.vocabulary import Pose
from orchestrator.evaluation.verdict.measures import Instants, Measure
from orchestrator.evaluation.verdict.numbers import Metric
from orchestrator.evaluation.verdict.outcome import BEYOND
from orchestrator.evaluation.verdict.truth import CAR_KEYS
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.parking_world.angled import is_angled
from orchestrator.studies.parking.parking_world.bays import in_bays, stands_in_a_bay, with_bays
from orchestrator.studies.parking.parking_world.factors import NONE
from orchestrator.studies.parking.parking_world.pedestrian import FIRST_LEG, SECOND_LEG
from orchestrator.studies.parking.parking_world.scene import NEIGHBOUR, OVERHANG, has_bin, overhang_of
from orchestrator.studies.parking.parkings import GBT
from orchestrator.studies.parking.world.feasibility import ends_beyond_tail
from orchestrator.studies.sweep.columns import WITHIN
from orchestrator.studies.sweep.study.study import Columns, DerivedParameter
from vehicle_fmu.scene import Obstacle, is_there, obstacle_box

MOVING_SPEED = 0.05
"""A car no faster [m/s] stands."""
STOOD_FOR = 1.0
"""[s]"""
FORESEEN, FORESEEN_STEP = 5.0, 0.05
"""A car that stood would be touched within this time [s], looked at so often [s]."""
TOUCHING = Instants("vehicle.contact", (1,))
MEASURES = {
    **{f"touched.{axis}": Measure("first", f"vehicle.pose.{axis}", TOUCHING) for axis in ("x", "y", "heading")},
    "touched.speed": Measure("first", "vehicle.speed", TOUCHING),
    "touched.takeover": Measure("first", "vehicle.driver_takeover", TOUCHING),
    "touched.steering_active": Measure("first", "controller.steering_active", TOUCHING),
    "touched.time": Measure("time", "vehicle.speed", TOUCHING),
    "touched.front_wheel_angle": Measure("first", "vehicle.front_wheel_angle", TOUCHING),
    "steered": Measure("greatest", "controller.steering_active"),
}
MOVING, STANDING, DRIVER = "contact, moving", "contact, standing", "contact, driver drives"
FALSE, PARKED, FAILED, ENDLESS = "false parked", "parked", "gave up", "endless"
ENDS = {
    MOVING: f"contact while the system drives, above {MOVING_SPEED} m/s",
    STANDING: f"contact at no more than {MOVING_SPEED} m/s",
    FALSE: "claims to be parked outside the slot or beyond GB/T 41630",
    ENDLESS: "neither parked nor given up at the stop time",
    PARKED: "parked within GB/T 41630, no contact",
    FAILED: "gave up, no contact",
    DRIVER: "contact while the driver drives",
}
"""How a run ends, the worst first."""
COLUMNS = {
    "valid": Metric("1", "1: by the scene alone, the slot has ISO 16787's room for the car, and nothing is in it"),
    "unavoidable": Metric("1", "1: a moving object would have touched a car that had stood for 1 s, too"),
}
MOVING_OBJECTS = (*NEIGHBOUR.values(), OVERHANG, FIRST_LEG, SECOND_LEG)
EMPTY = Obstacle()._asdict()


def _outcome_columns(columns: Columns) -> Mapping[str, Array]:
    bays, in_bay = in_bays(columns), stands_in_a_bay(columns)
    rows = [
        dict(zip(columns, row, strict=True))
        for row in zip(*(np.asarray(item).tolist() for item in columns.values()), strict=True)
    ]
    for number in np.flatnonzero(bays):
        rows[number][WITHIN.format(GBT[int(rows[number]["kind"]) + 1])] = bool(in_bay[number])
    return {
        "valid": is_valid(columns).astype(float),
        "unavoidable": np.array([float(is_unavoidable(row)) for row in rows]),
        "end": np.array([end_of(row) for row in rows], dtype=object),
    }


def is_valid(columns: Columns) -> NDArray[np.bool_]:
    """Return whether each slot is one for its car."""
    f = with_bays({name: np.asarray(columns[name]) for name in FACTORS_OF_VALID})
    ended = {**columns, "behind": np.where(is_angled(f), NONE, columns["behind"])}
    return np.asarray((f["extra"] >= overhang_of(f)) & ~has_bin(f)) & ends_beyond_tail(ended)


FACTORS_OF_VALID = (
    *("kind", "car", "extra", "overhang", "overhang_length", "pillar", "bin", "bend", "angled"),
    *("bays", "bay", "gap_a", "gap_b", "width_a", "width_b", "length_a", "length_b", "turn_a", "turn_b"),
)


def is_unavoidable(row: Mapping[str, Any]) -> bool:
    """Return whether a moving object would also have touched the car, had that stood for ``STOOD_FOR`` before."""
    if math.isnan(row["touched.speed"]):
        return False
    car = [row[key] for key in CAR_KEYS]
    pose = Pose(*(row[f"touched.{axis}"] for axis in ("x", "y", "heading")))
    curvature = math.tan(row["touched.front_wheel_angle"]) / car[0]
    stood = outline(pose_along_arc(pose, -STOOD_FOR * row["touched.speed"], curvature), *car)
    for number in MOVING_OBJECTS:
        names = {name: row.get(f"vehicle.scene.boxes[{number}].{name}", start) for name, start in EMPTY.items()}
        obstacle = Obstacle(**names)
        for step in range(1 - round(STOOD_FOR / FORESEEN_STEP), round(FORESEEN / FORESEEN_STEP)):
            time_ns = round((row["touched.time"] + step * FORESEEN_STEP) * 1e9)
            if is_there(obstacle, time_ns) and is_moving(obstacle, time_ns):
                if boxes_overlap(stood, obstacle_box(obstacle, time_ns)):
                    return True
    return False


def is_moving(obstacle: Obstacle, time_ns: int) -> bool:
    """Return whether an object moves now."""
    return bool((obstacle.speed_x or obstacle.speed_y) and obstacle.moves_at <= time_ns * 1e-9 <= obstacle.halts_at)


def end_of(row: Mapping[str, Any]) -> str:
    """Return how a run ended, one of ``ENDS``."""
    if not math.isnan(row["touched.speed"]):
        if row["touched.takeover"] or not row["touched.steering_active"]:
            after = row["steered"] and not row["touched.takeover"] and abs(row["touched.speed"]) <= MOVING_SPEED
            return STANDING if after else DRIVER
        return MOVING if abs(row["touched.speed"]) > MOVING_SPEED else STANDING
    if row["outcome"] == "parked" or row["reason"].startswith(BEYOND):
        return PARKED if row[WITHIN.format(GBT[int(row["kind"]) + 1])] else FALSE
    return FAILED if row["outcome"] == "failed" else ENDLESS


FOUND = DerivedParameter(COLUMNS, _outcome_columns, {"end": "how the run ended"})
