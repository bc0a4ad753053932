"""What the corner and side sensors hear on the way into a slot: places that the map does not have yet.

They become lines of the map when the way is planned anew. That is done when a place lies nearer to the rest of the way
than half the clearance planned, before the car is there.
"""

from typing import NamedTuple

from controller_fmu.common.sensors import sensor_at
from controller_fmu.planning.plan import PATH, Path
from controller_fmu.planning.plan_store import HEARD, SIDES, PlanStore
from controller_fmu.planning.task import drive
from controller_fmu.sensing.ear import SideEar, listen
from controller_fmu.sensing.gap import Gap
from controller_fmu.sensing.heard_store import MOST_LINES, forget_place, forget_side, put_heard, put_line
from controller_fmu.sensing.in_gap import point_in_gap
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.signals import ValetInput
from modelkit.geometry import Point, line_box, outline, point_gap
from modelkit.vocabulary import Pose

FRONT_EARS = (3, 10, 0, 8)
"""Corner and side sensor, right then left, that lead when the car drives forward; and in reverse."""
REAR_EARS = (7, 11, 4, 9)
INSIDE = 0.06
"""A place so far [m] inside a slot's sides is new."""
BEFORE = 1.0
"""Slots begin so far [m] before their corners."""
STUB = 0.03
UNDER = 0.03
"""What is nearer [m] to the car, or inside of it, would touch it as the map has it, by ``STUB``."""
STEP = 0.2
"""The rest of the way is looked along at steps of this [m]."""
KNOWN = 0.1
"""What lies so near [m] to a line of the map is known, wherever it is outside the slot."""
SURE = 2
SHARE = 0.5
"""Of the clearance planned, that a new place may take."""


class Nearby(NamedTuple):
    """Four ears, and whether one of them has heard something in the way."""

    ears: tuple[SideEar, ...] = (SideEar(),) * 4
    forward: bool = True
    in_the_way: bool = False


class Rest(NamedTuple):
    """The rest of a way: the pieces of a path from one on, where this begins, and what is left of it [m]."""

    path: Path
    piece: int
    begin: Pose
    left: float


def forget_nearby(store: PlanStore) -> None:
    """Forget what was heard on the way into a slot."""
    for ear in range(4):
        forget_side(store, SIDES + ear)


def forget_under(store: PlanStore, state: Nearby, pose: Pose, params: ValetParams) -> None:
    """Forget places that the car as it stands would touch: whatever was heard, it was elsewhere."""
    car = params.car
    body = outline(pose, car.wheelbase, car.front_overhang, car.rear_overhang, car.width)
    for number in range(4):
        first = (SIDES + number) * HEARD
        for place in range(first, first + state.ears[number].places):
            if point_gap(Point(store.heard_x[place], store.heard_y[place]), body) < UNDER:
                forget_place(store, place)


def hear_nearby(
    store: PlanStore, state: Nearby, inputs: ValetInput, rest: Rest, gap: Gap, params: ValetParams
) -> Nearby:
    """Return the ears after new readings on the way into a gap."""
    forward = rest.path.pieces[rest.piece].way > 0.0
    mounts = params.car.ultrasonic.mounts
    ears = state.ears
    blocked = state.in_the_way
    for number in range(4):
        ear = ears[number]
        if forward != state.forward:
            ear = SideEar(places=ear.places)
        sensor = FRONT_EARS[number] if forward else REAR_EARS[number]
        at = sensor_at(mounts[sensor], inputs.odometry)
        heard = listen(store, ear, SIDES + number, at, inputs.ultrasonic[sensor], params.car.ultrasonic)
        last = (SIDES + number) * HEARD + heard.places - 1
        if heard.places > 0 and store.heard_count[last] >= SURE and is_unknown(store, last, gap):
            blocked = blocked or room_beside(store, last, rest, params) < SHARE * rest.path.margin
        ears = ears[:number] + (heard,) + ears[number + 1 :]
    return Nearby(ears, forward, blocked)


