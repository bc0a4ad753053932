"""The planner: every slot of the grid is reached free of obstacles, both sides alike, L_min holds."""

import math

import pytest

from controller_fmu.apa.outline import clearance
from controller_fmu.apa.slot import Kind, Margins, Slot, shortest_for_one_move, site_of
from controller_fmu.apa.ways.candidates import BESIDE
from controller_fmu.apa.ways.exit import exit_of
from controller_fmu.apa.ways.move import end_of, is_move_free, length_of, point_at
from controller_fmu.apa.ways.planner import (
    ENTRY,
    FOUND,
    IN_PARALLEL,
    NOTHING,
    SEARCHING,
    new_search,
    search_on,
    stage_of,
)
from controller_fmu.apa.ways.start_range import start_range
from controller_fmu.apa.ways.turns import reverse_turn, turn_of
from controller_fmu.common.curve import advance
from modelkit.vocabulary import Pose
from tests.controller.apa_cars import CARS, MARGINS, iso_slot, park_in_thought, shape_of, slot_and_site, start_of

NO_MARGINS = Margins(0.0, 0.0, 0.0)


@pytest.mark.parametrize("name", CARS)
@pytest.mark.parametrize("kind", [Kind.PARALLEL, Kind.PERPENDICULAR])
@pytest.mark.parametrize("extra", [0.0, 1.0])
@pytest.mark.parametrize(("beside", "degrees"), [(0.5, 5.0), (0.5, -5.0), (1.0, 0.0), (1.5, 5.0)])
def test_every_slot_from_the_shortest_up_is_reached(
    name: str, kind: int, extra: float, beside: float, degrees: float
) -> None:
    car = shape_of(name)
    slot, site = slot_and_site(car, kind, extra)
    start = start_of(slot, site, car, 1.0, beside, math.radians(degrees))
    moves, end = park_in_thought(start, site, car)
    reverses = [number for number, move in enumerate(moves) if move.direction < 0]
    assert moves, "nothing found"
    assert len(moves) - reverses[0] <= (8 if kind == Kind.PARALLEL else 7)
    assert abs(end.y) < 0.01
    open_site = site_of(slot, car, NO_MARGINS)
    for move in moves:
        steps = int(length_of(move) / 0.02)
        nearest = min(clearance(point_at(move, 0.02 * n).pose, car, open_site.obstacles) for n in range(steps + 1))
        assert nearest > MARGINS.beside - 0.02
        assert max(abs(point_at(move, 0.02 * n).curvature) for n in range(steps + 1)) <= car.curvature + 1e-12


@pytest.mark.parametrize("kind", [Kind.PARALLEL, Kind.PERPENDICULAR])
def test_the_left_side_mirrors_the_right(kind: int) -> None:
    car = shape_of("middle")
    found = []
    for side in (0, 1):
        slot, site = slot_and_site(car, kind, 0.3, side)
        found.append(park_in_thought(start_of(slot, site, car, 1.0, 0.9, 0.03), site, car))
    (right, right_end), (left, left_end) = found
    assert len(right) == len(left) > 0
    assert left_end == pytest.approx(right_end, abs=1e-6)


@pytest.mark.parametrize("name", CARS)
def test_l_min_is_the_shortest_slot_left_along_one_arc(name: str) -> None:
    car = shape_of(name)
    depth = 2.0 * car.half_width
    closed = shortest_for_one_move(car, 1.0 / car.curvature - car.half_width, depth)
    low, high = closed - 1.0, closed + 1.0
    while high - low > 1e-3:
        middle = 0.5 * (low + high)
        site = site_of(Slot(Kind.PARALLEL, 0, Pose(0.0, 0.0, 0.0), middle, 0.0, 50.0), car, NO_MARGINS)
        pose, free = Pose(car.rear - middle * 0.5 - 0.5 * (car.rear - car.front), 0.0, 0.0), True
        for n in range(400):
            free = (
                free
                and clearance(advance(pose, 1.0, 0.01 * n, car.curvature, car.curvature), car, site.obstacles) >= -1e-9
            )
        low, high = (low, middle) if free else (middle, high)
    assert high == pytest.approx(closed, abs=0.01)


def test_a_slot_too_short_is_refused() -> None:
    car = shape_of("middle")
    site = site_of(Slot(Kind.PARALLEL, 0, Pose(0.0, 0.0, 0.0), car.front + car.rear + 0.35, 0.0, 2.2), car, MARGINS)
    search = new_search(Pose(7.0, 2.9, 0.0))
    while search.status == SEARCHING:
        search = search_on(search, site, car, 50)
    assert search.status == NOTHING


def test_a_car_past_the_slot_close_to_the_row_reverses_in_from_the_road() -> None:
    """It is no car in the slot, though it is as near to the row as one."""
    car = shape_of("middle")
    site = site_of(Slot(Kind.PARALLEL, 0, Pose(0.0, 0.0, 0.0), 7.0, 0.0, 2.3), car, MARGINS)
    for x in (7.0, 9.0):
        start = Pose(x, 1.25 * car.half_width, 0.0)
        assert stage_of(0, start, site, car) == ENTRY
    assert stage_of(0, Pose(0.5, 0.5, 0.1), site, car) < ENTRY


