"""Slots that the valet has to find, drawn by lot: kinds, angles, neighbours, pillars, ends, streets, sides, ways past.

All of a run follows from its number and the lot. Corner A lies near the origin, the row to the right of x (to the left
on the other side, as a mirror image), the street to its left.
"""

import math
import random
from functools import cache
from typing import Any, NamedTuple

from controller_fmu.valet.params import SlotWish
from orchestrator.grid.cases import CARS
from orchestrator.grid.imperfect import imperfect
from orchestrator.scenario.car import car_parameters
from orchestrator.scenario.polygons import box_corners
from orchestrator.scenario.requirements import shipped_requirements
from orchestrator.scenario.scenario import Scenario, Slot, Target

ANGLES = (30, 45, 60, 90, 120, 135, 150)
"""Of a slot against the way of the car [deg]; 0: parallel."""
NEIGHBOURS = ("straight", "crooked", "staggered", "pillars", "one")
ENDS = ("open", "wall", "wheel stop", "shallow")
STREETS = (5.5, 6.5, 9.0)
LOTS = 100_000
STOP = 240.0
MARGIN = 0.12
ROOM_ACROSS = 0.8
"""Of a slot beside one neighbour [m]."""
BEFORE = 3.0
"""The driver starts so far [m] before the neighbour that he passes first, and searches so far past the other."""
BEHIND = 4.0
AT_WALL = 0.5
"""Left between the driver's way past and the street's other side [m]."""
AT_KERB = 0.2
"""From the tyres to the kerb [m]: the middle of what GB/T 41630 allows."""
Box = dict[str, float]


class FoundCase(NamedTuple):
    """One run."""

    number: int
    lot: int
    car: str
    angle: int
    wish: str
    side: int
    """1 right, -1 left."""
    neighbours: str
    end: str
    street: float
    """Its width before the row [m]."""
    dead_end: bool
    wider: float
    """Of the slot than of the car, or longer if it is parallel [m]."""
    heading: float
    """Of the way past against the row, positive away from it [rad]."""
    beside: float
    """How near the car comes to the row [m]."""
    speed: float
    """Of the driver [m/s]."""


@cache
def cases(runs: int, lot: int = 0) -> list[FoundCase]:
    """Return so many cases."""
    return [_case(number, lot) for number in range(runs)]


def _case(number: int, lot: int) -> FoundCase:
    draw = random.Random(number + LOTS * lot)
    angle = draw.choice((0, 0, *ANGLES, 90))
    nose = draw.random() < (0.7 if angle < 75 else 0.3)
    street = draw.choice(STREETS)
    steep = math.radians((15.0 if angle else 8.0) if street > 8.0 else 5.0)
    neighbours = draw.choice(NEIGHBOURS if angle else NEIGHBOURS[:3])
    wider = draw.uniform(0.9, 1.8) if angle == 0 else draw.uniform(0.7, 1.4)
    return FoundCase(
        number=number,
        lot=lot,
        car=draw.choice(list(CARS)),
        angle=angle,
        wish="parallel" if angle == 0 else "nose in" if nose else "tail in",
        side=draw.choice((1, -1)),
        neighbours=neighbours,
        end=draw.choice(ENDS if angle else ("kerb",)),
        street=street,
        dead_end=draw.random() < 0.15,
        wider=ROOM_ACROSS if neighbours == "one" else wider,
        heading=draw.uniform(-steep, steep),
        beside=draw.uniform(0.7, 1.5),
        speed=draw.uniform(0.8, 2.5),
    )


class SlotPlace(NamedTuple):
    """Where a case's slot is: its middle (flush with the neighbours), direction into it, lengths [m]."""

    x: float
    y: float
    into: float
    pitch: float
    """From middle to middle of neighbouring cars along the row."""
    depth: float
    """From the neighbours' fronts to what the slot ends at; 20: nothing."""


def place_of(case: FoundCase) -> SlotPlace:
    """Return the place of the slot of a case on the right side."""
    length, width = size_of(case)
    if case.angle == 0:
        depth = width + 0.2 + 0.3 * random.Random(case.number + 7).random()
        return SlotPlace(0.5 * (length + case.wider), -0.5 * width, -0.5 * math.pi, length + 0.5 * case.wider, depth)
    turn = math.radians(case.angle)
    across = width + 0.5 * case.wider
    depth = {"open": 20.0, "wall": length + 0.6, "wheel stop": length + 0.4, "shallow": length}[case.end]
    x = 0.5 * (width + case.wider) / math.sin(turn) + 0.5 * length * math.cos(turn)
    return SlotPlace(x, -0.5 * length * math.sin(turn), -turn, across / math.sin(turn), depth)


