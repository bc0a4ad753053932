"""Scenarios of the random slots: the path past them, or out of them, what stands there, the car's errors."""

import math
import random
from typing import Any, NamedTuple

from controller_fmu.common.external_slot import SlotKind
from orchestrator.inputs.scenario.car import car_parameters
from orchestrator.inputs.scenario.obstacle_map import box_corners
from orchestrator.inputs.scenario.requirements import library_requirements
from orchestrator.inputs.scenario.scenario import Scenario, Target
from orchestrator.studies.parking.cases import CARS
from orchestrator.studies.parking.detected_slot_cases import (
    SEED_STRIDE,
    DetectedSlotCase,
    SlotPlace,
    boxes_of,
    place_of,
    size_of,
    standing_of,
)
from orchestrator.studies.parking.imperfect import imperfect
from orchestrator.studies.parking.system_signals import APA_SYSTEM

STOP_TIME = 240.0
PLAN_MARGIN = 0.12
APPROACH_DISTANCE = 3.0
"""The driver starts so far [m] before the neighbour that he passes first, and searches so far past the other."""
START_OFFSET = 4.0
STAND_OUT = 0.5
"""Largest overhang of a parked vehicle beyond its neighbours' line [m]."""
WANTED = {"parallel": SlotKind.PARALLEL, "nose in": SlotKind.NOSE_IN, "tail in": SlotKind.TAIL_IN}
HANDOVER_DISTANCE = 4.0
"""Out of a slot, the car hands over so far [m] past the neighbour's middle."""
PARKED_POSE_ERROR = 0.05
"""It stands in the slot so far off its middle [m], and turned by so much [rad]."""
TURNED = math.radians(2.0)
AT_WALL = 0.5
"""Left between the driver's way past and the street's other side [m]."""


def scenario_of(case: DetectedSlotCase, reported: bool = False) -> Scenario:
    """Return the scenario of a case; ``reported``: no search, the map and the target are known."""
    target, slot = standing_of(case)
    controller: dict[str, Any] = {
        **car_parameters(CARS[case.car]),
        "system": APA_SYSTEM,
        "plan.margin": PLAN_MARGIN,
        "search.active": not reported,
        "slot.wanted": int(WANTED[case.wish]),
        "slot.open_ended": case.neighbours == "one",
        "slot.distance": way_past(case).distance,
        "slot.stand_out": STAND_OUT,
    }
    if case.side < 0:
        target = target.model_copy(update={"y": -target.y, "heading": -target.heading})
        slot = slot.model_copy(update={"y": -slot.y, "heading": -slot.heading})
    if reported:
        controller |= {"target.x": target.x, "target.y": target.y, "target.heading": target.heading}
    return Scenario(
        name="valet-slots",
        stop_time=STOP_TIME,
        vehicle=_vehicle(case),
        controller=controller,
        target=target,
        slot=slot,
        requirements=[*library_requirements("valet-slot")],
    )


def out_of(case: DetectedSlotCase) -> Scenario:
    """Return the scenario in which the car stands in the slot and comes out into the street, to either side.

    It receives the map, and where to hand over: along the street, its middle beyond the neighbour on that side.
    """
    draw = random.Random(case.number + SEED_STRIDE * case.lot + 41)
    scenario, place, street = scenario_of(case, reported=True), place_of(case), _street(case)
    inside, way = scenario.target, -1.0 if case.dead_end else draw.choice((1.0, -1.0))
    assert inside is not None
    target = Target(
        x=place.x + way * (place.pitch + HANDOVER_DISTANCE),
        y=case.side * 0.5 * (street.near + street.far),
        heading=0.0 if way > 0.0 else math.pi,
    )
    start = {
        "start.x": inside.x + draw.uniform(-PARKED_POSE_ERROR, PARKED_POSE_ERROR),
        "start.y": inside.y + draw.uniform(-PARKED_POSE_ERROR, PARKED_POSE_ERROR),
        "start.heading": inside.heading + draw.uniform(-TURNED, TURNED),
    }
    reported = {"target.x": target.x, "target.y": target.y, "target.heading": target.heading}
    return scenario.model_copy(
        update={
            "vehicle": scenario.vehicle | start,
            "controller": scenario.controller | reported,
            "target": target,
            "slot": None,
            "requirements": [*library_requirements("valet")],
        }
    )


