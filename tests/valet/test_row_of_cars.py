"""How the cars of a row stand, where what was heard does not tell it at once; what is sure, what is waited for."""

import math
from statistics import linear_regression

import pytest

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing import find_gap as module_of_gaps
from controller_fmu.sensing.find_gap import TwoWays, find_gap
from controller_fmu.sensing.gap import UNHEARD, Gap, GapLayout, Wanted
from controller_fmu.sensing.heard_store import put_heard
from controller_fmu.sensing.places import PlacesFrame, along, frame_of
from controller_fmu.sensing.row_line import RowLine, row_of
from controller_fmu.sensing.rows import Sides
from controller_fmu.valet.found import search
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.signals import ValetInput
from modelkit.store import new_store
from modelkit.vocabulary import Pose
from tests.valet.test_valet_search import WANTED, passed, row


@pytest.mark.parametrize(("echoes", "there"), [((1, 1), False), ((1, 2), True), ((1, 1, 1), True)])
def test_places_joined_to_each_other_are_of_something_if_three_echoes_came_from_them(
    echoes: tuple[int, ...], there: bool
) -> None:
    store, ear, gap = passed(row(90, 1, 2.6), 1, 0.0)
    places = ear.places
    for number, count in enumerate(echoes):
        places = put_heard(store, 0, places, 0.2 * number, -1.0, number == 0)
        store.heard_count[places - 1] = count
    found = find_gap(store, 0, places, Pose(7.0, 2.0 - 0.825, 0.0), WANTED)
    assert (found.layout == GapLayout.NONE) == there
    assert there or found.width == pytest.approx(gap.width, abs=0.05)


@pytest.mark.parametrize(
    ("by", "both_show", "by_sides"), [(0.51, True, True), (0.49, True, False), (0.51, False, False)]
)
def test_where_both_faces_show_much_longer_sides_tell_before_what_is_free(
    monkeypatch: pytest.MonkeyPatch, by: float, both_show: bool, by_sides: bool
) -> None:
    frames = {name: along(frame_of(0, 0, Pose(), 0.5), 0.0, into) for name, into in (("one", 2.4), ("other", 0.8))}
    gaps = {name: Gap(layout=GapLayout.ACROSS, width=width) for name, width in (("one", 2.4), ("other", 2.6))}
    where = module_of_gaps.__name__
    monkeypatch.setattr(f"{where}._passed", lambda _, frame, *__: gaps["one" if frame is frames["one"] else "other"])
    monkeypatch.setattr(f"{where}.free_of_bodies", lambda _, frame, *__: 9 if frame is frames["one"] else 0)
    found = module_of_gaps._likelier(new_store(PlanStore), TwoWays(**frames, longer=by, both_show=both_show), WANTED)
    assert found == gaps["one" if by_sides else "other"]


@pytest.mark.parametrize(
    ("longer", "open_ended", "late"),
    [(0.2, False, (3.0, 7.0)), (0.1, False, (7.0, 7.0)), (-0.2, False, (7.0, 3.0)), (0.1, True, (50.0, 50.0))],
)
def test_a_gap_is_waited_for_where_sides_are_not_clearly_longer(
    monkeypatch: pytest.MonkeyPatch, longer: float, open_ended: bool, late: tuple[float, float]
) -> None:
    asked: list[float] = []
    where = module_of_gaps.__name__

    def waiting(store: PlanStore, frame: PlacesFrame, passed_by: float, want: Wanted) -> Gap:
        asked.append(passed_by)
        return Gap()

    monkeypatch.setattr(f"{where}._passed", waiting)
    frame = frame_of(0, 0, Pose(), 0.5)
    ways = TwoWays(frame, frame, longer, both_show=True)
    module_of_gaps._likelier(new_store(PlanStore), ways, WANTED._replace(open_ended=open_ended))
    assert tuple(asked) == late


