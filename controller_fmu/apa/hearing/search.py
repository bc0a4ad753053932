"""The search for slots on both sides while driving past, and the slots remembered."""

import math
from typing import NamedTuple

from controller_fmu.apa.hearing.line_fit import NO_SUMS, OFF, leaning, offset, slope, spread
from controller_fmu.apa.hearing.search_side import hear
from controller_fmu.apa.hearing.side import DEEP, START, WALL, SideState
from controller_fmu.apa.outline import Shape
from controller_fmu.apa.params import ApaParams, ApaSystemParams, Wish
from controller_fmu.apa.signals import ApaInput
from controller_fmu.apa.slot import UNSEEN, Kind, Side, Slot
from controller_fmu.apa.ways.fit import Fit, fit_of
from controller_fmu.common.driver_selection import MAX_OFFERS, ChosenSide
from controller_fmu.common.sensors import LEFT_SENSOR, RIGHT_SENSOR, VALID_RANGE_FRACTION, sensor_at
from modelkit.vocabulary import Pose

RIGHT = 0
LEFT = 1
LONG_NEIGHBOUR = 2.9
"""A neighbour longer than this [m] along the road stands parallel to it: cars are 1.5 to 2 m wide, 3.5 to 5 m long."""
LONG_AT_LEAST = 2.6
"""The second one already where so much [m] of it was heard, and not its end."""


CAR_WIDE = 1.3
"""One that is longer than this and no longer than that is a whole car, seen from its nose or tail: what ends a slot
beside it must be told by ``TOLD`` readings to be no part of a flank."""
TOLD = 3.0
BESIDE = 0.6
"""The end of a neighbour is heard past it as far as this share of its distance: the tangent of half a cone."""


class SearchState(NamedTuple):
    """Both sides, and the slots found, the newest first."""

    origin: Pose = Pose()
    right: SideState = START
    left: SideState = START
    far_right: float = DEEP
    """Nearest distance [m] heard on the right since the last neighbour on the left, and the other way round."""
    far_left: float = DEEP
    way: float = 0.0
    """Driven since the search began [m]."""
    slots: tuple[Slot, ...] = (Slot(),) * MAX_OFFERS
    valid: int = 0
    """Valid slots remembered."""
    seen: int = 0
    """Gaps between neighbours judged on the right (16 each) and on the left."""
    refused: Fit = Fit()
    """Of the last gap that was refused."""
    refusals: int = 0
    fastest: float = 0.0
    """Largest speed of the search [m/s]."""


def begin_search(pose: Pose) -> SearchState:
    """Return a search that begins at ``pose``."""
    return SearchState(origin=pose)


def search(
    state: SearchState, inputs: ApaInput, car: Shape, params: ApaSystemParams, dt_ns: int, fresh: bool
) -> SearchState:
    """Return the search after one sample; ``fresh``: the sensors tell something new."""
    speed = abs(inputs.measured_speed)
    way = state.way + speed * dt_ns * 1e-9
    if not fresh or speed < 0.01:
        return state._replace(way=way)
    fastest = max(state.fastest, speed)
    right_r = inputs.ultrasonic[RIGHT_SENSOR]
    left_r = inputs.ultrasonic[LEFT_SENSOR]
    right = _hear(state.right, RIGHT, state.origin, inputs, params)
    left = _hear(state.left, LEFT, state.origin, inputs, params)
    top = VALID_RANGE_FRACTION * params.car.ultrasonic.max_range
    far_left = DEEP if right.mode == 1 and state.right.mode != 1 else state.far_left
    far_right = DEEP if left.mode == 1 and state.left.mode != 1 else state.far_right
    far_left = left_r if left_r < far_left and left_r < top else far_left
    far_right = right_r if right_r < far_right and right_r < top else far_right
    state = _kept_but_behind(_kept_but_behind(state, state.right, right, RIGHT), state.left, left, LEFT)
    state = state._replace(right=right, left=left, far_right=far_right, far_left=far_left, way=way, fastest=fastest)
    if right.fresh:
        state = _judge(state, right, RIGHT, car, params)
    if left.fresh:
        state = _judge(state, left, LEFT, car, params)
    return state