class Street(NamedTuple):
    """What a street is free between, across [m]."""

    near: float
    far: float


def _street(case: DetectedSlotCase) -> Street:
    """Return the street on the right side: no narrower than the driver's way past needs it."""
    near = max(y for box in boxes_of(case)[:2] for _, y in box_corners(box))
    return Street(near, max(near + case.street, _reach(case)))


class WayPast(NamedTuple):
    """How the driver drives past, on the right side: where the rear axle starts, and how far he goes [m]."""

    x: float
    y: float
    distance: float


def way_past(case: DetectedSlotCase) -> WayPast:
    """Return the way past both neighbours that keeps the case's distance to everything in the row."""
    length, width = size_of(case)
    front = length - CARS[case.car].rear_overhang
    place, boxes = place_of(case), [box_corners(box) for box in boxes_of(case)]
    first = min(x for x, _ in boxes[1]) - APPROACH_DISTANCE - front
    last = place.x + place.pitch if case.neighbours == "one" else max(x for x, _ in boxes[2])
    distance = (last + START_OFFSET - front - first) / math.cos(case.heading)
    t = math.tan(case.heading)
    row = [corner for box in boxes[:4] for corner in box if corner[0] < last + START_OFFSET + length]
    nearest = max(y - x * t for x, y in row)
    return WayPast(first, nearest + first * t + (case.beside + 0.5 * width) / math.cos(case.heading), distance)


def _reach(case: DetectedSlotCase) -> float:
    """Return how far across the road the driver's way needs it to be free: the street is no narrower there."""
    past, car, width = way_past(case), CARS[case.car], size_of(case)[1]
    rise, half = math.sin(case.heading), 0.5 * width * math.cos(case.heading)
    ends = (past.y - car.rear_overhang * rise, past.y + (past.distance + car.wheelbase + car.front_overhang) * rise)
    return max(ends) + half + AT_WALL


def _vehicle(case: DetectedSlotCase) -> dict[str, Any]:
    """Return the vehicle's parameters: where it starts, what stands there, its errors."""
    car, place, boxes = CARS[case.car], place_of(case), boxes_of(case)
    length, _ = size_of(case)
    boxes = [*boxes, {"x": 0.0, "y": _street(case).far + 0.5, "length": 80.0, "width": 1.0}]
    values: dict[str, Any] = {}
    for number, box in enumerate(boxes, start=1):
        values |= {f"scene.boxes[{number}].{name}": value for name, value in box.items()}
        values[f"scene.boxes[{number}].y"] *= case.side
        values[f"scene.boxes[{number}].heading"] = case.side * box.get("heading", 0.0)
    for number, line in enumerate(_kerbs(case, place, length), start=1):
        x1, y1, x2, y2 = line
        kerb = {"x1": x1, "y1": case.side * y1, "x2": x2, "y2": case.side * y2, "height": 0.12}
        values |= {f"scene.kerbs[{number}].{name}": value for name, value in kerb.items()}
    past = way_past(case)
    return {
        **car_parameters(car),
        **values,
        "start.x": past.x,
        "start.y": case.side * past.y,
        "start.heading": case.side * case.heading,
        "driver.apa_switch_time": 0.5,
        "driver.profile[1].speed": case.speed,
        **imperfect(case.number + 1 + SEED_STRIDE * case.lot, random.Random(case.number + SEED_STRIDE * case.lot + 29)),
    }


def _kerbs(case: DetectedSlotCase, place: SlotPlace, length: float) -> list[tuple[float, float, float, float]]:
    """Return the kerb along the road behind a parallel slot, or the wheel stop in one across it."""
    if case.angle == 0:
        return [(-15.0, -place.depth, place.x + 25.0, -place.depth)]
    if case.end != "wheel stop":
        return []
    off = place.depth - 0.5 * length
    x, y = place.x + off * math.cos(place.into), place.y + off * math.sin(place.into)
    dx, dy = -0.9 * math.sin(place.into), 0.9 * math.cos(place.into)
    return [(x - dx, y - dy, x + dx, y + dy)]
