"""Slot search: sides, corners and refusals, with ideal and noisy sensors; and what the supervisor sees."""

import math
from itertools import pairwise
from typing import Any

import pytest

from controller_fmu.apa.around.surroundings import shape_of
from controller_fmu.apa.hearing import search_side
from controller_fmu.apa.hearing.consensus import NO_WINDOW, PLACES, agreed, taken_up
from controller_fmu.apa.hearing.edge import NO_SAMPLES, Heard, append, corner
from controller_fmu.apa.hearing.line_fit import FittedLine, Sums, add, offset, slope
from controller_fmu.apa.hearing.neighbour import is_between
from controller_fmu.apa.hearing.search import LEFT, RIGHT, SearchState, _hear, _kept_but_behind, kind_of
from controller_fmu.apa.hearing.side import DEEP, GAP, START, WALL, SideState, begin_wall
from controller_fmu.apa.hearing.side_line import with_sample
from controller_fmu.apa.slot import UNSEEN, Kind, Slot
from controller_fmu.common.sensors import LEFT_SENSOR
from controller_fmu.registry import ControllerInput, ControllerParams
from modelkit.vocabulary import Pose
from tests.controller.apa_bench import CAR, box, car_settings, drive

HALF = math.radians(30.0)


@pytest.mark.parametrize("tilt", [-0.08, 0.0, 0.05])
def test_a_side_is_measured_whatever_way_the_car_takes(tilt: float) -> None:
    sums = Sums()
    for n in range(30):
        u, w = 0.1 * n, 0.3 + 0.05 * math.sin(0.2 * n)
        sums = add(sums, u, w, (w + 1.0 - tilt * u) / math.hypot(1.0, tilt))
    b = slope(sums, Sums())
    assert b == pytest.approx(tilt, abs=1e-9)
    assert offset(sums, b) == pytest.approx(-1.0, abs=1e-9)


@pytest.mark.parametrize("sense", [-1.0, 1.0])
@pytest.mark.parametrize("tilt", [-0.06, 0.0, 0.06])
def test_a_corner_is_where_its_echoes_come_from(sense: float, tilt: float) -> None:
    line = FittedLine(-1.0, tilt)
    place = 4.0
    samples = NO_SAMPLES
    for n in range(4):
        u = place - sense * (0.2 + 0.08 * n)
        samples = append(samples, Heard(u, 0.0, math.hypot(u - place, 1.0 - tilt * place)), n)
    assert corner(samples, line, sense, HALF) == pytest.approx(place, abs=1e-9)


@pytest.mark.parametrize("tilt", [-0.2, 0.0, 0.2])
def test_a_corner_that_no_echo_tells_is_half_way_to_where_it_would_have_been_heard(tilt: float) -> None:
    """So far apart that half way is where the sensor's own distance meets the side: its foot."""
    line, untold = FittedLine(-1.0, tilt), 0.25
    d = 1.0 / math.hypot(1.0, tilt)
    rim = math.tan(HALF + math.atan(tilt))
    samples = append(NO_SAMPLES, Heard(0.0, 0.0, d), 0)
    samples = append(samples, Heard(-d * (rim + untold), -tilt * d * (rim + untold), d), 1)
    assert corner(samples, line, -1.0, HALF) == pytest.approx(tilt / (1.0 + tilt * tilt), abs=1e-9)


@pytest.mark.parametrize(("off", "belongs"), [(0.0, True), (0.05, True), (0.06, False), (-0.05, True), (-0.06, False)])
def test_how_far_off_a_new_side_a_sample_may_lie_follows_from_how_sure_its_slope_is(off: float, belongs: bool) -> None:
    known, begun = Sums(), add(Sums(), 10.0, 0.0, 1.0)
    for n in range(10):
        known = add(known, 0.1 * n, 0.0, 1.0)
    after = with_sample(begun, known, Heard(10.2, 0.0, 1.0 + off), 2)
    assert after.n == (2.0 if belongs else 1.0)
    assert belongs or after.r == (1.0 if off > 0.0 else 1.0 + off), (
        "a nearer one shows that the one before was a corner's"
    )