@pytest.mark.parametrize(("at_end", "whole", "taken"), [(True, True, True), (True, False, False), (False, True, False)])
def test_a_whole_front_a_little_too_wide_is_a_front_at_the_end_if_it_leaves_no_gap_otherwise(
    monkeypatch: pytest.MonkeyPatch, at_end: bool, whole: bool, taken: bool
) -> None:
    sides = [Sides(2.12, whole), Sides(1.4)]
    found = Gap(layout=GapLayout.ACROSS, width=2.5)
    where = module_of_gaps.__name__
    monkeypatch.setattr(f"{where}.sides_along", lambda *_: sides.pop(0))
    monkeypatch.setattr(f"{where}.corridor", lambda *_: Gap())
    monkeypatch.setattr(f"{where}._deep", lambda *_: found)
    frame = frame_of(0, 0, Pose(), 0.5)
    gap = module_of_gaps._at_an_angle(new_store(PlanStore), frame, 0.5, 0.0, False, WANTED._replace(at_end=at_end))
    assert gap == (found if taken else Gap())


@pytest.mark.parametrize("at_end", [True, False])
def test_a_front_that_leaves_no_gap_tells_nothing_at_the_end(monkeypatch: pytest.MonkeyPatch, at_end: bool) -> None:
    sides = [Sides(1.9, front=True), Sides(1.2)]
    found = Gap(layout=GapLayout.ACROSS, width=2.5)
    where = module_of_gaps.__name__
    monkeypatch.setattr(f"{where}.sides_along", lambda *_: sides.pop(0))
    monkeypatch.setattr(f"{where}._deep", lambda *_: Gap())
    monkeypatch.setattr(f"{where}._likelier", lambda *_: found)
    frame, want = frame_of(0, 0, Pose(), 0.5), WANTED._replace(at_end=at_end)
    gap = module_of_gaps._at_an_angle(new_store(PlanStore), frame, 0.5, 0.0, False, want)
    assert gap == (found if at_end else Gap())


@pytest.mark.parametrize(("turn", "cars"), [(0.55, [False, True]), (0.7, [True])])
def test_a_corner_is_taken_for_a_post_where_the_sensor_looks_at_both_faces_of_cars(
    monkeypatch: pytest.MonkeyPatch, turn: float, cars: list[bool]
) -> None:
    asked: list[bool] = []
    where = module_of_gaps.__name__
    monkeypatch.setattr(f"{where}.turn_of", lambda *_: turn)
    monkeypatch.setattr(f"{where}.row_of", lambda *_: RowLine(turn - 0.78, 1.0, 3))

    def none(store: PlanStore, frame: PlacesFrame, *_: float) -> Gap:
        asked.append(frame.cars)
        return Gap()

    monkeypatch.setattr(f"{where}._at_an_angle", none)
    find_gap(new_store(PlanStore), 0, 0, Pose(), WANTED)
    assert asked == cars[:1]
    find_gap(new_store(PlanStore), 0, 0, Pose(), WANTED._replace(at_end=True))
    assert asked[1:] == cars


def test_a_row_passed_askew_is_the_line_on_which_its_cars_lie_though_they_stand_out_by_turns() -> None:
    store, places = new_store(PlanStore), 0
    corners = ((-12.0, -1.0), (-8.0, -1.7), (-3.0, -3.15), (0.5, -3.7))
    for x, y in corners:
        for number in range(20):
            places = put_heard(store, 0, places, x, y, number == 0)
    row = row_of(store, frame_of(0, places, Pose(), WANTED.half_angle), UNHEARD)
    assert row.things == 4
    slope = linear_regression(*zip(*corners, strict=True)).slope
    assert math.degrees(row.turn) == pytest.approx(-math.degrees(math.atan(slope)), abs=0.01)


@pytest.mark.parametrize(("at_end", "kept"), [(True, True), (False, False)])
def test_a_slot_found_is_kept_at_the_end_of_the_way_where_the_next_echo_leaves_it_unclear(
    monkeypatch: pytest.MonkeyPatch, at_end: bool, kept: bool
) -> None:
    params = ValetParams()
    told = [Gap(GapLayout.ACROSS, into=0.5), Gap()]
    monkeypatch.setattr(search, "listen", lambda store, ear, *_: ear._replace(rays=ear.rays + 1))
    monkeypatch.setattr(search, "find_gap", lambda *_: told.pop(0) if told else Gap())
    state = search.begin_search(0)._replace(way=params.search.way if at_end else 0.0)
    for _ in range(2):
        inputs = ValetInput(measured_speed=1.0)
        state = search.search(new_store(PlanStore), state, inputs, params, int(params.car.ultrasonic.cycle * 1e9))
    assert (state.gap.layout == GapLayout.ACROSS) == kept