def test_a_car_that_no_short_moves_lead_in_drives_out_and_in_anew() -> None:
    """Half out of a short slot, and turned: eight short moves do not do, the road ahead is free."""
    car = shape_of("large")
    site = site_of(Slot(Kind.PARALLEL, 0, Pose(0.0, 0.0, 0.0), 6.3, 0.0, 2.3), car, MARGINS)
    search = search_on(new_search(Pose(1.6, 0.75, 0.41)), site, car, 100_000)
    assert search.status == FOUND
    assert search.stage > IN_PARALLEL
    assert search.move.direction > 0


@pytest.mark.parametrize("barred", [1, -1])
def test_a_way_is_looked_for_that_does_not_begin_as_the_one_that_could_not(barred: int) -> None:
    car = shape_of("middle")
    site = site_of(Slot(Kind.PERPENDICULAR, 0, Pose(0.0, 0.0, 0.0), 3.2, 0.0, 5.0), car, MARGINS)
    start = Pose(6.0, -1.5, -1.0)
    free = search_on(new_search(start), site, car, 100_000)
    other = search_on(new_search(start, barred), site, car, 100_000)
    assert (free.status, other.status) == (FOUND, FOUND)
    assert other.move.direction == -barred
    assert barred == -free.move.direction or other.moves >= free.moves


def test_the_number_of_candidates_at_a_time_changes_nothing() -> None:
    car = shape_of("middle")
    slot, site = slot_and_site(car, Kind.PARALLEL, 0.0)
    start = start_of(slot, site, car, 1.0, 1.0, 0.0)
    at_once = search_on(new_search(start), site, car, 10_000)
    search = new_search(start)
    while search.status == SEARCHING:
        search = search_on(search, site, car, 1)
    assert search == at_once
    assert search.status == FOUND


def test_inside_the_start_range_one_reverse_leads_in_and_outside_it_does_not() -> None:
    car = shape_of("middle")
    site = site_of(Slot(Kind.PARALLEL, 0, Pose(0.0, 0.0, 0.0), 7.4, 0.0, 2.3), car, MARGINS)
    way_in = exit_of(2, site, car)
    reach = start_range(3.0, 0.0, way_in, site, car)
    assert reach.found
    assert reach.high - reach.low > 1.0
    for x, inside in (
        (reach.low + 0.01, True),
        (reach.high - 0.01, True),
        (reach.low - 0.01, False),
        (reach.high + 0.1, False),
    ):
        search = search_on(new_search(Pose(x, 3.0, 0.0)), site, car, 10_000)
        at_once = search.moves == 1 and search.move.pieces[0].length == 0.0 and search.move.direction == -1
        assert at_once == inside, x
        assert is_move_free(search.move, car, site.obstacles)
        assert end_of(search.move).y <= 3.0


@pytest.mark.parametrize("short", [0.002, 0.01, 0.03])
def test_a_car_that_ends_its_swing_a_little_off_still_turns_in_with_one_move(short: float) -> None:
    """The turn at full lock on the axis just does not fit any more, ``short`` [m] too late."""
    car = shape_of("small")
    _, site = slot_and_site(car, Kind.PERPENDICULAR, 0.3)
    turn = turn_of(car.curvature, car.curvature, car.ramp)
    fits = next(
        Pose(5.79, -2.50 - 0.001 * n, math.radians(-59.5))
        for n in range(1000)
        if reverse_turn(Pose(5.79, -2.50 - 0.001 * n, math.radians(-59.5)), turn).direction < 0
    )
    start = advance(fits, -1.0, reverse_turn(fits, turn).pieces[0].length + short, 0.0, 0.0)
    assert reverse_turn(start, turn).direction == 0
    search = search_on(new_search(start), site, car, 10_000)
    assert (search.status, search.moves) == (FOUND, 1)
    end = end_of(search.move)
    assert (end.y, end.heading) == pytest.approx((0.0, 0.0), abs=BESIDE + 1e-4)


@pytest.mark.parametrize("deeper", [0.0, 0.05, 0.1, 0.4])
def test_a_wider_margin_to_the_wall_is_kept_where_the_parked_car_leaves_it(deeper: float) -> None:
    """Without a move into the margin at the target itself: there the car has what is left."""
    car = shape_of("small")
    slot = iso_slot(car, Kind.PARALLEL, 0.4)._replace(depth=2.0 * car.half_width + 0.05 + deeper)
    narrow = site_of(slot, car, Margins(0.12, 0.05, 0.0))
    wide = site_of(slot, car, Margins(0.12, 0.05, 0.0, wall=0.15))
    assert wide.frame == narrow.frame
    nearer = narrow.obstacles.beside.y1 - wide.obstacles.beside.y1
    assert nearer == pytest.approx(-min(deeper, 0.1), abs=1e-9)
    assert clearance(Pose(), car, wide.obstacles) >= 0.0