def _kept_but_behind(state: SearchState, before: SideState, now: SideState, which: int) -> SearchState:
    """Return the search without a slot whose second neighbour is a wall behind: something nearer stands before it."""
    beside_it = before.mode == WALL and before.edge_b > before.edge
    if not (beside_it and now.mode == WALL and now.edge_b <= now.edge):
        return state
    if state.valid == 0 or state.slots[0].side != which:
        return state
    return state._replace(slots=(state.slots[1], state.slots[2], Slot()), valid=state.valid - 1)


def left_part(seen: int) -> int:
    """Return how many gaps were judged on the left."""
    return seen % 16


def slot_of(state: SearchState, side: SideState, which: int, car: Shape, params: ApaParams) -> Slot:
    """Return the gap between the last two neighbours on a side as a slot, in the world."""
    mirror = -1.0 if which == LEFT else 1.0
    origin = state.origin
    lean_a = slope(side.before, NO_SUMS)
    lean_b = leaning(side.before, side.sums)
    b = _road(side, lean_a, lean_b, params)
    cos = 1.0 / math.sqrt(1.0 + b * b)
    u = side.edge
    w = offset(side.before, lean_a) + lean_a * u
    c = math.cos(origin.heading)
    s = math.sin(origin.heading)
    x = origin.x + u * c - mirror * w * s
    y = origin.y + u * s + mirror * w * c
    turn = math.atan(b)
    along = side.edge_b - u
    out = offset(side.sums, lean_b) + lean_b * side.edge_b - w
    depth = UNSEEN
    if side.behind.n > 0.0:
        depth = cos * (w + 0.5 * along * b - side.behind.w / side.behind.n) + side.behind.r / side.behind.n
        depth -= cos * b * (u + 0.5 * along - side.behind.u / side.behind.n)
    if side.behind.n < TOLD and CAR_WIDE <= side.extent < LONG_NEIGHBOUR:
        depth = UNSEEN
    length = cos * (along + b * out)
    return Slot(
        kind=kind_of(length, depth, side.extent, car, params),
        side=which,
        a=Pose(x, y, origin.heading + mirror * turn),
        length=max(0.0, length),
        b_out=cos * (out - b * along),
        depth=depth,
        opposite=_opposite(side, state.far_right if which == LEFT else state.far_left, car),
        unsure=params.search.unsure * state.fastest,
        skew_a=math.atan(lean_a) - turn,
        skew_b=math.atan(lean_b) - turn,
    )


def _opposite(side: SideState, heard: float, car: Shape) -> float:
    """Return how far [m] from corner A something lies across the road that the other side ``heard``."""
    if heard >= DEEP:
        return UNSEEN
    beside = side.sums.r / side.sums.n if side.sums.n > 0.0 else 0.0
    return beside + 2.0 * car.half_width + heard


def _road(side: SideState, lean_a: float, lean_b: float, params: ApaParams) -> float:
    """Return the slope of the road: of both neighbours, and of a wall behind where it does not contradict them."""
    askew = params.map.askew * params.map.askew
    a = 1.0 / (askew + OFF * OFF / max(spread(side.before), 0.01))
    b = 1.0 / (askew + OFF * OFF / max(spread(side.sums), 0.01))
    both = (a * lean_a + b * lean_b) / (a + b)
    told = spread(side.behind)
    if told < 0.1:
        return both
    wall = slope(side.behind, NO_SUMS)
    c = 1.0 / (0.1 * askew + 4.0 * OFF * OFF / told + (wall - both) * (wall - both))
    return (both * (a + b) + c * wall) / (a + b + c)


def kind_of(length: float, depth: float, neighbour: float, car: Shape, params: ApaParams) -> int:
    """Return how a car would stand in a gap: by its length, its depth, and how the neighbour stands.

    Where the neighbour is heard shorter than any car, how it stands is not known: two cars side by side leave their
    place free less often than one along the road.
    """
    if params.search.wish != Wish.ANY:
        return params.search.wish
    car_length = car.front + car.rear
    if length < 0.8 * car_length:
        return Kind.PERPENDICULAR
    if depth < car_length - params.search.depth_room:
        return Kind.PARALLEL
    if neighbour < CAR_WIDE and length > 2.0 * (2.0 * car.half_width + params.search.perpendicular_room):
        return Kind.PARALLEL
    return Kind.PARALLEL if neighbour > LONG_NEIGHBOUR else Kind.PERPENDICULAR