@pytest.mark.parametrize("tilt", [-0.2, 0.0, 0.2])
@pytest.mark.parametrize("known", [False, True])
def test_a_side_is_what_most_samples_agree_on(tilt: float, known: bool) -> None:
    window, noise = NO_WINDOW, (0.02, -0.025, 0.0, 0.03, -0.02)
    corner_at, spacing = 1.6, 0.3
    for n in range(8):
        u = spacing * n
        reached = min(u, corner_at)
        far = (
            math.hypot(u - reached, 1.0 - tilt * reached) if u > corner_at else (1.0 - tilt * u) / math.hypot(1.0, tilt)
        )
        window = taken_up(window, Heard(u, 0.0, far + noise[n % 5]))
    told = agreed(window, 0.28, known, tilt)
    assert told.n >= 5.0
    assert slope(told, Sums()) == pytest.approx(tilt, abs=0.05)


def test_samples_that_lie_before_it_are_of_no_corner() -> None:
    window = NO_WINDOW
    for n in range(6):
        window = taken_up(window, Heard(0.3 * n, 0.0, 1.3 if n < 4 else 1.0))
    assert agreed(window, 0.28, False, 0.0).n < 4.0
    assert agreed(NO_WINDOW, 0.28, False, 0.0).n == 0.0


def test_all_of_a_neighbour_is_kept_in_places_of_equal_way() -> None:
    window = NO_WINDOW
    for n in range(100):
        window = taken_up(window, Heard(0.1 * n, 0.0, 1.0 + 0.1 * n))
    kept = [sample for sample in window.samples if sample.r > 0.0]
    assert PLACES // 2 <= len(kept) <= PLACES
    assert [sample.r - sample.u for sample in kept] == pytest.approx([1.0] * len(kept))
    assert kept[-1].u == pytest.approx(0.05 * (window.each - 1)), "the first ones too"
    assert [one.u - two.u for one, two in pairwise(kept)] == pytest.approx([0.1 * window.each] * (len(kept) - 1))


@pytest.mark.parametrize("tilt", [-0.1, 0.0, 0.1])
@pytest.mark.parametrize("far", [1.5, 3.0])
def test_what_is_heard_of_a_corner_ahead_is_not_taken_for_the_side(tilt: float, far: float) -> None:
    """A slow car hears a far corner for metres before it is beside the neighbour, and it comes nearer evenly."""
    side = START
    for n in range(120):
        u = -3.0 + 0.08 * n
        r = _heard_beside(u, far, tilt, 4.0)
        side = search_side.hear(side, u, 0.0, 0.011 * round(r / 0.011), HALF, ControllerParams().apa.search)
    assert side.mode == GAP
    b = slope(side.before, Sums())
    assert b == pytest.approx(tilt, abs=0.02)
    assert offset(side.before, b) + b * side.edge == pytest.approx(-far + tilt * 4.0, abs=0.03)


def _heard_beside(u: float, far: float, tilt: float, length: float) -> float:
    """Return what a sensor at u hears of the side from 0 to ``length`` on the line -far + tilt u."""
    points = [(0.01 * n, -far + tilt * 0.01 * n) for n in range(round(100 * length) + 1)]
    seen = [(x, y) for x, y in points if abs(x - u) <= -y * math.tan(HALF)]
    return min((math.hypot(x - u, y) for x, y in seen), default=DEEP)


@pytest.mark.parametrize("sensor", [8, 10])
def test_nothing_heard_is_no_wall_at_the_end_of_what_sensors_hear(sensor: int) -> None:
    side = START
    for n in range(20):
        inputs = ControllerInput(odometry=Pose(0.1 * n, 0.0, 0.0), ultrasonic=(5.0,) * 12)
        side = _hear(side, LEFT if sensor == LEFT_SENSOR else RIGHT, Pose(), inputs, ControllerParams())
    assert side.last.r >= DEEP


