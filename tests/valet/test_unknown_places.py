"""What no search has heard: beyond a slot's neighbours, and beside the way into it."""

import math
from typing import Any

import pytest

from controller_fmu.common.sensors import sensor_at
from controller_fmu.planning.plan import PATH, Path, Piece
from controller_fmu.planning.plan_store import HEARD, SIDES, PlanStore
from controller_fmu.planning.task import CORNERS, Corner
from controller_fmu.sensing.ear import SideEar
from controller_fmu.sensing.gap import Gap, GapLayout
from controller_fmu.sensing.heard_store import MOST_LINES, put_line
from controller_fmu.valet.found import nearby as module_of_places
from controller_fmu.valet.found.nearby import Nearby, Rest, hear_nearby, is_off_map, lay_nearby
from controller_fmu.valet.params import ValetParams, ValetSearchParams
from controller_fmu.valet.sight import look
from controller_fmu.valet.signals import ValetInput
from modelkit.store import new_store
from modelkit.vocabulary import Pose
from tests.planning.plan_model import Scene
from tests.planning.scenes import take
from tests.valet.test_valet_found import ACROSS, heard

FAR_OFF = 5.0
PLACE = (6.0, -0.3)
"""Beyond the slot's second neighbour."""


@pytest.mark.parametrize(("sensor", "reading"), [(10, 0.4), (3, 0.4), (10, 0.55), (3, 0.55)])
@pytest.mark.parametrize("known", [0.3, 0.2, None])
@pytest.mark.parametrize("apart", [True, False])
def test_beyond_the_neighbours_what_is_much_nearer_than_known_stops_the_car_sooner(
    sensor: int, reading: float, known: Any, apart: bool
) -> None:
    params = ValetParams()._replace(search=ValetSearchParams()._replace(active=True))
    width = params.car.width
    at = sensor_at(params.car.ultrasonic.mounts[sensor], Pose())
    off = reading + (known or FAR_OFF)
    x, y = at.x + off * math.cos(at.heading), at.y + off * math.sin(at.heading)
    aside = Pose(-math.sin(at.heading), math.cos(at.heading))
    line = [Corner(x + end * aside.x, y + end * aside.y, 1) for end in (-0.1, 0.1)]
    scene = Scene((line[0], line[1]) + (Corner(),) * (CORNERS - 2))
    store = new_store(PlanStore)
    take(store, scene)
    echo = at.x + reading * math.cos(at.heading)
    b = echo - width - (0.05 if apart else -0.05)
    gap = Gap(GapLayout.ACROSS, Pose(b - 2.8, -2.0), Pose(b, -2.0), -0.5 * math.pi, width=2.8)
    readings = tuple(reading if number == sensor else FAR_OFF for number in range(12))
    inputs = ValetInput(odometry=Pose(), measured_speed=1.2, ultrasonic=readings)
    blocked = look(store, inputs, Piece(1.0), gap, params).blocked
    assert blocked == (apart and reading < 0.5 and known != 0.2)


@pytest.mark.parametrize(
    ("x", "y", "off"),
    [
        (1.0, -6.0, False),
        (1.0, 0.8, False),
        (1.0, 1.2, True),
        (-0.12, -3.0, True),
        (-0.08, -3.0, False),
        (2.92, 0.0, True),
    ],
)
def test_what_is_behind_a_slot_is_what_it_ends_at_and_off_no_map(x: float, y: float, off: bool) -> None:
    store, _ = heard(((x, y), (x + 0.2, y)))
    assert is_off_map(store, SIDES * HEARD, ACROSS) == off


def rest_to(y: float) -> Rest:
    """Return the rest of a way straight along the row at this y [m]."""
    path = Path(pieces=(Piece(6.0),) + (Piece(),) * (PATH - 1), used=1, margin=0.12)
    return Rest(path, 0, Pose(0.0, y, 0.0), 6.0)


def hears(monkeypatch: pytest.MonkeyPatch, store: PlanStore, state: Nearby, rest: Rest) -> Nearby:
    """Return the ears after a sample without news, in a store that has their places already."""
    monkeypatch.setattr(module_of_places, "listen", lambda _, ear, *__: ear)
    params = ValetParams()
    return hear_nearby(store, state._replace(forward=True), ValetInput(), rest, ACROSS, params)


@pytest.mark.parametrize(
    ("off_map", "off_way", "stops"), [(0.12, 0.03, True), (0.08, 0.03, False), (0.12, 0.08, False), (None, 0.03, True)]
)
def test_a_place_that_the_map_does_not_have_stops_a_car_that_would_come_near(
    monkeypatch: pytest.MonkeyPatch, off_map: Any, off_way: float, stops: bool
) -> None:
    store, state = heard((PLACE, (PLACE[0] + 0.15, PLACE[1])))
    if off_map is not None:
        put_line(store, 0, 0.0, PLACE[1] - off_map, 20.0, PLACE[1] - off_map)
    half = 0.5 * ValetParams().car.width
    assert hears(monkeypatch, store, state, rest_to(PLACE[1] + half + off_way)).in_the_way == stops


def test_places_are_lines_of_the_map_when_the_way_is_planned_anew_those_in_the_slot_first() -> None:
    inside = ((1.0, -0.5), (1.0, -0.8))
    for lines, laid in ((0, (3, 2)), (MOST_LINES - 3, (3, 0))):
        store, state = heard((PLACE, (PLACE[0] + 0.3, PLACE[1])), inside)
        lay_nearby(store, state, ACROSS, lines)
        xs = [store.around_x[2 * line] for line in range(lines, MOST_LINES) if store.around_of[2 * line] > 0]
        assert (sum(x < 2.0 for x in xs), sum(x > 5.0 for x in xs)) == laid
        again = [store.around_x[2 * line] for line in range(MOST_LINES)]
        lay_nearby(store, state._replace(ears=(state.ears[0],) + (SideEar(),) * 3), ACROSS, lines + 5)
        assert lines > 0 or [store.around_x[2 * line] for line in range(MOST_LINES)] == again
