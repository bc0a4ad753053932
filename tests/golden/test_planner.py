"""What the parking assist's planner tries, beside what it tried when ``planner.json`` was last written.

A drive takes the best of hundreds of candidates; a mistake in one that is seldom the best shows in no scenario. Here
each family is asked for candidates spread over it, from several starts into several slots: how many lead in, and sums
of what they cost and where their first moves end. ``pytest tests/golden --update`` writes the file anew.
"""

import json
import math
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from controller_fmu.apa.around.course import HeldCourse
from controller_fmu.apa.around.guard import GuardState, listen, watch_way
from controller_fmu.apa.around.local_map import LocalMap
from controller_fmu.apa.slot import Kind, Site
from controller_fmu.apa.ways import planner
from controller_fmu.apa.ways.exit import VARIANTS, exit_of, way_out
from controller_fmu.apa.ways.fit import fit_of, least_moves
from controller_fmu.apa.ways.move import end_of, length_of
from controller_fmu.apa.ways.start_range import start_range
from controller_fmu.registry import ControllerParams
from modelkit.vocabulary import Pose
from tests.controller.apa_cars import shape_of, slot_and_site, start_of

FILE = Path(__file__).parent / "planner.json"
PARAMS = ControllerParams()
CAR = shape_of("middle")
EXTRA = {"just": 0.0, "ample": 1.0}
KINDS = (Kind.PARALLEL, Kind.PERPENDICULAR)
BESIDE = ((1.0, 0.5, 0.0), (1.0, 1.0, 5.0), (0.5, 1.5, -5.0), (3.5, 2.0, 0.0), (1.5, 3.5, 0.0))
"""Starts on the road: ahead of the slot [m], beside it [m], heading [deg]."""
INSIDE = (Pose(0.1, 0.12, 0.06), Pose(0.0, -0.08, -0.1))
"""Starts in the slot, seen from the target."""
PER_FAMILY = 40
DIGITS = 6
TOLERANCE = 1e-5


def tried() -> dict[str, Any]:
    """Return family of candidates, slot and start -> what it gives."""
    found: dict[str, Any] = {}
    for kind, (extra, longer) in product(KINDS, EXTRA.items()):
        name = f"{kind.name.lower()} {extra}"
        slot, site = slot_and_site(CAR, kind, longer)
        exits = [exit_of(variant, site, CAR) for variant in range(VARIANTS)]
        found[f"exits, {name}"] = [rounded(way.found, way.moves, *way.pose) for way in exits]
        found[f"fit, {name}"] = rounded(*fit_of(slot, CAR, PARAMS.apa), least_moves(slot, CAR, PARAMS.apa))
        ranges = [start_range(y, h, exits[0], site, CAR) for y in (2.0, 2.6, 3.2) for h in (-0.1, 0.0, 0.1)]
        found[f"ranges, {name}"] = [rounded(*item) for item in ranges]
        starts = [start_of(slot, site, CAR, far, beside, math.radians(turned)) for far, beside, turned in BESIDE]
        for number, start in enumerate([*starts, *INSIDE]):
            for family, rows in families(start, site, exits).items():
                found[f"{family}, {name}, {number}"] = rows
    found["ways out"] = rounded(*(way_out(Pose(0.0, y, h), CAR) for y in (-4.0, -2.5, -1.0, 0.3) for h in (0.0, 0.4)))
    found["sight"] = [rounded(*sight) for sight in sights()]
    return found


def families(start: Pose, site: Site, exits: list[Any]) -> dict[str, list[float]]:
    """Return number of a family -> (how many lead in, and sums) of its candidates spread over it."""
    sums = {}
    stages = [1, 2, 3, 4] + ([planner.ENTRY, planner.ENTRY + 4] if site.kind == Kind.PARALLEL else list(range(40, 46)))
    for stage in stages:
        count = planner.count_of(stage)
        total = [0.0] * 7
        for number in range(0, count, max(1, count // PER_FAMILY) | 1):
            way_in = exits[stage - planner.ENTRY] if planner.ENTRY <= stage < planner.TURN else exits[0]
            made = planner._candidate(stage, number, start, way_in, site, CAR)
            end = end_of(made.move)
            weight = 1.0 + number % 7
            parts = (made.found, made.moves, made.cost, length_of(made.move), end.x, end.y, end.heading)
            total = [old + weight * part for old, part in zip(total, parts, strict=True)]
        sums[f"family {stage}"] = rounded(count, *total)
    return sums


def sights() -> list[Any]:
    """Return what the guard says of readings near and far, before a wall known and not."""
    around = slot_and_site(CAR, Kind.PARALLEL, 0.5)[1].obstacles
    said = []
    for pose in (Pose(0.3, 0.2, 0.1), Pose(6.0, 2.5, 0.0), Pose(-0.4, 0.0, 0.0)):
        aside = LocalMap(pose=pose)._replace(
            a=LocalMap().a._replace(x=-50.0, y=-50.0), b=LocalMap().b._replace(x=50.0, y=-50.0)
        )
        for direction, which, (near, far) in product(
            (1, -1), (0, 1), ((0.2, 5.0), (0.45, 1.4), (0.8, 5.0), (1.2, 1.3))
        ):
            readings = tuple(near if place % 4 == which else far for place in range(12))
            course = HeldCourse(pose, direction, 0.1, 0.4 * direction, CAR)
            guard = listen(GuardState(), readings, aside, PARAMS)
            said.append(watch_way(guard, readings, aside, around, course, PARAMS))
    return said


def rounded(*values: Any) -> list[float]:
    return [round(float(value), DIGITS) + 0.0 for value in values]


@pytest.fixture(scope="module")
def kept(request: pytest.FixtureRequest) -> dict[str, Any]:
    if request.config.getoption("--update"):
        lines = ",\n".join(f"{json.dumps(name)}: {json.dumps(value)}" for name, value in tried().items())
        FILE.write_text(f"{{\n{lines}\n}}\n", encoding="utf-8")
    return json.loads(FILE.read_text(encoding="utf-8"))


def differing(kept: dict[str, Any]) -> list[str]:
    """Return what is tried otherwise than it was."""
    found = tried()
    same = pytest.approx
    return [
        name for name in found | kept if flat(found.get(name)) != same(flat(kept.get(name)), abs=TOLERANCE, rel=1e-9)
    ]


def flat(value: Any) -> list[float]:
    return [part for item in value for part in flat(item)] if isinstance(value, list) else [value]


def test_what_the_planner_tries_is_what_it_was(kept: dict[str, Any]) -> None:
    assert differing(kept) == []


def test_most_families_lead_in_somewhere(kept: dict[str, Any]) -> None:
    leading = {name.split(",")[0] for name, row in kept.items() if name.startswith("family") and row[1] > 0}
    assert leading >= {f"family {number}" for number in (2, 3, 4, 24, 42, 43, 44, 45)}
    assert len({tuple(row) for row in kept["sight"]}) >= 6