def scene(kind: str, length: float, side: int, speed: float, **more: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the parameters of a drive past two neighbours with a gap of ``length`` between them."""
    vehicle, controller = car_settings(CAR)
    along, deep = (4.4, 1.8) if kind == "parallel" else (1.8, 4.6)
    for number, x in enumerate((-along, length), start=1):
        vehicle |= box(number, x, x + along, *((-deep, 0.0) if side > 0 else (0.0, deep)))
    vehicle |= {"start.x": -along - 4.0, "start.y": side * (1.0 + 0.5 * CAR.width), "driver.apa_switch_time": 0.1}
    return vehicle | {"driver.profile[1].speed": speed} | more, controller


@pytest.mark.parametrize(("kind", "length"), [("parallel", 6.4), ("perpendicular", 3.1)])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("speed", [1.5, 5.0])
def test_corners_are_found_within_10_cm(kind: str, length: float, side: int, speed: float) -> None:
    noise = {"ultrasonic.noise": 0.01, "ultrasonic.dropout": 0.01}
    vehicle, controller = scene(kind, length, side, speed, **noise)
    run = drive(vehicle, controller, 16.0, keep=True)
    shown = next(asked for _, _, asked in run.rows if asked.apa.mode == 3)
    assert shown.apa.slot.kind == (1 if kind == "parallel" else 2)
    assert shown.apa.slot.side == (0 if side > 0 else 1)
    assert math.hypot(shown.apa.slot.a.x, shown.apa.slot.a.y) < 0.1
    assert math.hypot(shown.apa.corner_b.x - length, shown.apa.corner_b.y) < 0.1


def test_a_gap_too_short_is_refused_with_what_is_missing() -> None:
    vehicle, controller = scene("parallel", 4.7, 1, 2.5)
    run = drive(vehicle, controller | {"apa.search.way": 20.0}, 30.0)
    assert run.controller.apa.slots == 0
    assert run.controller.reason == 24
    assert 0.2 < run.controller.apa.missing < 2.0


def test_no_slot_is_seen_where_there_is_none() -> None:
    vehicle, controller = car_settings(CAR)
    vehicle |= box(1, -2.0, 9.0, -1.8, 0.0) | {"start.x": -8.0, "start.y": 1.9, "driver.apa_switch_time": 0.1}
    run = drive(vehicle | {"driver.profile[1].speed": 3.0}, controller | {"apa.search.way": 25.0}, 30.0)
    assert (run.controller.apa.slots, run.controller.reason) == (0, 23)


def test_one_lost_echo_does_not_end_a_neighbour_however_fast_the_search() -> None:
    """Readings each 33 cm, as at 20 km/h: one that is lost is no gap, two are."""

    def after(lost: set[int]) -> int:
        side = START
        for number in range(14):
            reading = 5.0 if number in lost else 1.0
            side = search_side.hear(
                side, 0.33 * number, 0.0, reading, math.radians(30.0), ControllerParams().apa.search
            )
        return side.mode

    assert after(set()) == WALL
    assert after({8}) == WALL
    assert after({10, 11, 12, 13}) == GAP


def past_faces(faces: tuple[tuple[float, float], ...], lean: float, spacing: float, lost: set[int]) -> SideState:
    """Return a side past faces that begin and end there, beside the last of them, for a car that leans to the row."""
    side, settings = START, ControllerParams().apa.search
    for number in range(int(faces[-1][1] / spacing)):
        u = spacing * number
        away = 1.0 + lean * (faces[-1][1] - u)
        reach = away * math.tan(HALF)
        heard = [math.hypot(away, max(a - u, u - b, 0.0)) for a, b in faces if a - reach < u < b + reach]
        reading = min(heard, default=DEEP) if number not in lost else DEEP
        side = search_side.hear(side, u, away if lean else 1.0, reading, HALF, settings)
    return side


@pytest.mark.parametrize(("length", "lean"), [(4.4, 0.0), (4.4, 0.14), (1.8, 0.0), (1.8, 0.14)])
def test_a_neighbour_is_as_long_as_it_is_however_far_away_it_begins(length: float, lean: float) -> None:
    """Towards a row that is first heard 3.7 m away, farther than neighbours are looked at."""
    side = past_faces(((8.0, 8.0 + length), (14.0 + length, 18.0 + length)), lean, 0.12, set())
    assert side.extent == pytest.approx(length, abs=0.35)


@pytest.mark.parametrize("lost", [set(), {30}, {30, 31}, {30, 31, 35, 36}])
def test_lost_echoes_do_not_split_a_neighbour(lost: set[int]) -> None:
    """At 23 km/h a reading each 36 cm: two that are lost look like a gap of a metre."""
    side = past_faces(((8.0, 12.4), (18.4, 22.8)), 0.0, 0.36, lost)
    assert (side.extent, side.edge_b) == (pytest.approx(4.4, abs=0.4), pytest.approx(18.4, abs=0.3))


def test_a_gap_past_whose_corner_something_is_heard_is_one() -> None:
    side = past_faces(((8.0, 9.8), (12.7, 14.5)), 0.0, 0.4, set())
    assert (side.extent, side.edge_b) == (pytest.approx(1.8, abs=0.3), pytest.approx(12.7, abs=0.3))


@pytest.mark.parametrize(
    ("length", "neighbour", "kind"),
    [
        (6.0, 4.0, Kind.PARALLEL),
        (6.0, 2.6, Kind.PERPENDICULAR),
        (6.0, 0.8, Kind.PARALLEL),
        (4.8, 0.8, Kind.PERPENDICULAR),
        (3.0, 4.0, Kind.PERPENDICULAR),
    ],
)
def test_the_neighbour_tells_the_kind_of_a_gap_that_nothing_ends(length: float, neighbour: float, kind: Kind) -> None:
    """Shorter than any car: not known, and two cars side by side leave their place free less often than one along."""
    car = shape_of(ControllerParams())
    assert kind_of(length, UNSEEN, neighbour, car, ControllerParams().apa) == kind


def test_a_neighbour_whose_line_has_begun_anew_ends_where_the_one_before_says() -> None:
    """Nine bins level, six that are 12 cm farther, then an end whose distance grows by less than a step each bin."""
    readings = [1.5] * 9 + [1.62] * 6 + [1.62 + 0.3 * number for number in range(1, 8)]
    side = START
    for number, reading in enumerate(readings):
        side = search_side.hear(side, 0.15 * number, 0.0, reading, HALF, ControllerParams().apa.search)
    assert side.mode == GAP
    assert side.before.n >= 7.0


def test_a_slot_whose_second_neighbour_is_a_wall_behind_is_none() -> None:
    """Something nearer stands before it. Who goes on along the same wall, or passes another side, keeps the slot."""
    gap = START._replace(mode=WALL, edge=2.0, edge_b=5.2)
    state = SearchState(slots=(Slot(kind=2, side=1), Slot(kind=1, side=0), Slot()), valid=2)
    nearer = begin_wall(gap, Heard(6.0, 0.0, 1.0))
    assert _kept_but_behind(state, gap, nearer, LEFT) == state._replace(slots=(state.slots[1], Slot(), Slot()), valid=1)
    assert _kept_but_behind(state, gap, nearer, RIGHT) == state
    assert _kept_but_behind(state, gap, gap, LEFT) == state
    assert _kept_but_behind(state, gap, gap._replace(mode=GAP, edge_b=0.0), LEFT) == state


@pytest.mark.parametrize(
    ("beyond", "again", "between"), [(3.2, 2.7, True), (3.2, 3.15, False), (DEEP, 2.7, False), (2.6, 2.5, False)]
)
def test_one_reading_beyond_a_corner_is_a_gap_where_the_next_one_comes_near(
    beyond: float, again: float, between: bool
) -> None:
    """Towards the row a wide cone hears both corners, and one reading between them; a lost echo is none."""
    side = SideState(
        samples=(Heard(15.2, -0.8, 2.85), Heard(14.9, -0.8, 2.68), Heard(), Heard()),
        faces=(Heard(15.5, -0.8, beyond), Heard(), Heard(), Heard()),
    )
    assert is_between(side, Heard(15.8, -0.8, again)) == between