def size_of(case: FoundCase) -> tuple[float, float]:
    """Return the car's length and width [m]."""
    car = CARS[case.car]
    return car.wheelbase + car.front_overhang + car.rear_overhang, car.width


def boxes_of(case: FoundCase) -> list[Box]:
    """Return what stands around the slot on the right side, but for the street's other side."""
    length, width = size_of(case)
    place, draw = place_of(case), random.Random(case.number + LOTS * case.lot + 17)
    crooked = math.radians(5.0) if case.neighbours == "crooked" else 0.0
    stagger = 0.25 if case.neighbours == "staggered" else 0.0
    post = 0.5 / math.sin(math.radians(case.angle)) if case.neighbours == "pillars" else 0.0
    next_one = (width + 0.7) / math.sin(math.radians(case.angle)) if case.angle else length + 0.8
    offs = [-place.pitch - post - next_one, -place.pitch - post, place.pitch + post, place.pitch + post + next_one]
    boxes = []
    for off in offs if case.neighbours != "one" else offs[:2]:
        far = draw.uniform(-stagger, stagger)
        turn = draw.uniform(-crooked, crooked)
        boxes.append(
            {
                "x": place.x + off + far * math.cos(place.into),
                "y": place.y + far * math.sin(place.into),
                "heading": (place.into if case.angle else 0.0) + turn,
                "length": length,
                "width": width,
            }
        )
    if case.neighbours == "pillars":
        boxes += [_post(case, place, sense, length) for sense in (-1.0, 1.0)]
    if case.end in ("wall", "shallow"):
        boxes.append(_behind(place, length, 0.8))
    if case.dead_end:
        reach = place.x + place.pitch + 0.5 * length + max(3.0, 0.6 * length)
        boxes.append({"x": reach + 4.0, "y": 0.5 * case.street, "length": 0.5, "width": case.street})
    return boxes


def _post(case: FoundCase, place: SlotPlace, sense: float, length: float) -> Box:
    """Return a pillar of 0.4 x 0.4 m between the slot and a neighbour, near their fronts."""
    _, width = size_of(case)
    across = (0.5 * (width + case.wider) + 0.2) * sense
    back = 0.5 * length - 0.8
    x = place.x - back * math.cos(place.into) - across * math.sin(place.into)
    y = place.y - back * math.sin(place.into) + across * math.cos(place.into)
    return {"x": x, "y": y, "heading": place.into, "length": 0.4, "width": 0.4}


def _behind(place: SlotPlace, length: float, thick: float) -> Box:
    """Return the wall that the slot ends at, across its direction."""
    off = place.depth - 0.5 * length + 0.5 * thick
    x, y = place.x + off * math.cos(place.into), place.y + off * math.sin(place.into)
    return {"x": x, "y": y, "heading": place.into, "length": thick, "width": 2.2}


def standing_of(case: FoundCase) -> tuple[Target, Slot]:
    """Return where the car should stand, and the slot, on the right side: as its neighbours do, 20 cm from a kerb."""
    car, place = CARS[case.car], place_of(case)
    length, width = size_of(case)
    ahead = 0.5 * length - car.rear_overhang
    if case.angle == 0:
        y = AT_KERB + 0.5 * width - place.depth
        slot = Slot(x=place.x, y=y, length=length + case.wider, width=width + 0.4)
        return Target(x=place.x - ahead, y=y), slot
    x, y, into = _between(case, place, boxes_of(case))
    out = max(0.0, length + 0.25 - place.depth)
    x, y = x - out * math.cos(into), y - out * math.sin(into)
    heading = into if case.wish == "nose in" else into + math.pi
    target = Target(x=x - ahead * math.cos(heading), y=y - ahead * math.sin(heading), heading=heading)
    return target, Slot(x=x, y=y, heading=into, length=length + 0.6, width=width + case.wider)