def is_unknown(store: PlanStore, place: int, gap: Gap) -> bool:
    """Return whether the map does not have a place: it lies inside a gap, or elsewhere off the map's lines."""
    return is_new(store, place, gap) or is_off_map(store, place, gap)


def is_off_map(store: PlanStore, place: int, gap: Gap) -> bool:
    """Return whether a place lies beside the way into a gap, or far before it, and not on a line of the map."""
    x = store.heard_x[place]
    y = store.heard_y[place]
    at = point_in_gap(x, y, gap)
    apart = at.across < -KNOWN or at.across > gap.width + KNOWN or at.deep < -BEFORE
    return apart and not is_on_line(store, Point(x, y))


def is_on_line(store: PlanStore, point: Point) -> bool:
    """Return whether a point lies within ``KNOWN`` of a line of the map."""
    found = False
    for line in range(MOST_LINES + 1):
        a = 2 * line
        if not found and store.around_of[a] > 0:
            box = line_box(store.around_x[a], store.around_y[a], store.around_x[a + 1], store.around_y[a + 1])
            found = point_gap(point, box) <= KNOWN
    return found


def is_new(store: PlanStore, place: int, gap: Gap) -> bool:
    """Return whether a place lies inside a gap, where the map has nothing."""
    return is_in_gap(store.heard_x[place], store.heard_y[place], gap)


def is_in_gap(x: float, y: float, gap: Gap) -> bool:
    """Return whether a point lies inside a gap, where the map has nothing."""
    at = point_in_gap(x, y, gap)
    return INSIDE < at.across < gap.width - INSIDE and -BEFORE < at.deep < gap.front + gap.depth - INSIDE


def put_nearby(store: PlanStore, state: Nearby, echo: Pose) -> Nearby:
    """Return the ears with a place that was heard without a doubt."""
    ear = state.ears[0]
    places = put_heard(store, SIDES, ear.places, echo.x, echo.y, True)
    places = put_heard(store, SIDES, places, echo.x, echo.y, False)
    return state._replace(ears=(ear._replace(places=places),) + state.ears[1:])


def room_beside(store: PlanStore, place: int, rest: Rest, params: ValetParams) -> float:
    """Return how near [m] the rest of the way comes to a place."""
    car = params.car
    point = Point(store.heard_x[place], store.heard_y[place])
    nearest = 1.0
    begin = rest.begin
    left = rest.left
    for number in range(PATH):
        if rest.piece <= number < rest.path.used:
            piece = rest.path.pieces[number]
            sense = 1.0 if piece.way > 0.0 else -1.0
            way = abs(piece.way)
            for step in range(100):
                on = way - left + STEP * step
                if on < way + STEP:
                    pose = drive(begin, sense * (on if on < way else way), piece.k)
                    body = outline(pose, car.wheelbase, car.front_overhang, car.rear_overhang, car.width)
                    nearest = min(nearest, point_gap(point, body))
            begin = drive(begin, piece.way, piece.k)
            left = abs(rest.path.pieces[number + 1 if number + 1 < PATH else number].way)
    return nearest


def lay_nearby(store: PlanStore, state: Nearby, gap: Gap, lines: int) -> None:
    """Add what was heard that the map of a gap, of so many lines, does not have: what lies in the gap first."""
    for inside in (True, False):
        lines = _lay_places(store, state, gap, lines, inside)


def _lay_places(store: PlanStore, state: Nearby, gap: Gap, lines: int, inside: bool) -> int:
    """Add the places inside a gap, or those off its map; returns how many lines that has then."""
    for number in range(4):
        first = (SIDES + number) * HEARD
        for place in range(first, first + state.ears[number].places):
            laid = is_new(store, place, gap) if inside else is_off_map(store, place, gap)
            if store.heard_count[place] >= SURE and laid:
                x = store.heard_x[place]
                y = store.heard_y[place]
                lines = put_line(store, lines, x - STUB, y, x + STUB, y)
    return lines