def _hear(side: SideState, which: int, origin: Pose, inputs: ApaInput, params: ApaSystemParams) -> SideState:
    """Return a side after a reading of its sensor."""
    sensor = LEFT_SENSOR if which == LEFT else RIGHT_SENSOR
    mirror = -1.0 if which == LEFT else 1.0
    at = sensor_at(params.car.ultrasonic.mounts[sensor], inputs.odometry)
    dx = at.x - origin.x
    dy = at.y - origin.y
    c = math.cos(origin.heading)
    s = math.sin(origin.heading)
    u = dx * c + dy * s
    w = mirror * (dy * c - dx * s)
    reading = inputs.ultrasonic[sensor]
    r = reading if reading < VALID_RANGE_FRACTION * params.car.ultrasonic.max_range else DEEP
    return hear(side, u, w, r, params.car.ultrasonic.half_angle, params.apa.search)


def _judge(state: SearchState, side: SideState, which: int, car: Shape, params: ApaSystemParams) -> SearchState:
    """Return the search with a new gap judged, or a known one measured better."""
    slot = slot_of(state, side, which, car, params.apa)
    mark = side.found * 16 if which == RIGHT else side.found
    known = state.seen - left_part(state.seen) if which == RIGHT else left_part(state.seen)
    other = state.seen - known
    if mark == known:
        first = state.slots[0]
        better = state.valid > 0 and first.side == which and abs(first.length - slot.length) < 0.5
        if not better:
            return state
        slot = slot._replace(kind=first.kind)
        if first.kind == Kind.PERPENDICULAR and _is_long(side, params.apa):
            slot = slot._replace(kind=Kind.PARALLEL)
            fit = fit_of(slot, car, params.apa)
            if not fit.fits:
                return without(state, 1)._replace(refused=fit)
        return state._replace(slots=(slot, state.slots[1], state.slots[2]))
    fit = fit_of(slot, car, params.apa)
    seen = mark + other
    if not fit.fits:
        return state._replace(seen=seen, refused=fit, refusals=state.refusals + 1)
    slots = (slot, state.slots[0], state.slots[1])
    return state._replace(slots=slots, valid=min(MAX_OFFERS, state.valid + 1), seen=seen)


def _is_long(side: SideState, params: ApaParams) -> bool:
    """Return whether the neighbour after the gap is heard to stand along the road; never where a kind is wished for."""
    heard_past = BESIDE * side.samples[0].r
    return params.search.wish == Wish.ANY and side.missed - side.edge_b > LONG_AT_LEAST + heard_past


def is_on(slot: Slot, side: int) -> bool:
    """Return whether a slot lies on the side that the driver wants."""
    return side == ChosenSide.ANY or slot.side == (Side.LEFT if side == ChosenSide.LEFT else Side.RIGHT)


def number_chosen(state: SearchState, side: int, number: int) -> int:
    """Return the number, from 1, of the slot remembered that is meant: of ``number``, or the newest; 0: none is."""
    if number > 0:
        at = number - 1 if number <= MAX_OFFERS else 0
        return number if number <= state.valid and is_on(state.slots[at], side) else 0
    chosen = 0
    for at in range(MAX_OFFERS):
        if chosen == 0 and at < state.valid and is_on(state.slots[at], side):
            chosen = at + 1
    return chosen


def without(state: SearchState, number: int) -> SearchState:
    """Return the search with one of its slots given up, counted from 1."""
    slots = (state.slots[1] if number <= 1 else state.slots[0], state.slots[2], Slot())
    if number >= MAX_OFFERS:
        slots = (state.slots[0], state.slots[1], Slot())
    return state._replace(slots=slots, valid=max(0, state.valid - 1), refusals=state.refusals + 1)