def _between(case: FoundCase, place: SlotPlace, boxes: list[Box]) -> tuple[float, float, float]:
    """Return the middle of a slot across the road and its direction: in the middle of what stands on both sides."""
    if case.neighbours == "one":
        return place.x, place.y, boxes[1]["heading"]
    into = 0.5 * (boxes[1]["heading"] + boxes[2]["heading"])
    c, s = math.cos(into), math.sin(into)
    near = [[(y - place.y) * c - (x - place.x) * s for x, y in box_corners(box)] for box in boxes]
    posts = case.neighbours == "pillars"
    low = max(max(across) for across in ([near[1], near[4]] if posts else [near[1]]))
    high = min(min(across) for across in ([near[2], near[5]] if posts else [near[2]]))
    off = 0.5 * (low + high)
    return place.x - off * s, place.y + off * c, into


def scenario_of(case: FoundCase, told: bool = False) -> Scenario:
    """Return the scenario of a case; ``told``: the valet does not search, it is told the map and the target."""
    target, slot = standing_of(case)
    wish = {"parallel": SlotWish.PARALLEL, "nose in": SlotWish.NOSE_IN, "tail in": SlotWish.TAIL_IN}[case.wish]
    controller: dict[str, Any] = {
        **car_parameters(CARS[case.car]),
        "system": 7,
        "plan.margin": MARGIN,
        "search.active": not told,
        "search.wish": int(wish),
        "search.open_ended": case.neighbours == "one",
        "search.way": way_past(case).way,
    }
    if case.side < 0:
        target = target.model_copy(update={"y": -target.y, "heading": -target.heading})
        slot = slot.model_copy(update={"y": -slot.y, "heading": -slot.heading})
    if told:
        controller |= {"target.x": target.x, "target.y": target.y, "target.heading": target.heading}
    return Scenario(
        name="valet-slots",
        stop_time=STOP,
        vehicle=_vehicle(case),
        controller=controller,
        target=target,
        slot=slot,
        limits=[*shipped_requirements("valet-slot")],
    )


class WayPast(NamedTuple):
    """How the driver drives past, on the right side: where the rear axle starts, and how far he goes [m]."""

    x: float
    y: float
    way: float


def way_past(case: FoundCase) -> WayPast:
    """Return the way past both neighbours that keeps the case's distance to everything in the row."""
    length, width = size_of(case)
    front = length - CARS[case.car].rear_overhang
    place, boxes = place_of(case), [box_corners(box) for box in boxes_of(case)]
    first = min(x for x, _ in boxes[1]) - BEFORE - front
    last = place.x + place.pitch if case.neighbours == "one" else max(x for x, _ in boxes[2])
    way = (last + BEHIND - front - first) / math.cos(case.heading)
    t = math.tan(case.heading)
    row = [corner for box in boxes[:4] for corner in box if corner[0] < last + BEHIND + length]
    nearest = max(y - x * t for x, y in row)
    return WayPast(first, nearest + first * t + (case.beside + 0.5 * width) / math.cos(case.heading), way)


def _reach(case: FoundCase) -> float:
    """Return how far across the road the driver's way needs it to be free: the street is no narrower there."""
    past, car, width = way_past(case), CARS[case.car], size_of(case)[1]
    rise, half = math.sin(case.heading), 0.5 * width * math.cos(case.heading)
    ends = (past.y - car.rear_overhang * rise, past.y + (past.way + car.wheelbase + car.front_overhang) * rise)
    return max(ends) + half + AT_WALL


def _vehicle(case: FoundCase) -> dict[str, Any]:
    """Return the vehicle's parameters: where it starts, what stands there, its errors."""
    car, place, boxes = CARS[case.car], place_of(case), boxes_of(case)
    front = max(y for box in boxes[:2] for _, y in box_corners(box))
    length, _ = size_of(case)
    boxes = [*boxes, {"x": 0.0, "y": max(front + case.street, _reach(case)) + 0.5, "length": 80.0, "width": 1.0}]
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
        **imperfect(case.number + 1 + LOTS * case.lot, random.Random(case.number + LOTS * case.lot + 29)),
    }


def _kerbs(case: FoundCase, place: SlotPlace, length: float) -> list[tuple[float, float, float, float]]:
    """Return the kerb along the road behind a parallel slot, or the wheel stop in one across it."""
    if case.angle == 0:
        return [(-15.0, -place.depth, place.x + 25.0, -place.depth)]
    if case.end != "wheel stop":
        return []
    off = place.depth - 0.5 * length
    x, y = place.x + off * math.cos(place.into), place.y + off * math.sin(place.into)
    dx, dy = -0.9 * math.sin(place.into), 0.9 * math.cos(place.into)
    return [(x - dx, y - dy, x + dx, y + dy)]
