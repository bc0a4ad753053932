"""Slots to be found, sampled at random: kinds, angles, neighbours, pillars, ends, streets, sides, ways past.

All of a run follows from its number and ``lot``. Corner A lies near the origin, the row to the right of x (to the left
on the other side, as a mirror image), the street to its left.
"""

import math
import random
from typing import NamedTuple

from modelkit.car import car_length
from orchestrator.inputs.scenario.obstacle_map import box_corners
from orchestrator.inputs.scenario.scenario import Slot, Target
from orchestrator.studies.parking.cases import CARS

ANGLES = (30, 45, 60, 90, 120, 135, 150)
"""Of a slot against the way of the car [deg]; 0: parallel."""
NEIGHBOURS = ("straight", "misaligned", "staggered", "pillars", "one")
ENDS = ("open", "wall", "wheel stop", "shallow")
STREETS = (5.5, 6.5, 9.0)
SEED_STRIDE = 100_000
ROOM_ACROSS = 0.8
"""Of a slot beside one neighbour [m]."""
AT_KERB = 0.2
"""From the tyres to the kerb [m]: the middle of what GB/T 41630 allows."""
Box = dict[str, float]


class DetectedSlotCase(NamedTuple):
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


def cases(runs: int, lot: int = 0) -> list[DetectedSlotCase]:
    """Return so many cases."""
    return [_case(number, lot) for number in range(runs)]


def _case(number: int, lot: int) -> DetectedSlotCase:
    draw = random.Random(number + SEED_STRIDE * lot)
    angle = draw.choice((0, 0, *ANGLES, 90))
    nose = draw.random() < (0.7 if angle < 75 else 0.3)
    street = draw.choice(STREETS)
    steep = math.radians((15.0 if angle else 8.0) if street > 8.0 else 5.0)
    neighbours = draw.choice(NEIGHBOURS if angle else NEIGHBOURS[:3])
    wider = draw.uniform(0.9, 1.8) if angle == 0 else draw.uniform(0.7, 1.4)
    return DetectedSlotCase(
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


def place_of(case: DetectedSlotCase) -> SlotPlace:
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


def size_of(case: DetectedSlotCase) -> tuple[float, float]:
    """Return the car's length and width [m]."""
    car = CARS[case.car]
    return car_length(car), car.width


def boxes_of(case: DetectedSlotCase) -> list[Box]:
    """Return what stands around the slot on the right side, but for the street's other side."""
    length, width = size_of(case)
    place, draw = place_of(case), random.Random(case.number + SEED_STRIDE * case.lot + 17)
    misalignment = math.radians(5.0) if case.neighbours == "misaligned" else 0.0
    stagger = 0.25 if case.neighbours == "staggered" else 0.0
    post = 0.5 / math.sin(math.radians(case.angle)) if case.neighbours == "pillars" else 0.0
    next_one = (width + 0.7) / math.sin(math.radians(case.angle)) if case.angle else length + 0.8
    offs = [-place.pitch - post - next_one, -place.pitch - post, place.pitch + post, place.pitch + post + next_one]
    boxes = []
    for off in offs if case.neighbours != "one" else offs[:2]:
        far = draw.uniform(-stagger, stagger)
        turn = draw.uniform(-misalignment, misalignment)
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


def _post(case: DetectedSlotCase, place: SlotPlace, sense: float, length: float) -> Box:
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


def standing_of(case: DetectedSlotCase) -> tuple[Target, Slot]:
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


def _between(case: DetectedSlotCase, place: SlotPlace, boxes: list[Box]) -> tuple[float, float, float]:
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
