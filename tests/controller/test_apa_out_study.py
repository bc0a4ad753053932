"""The study of ways out: where its cars stand, what is known of the ways, held against polygons of shapely."""

import pytest
from shapely.geometry import box

from controller_fmu.apa.slot import Kind
from modelkit.vocabulary import Pose
from orchestrator.studies.parking.cases import KINDS
from orchestrator.studies.parking.pull_out_cases import cases, start_of, things_of
from orchestrator.studies.parking.pull_out_feasibility import free_ahead, moves_out, shape_known
from orchestrator.studies.parking.pull_out_study import study
from tests.controller.test_apa_pull_out import outline


def test_every_car_stands_free_between_its_neighbours() -> None:
    chosen = cases(100)
    assert {case.kind for case in chosen} == set(KINDS)
    for case in chosen:
        body = outline(Pose(*start_of(case)), shape_known(case))
        things = {name: box(item.x0, item.y0, item.x1, item.y1) for name, item in things_of(case).items()}
        nearest = {name: body.distance(thing) for name, thing in things.items()}
        assert min(nearest.values()) > 0.0
        assert nearest["first"] + nearest["second"] == pytest.approx(case.extra, abs=0.2)


def test_what_is_free_ahead_is_what_the_row_leaves() -> None:
    along = next(case for case in cases(20) if case.kind == Kind.PARALLEL)
    x, y, heading = start_of(along)
    ahead = things_of(along)["second"].x0 - x - shape_known(along).front
    assert free_ahead(along, Pose(x, along.side * y, along.side * heading)) == pytest.approx(ahead, abs=0.15)
    assert free_ahead(along, Pose(x, along.side * (y + 4.0), 0.0)) >= 5.0


def test_with_more_room_there_is_a_way_and_with_none_there_is_none() -> None:
    case = next(case for case in cases(20) if case.kind == Kind.PARALLEL)._replace(behind="nothing", share=0.5)
    assert moves_out(case._replace(extra=2.0)) > 0
    assert moves_out(case._replace(extra=0.2)) == 0


def test_sides_are_told_to_the_assist_as_they_are() -> None:
    chosen, design = cases(12), study(12).design
    told = design.values[:, [field.key for field in design.fields].index("faults[2].value")]
    assert [{2.0: 1, 1.0: -1}[value] for value in told] == [case.side for case in chosen]
