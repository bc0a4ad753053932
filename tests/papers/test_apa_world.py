"""The parking assist in the world: the scenes are as said, a run's end is what it touched, rows come back."""

import math
from pathlib import Path

import numpy as np
import pytest

from modelkit.geometry import Box, boxes_gap, corners
from orchestrator.commands.sweep import chosen_study
from orchestrator.grid.world import ends
from orchestrator.grid.world.factors import FACTORS
from orchestrator.grid.world.study import fields, space, study
from orchestrator.sweep.repeat import repeat_row
from orchestrator.sweep.study.study import Study
from orchestrator.sweep.sweep import Options, sweep
from orchestrator.sweep.table import Table


def columns(made: Study) -> dict[str, np.ndarray]:
    return {field.key: column for field, column in zip(made.design.fields, made.design.values.T, strict=True)}


def box(values: dict[str, np.ndarray], number: int, run: int) -> Box:
    return Box(*(values[f"vehicle.scene.boxes[{number}].{name}"][run] for name in Box._fields))


def test_neighbours_leave_the_slot_free_however_they_stand() -> None:
    made = study(200, 3)
    values, labels = columns(made), made.design.labels
    for run in range(200):
        sides = [list(corners(box(values, number, run))) for number in (1, 2)]
        slot = sides[1][0].x - sides[0][0].x
        assert max(p.x for p in sides[0]) == pytest.approx(0.0, abs=1e-9)
        length = values["slot.length" if labels["kind"][run] == 0 else "slot.width"][run]
        assert min(p.x for p in sides[1]) == pytest.approx(length, abs=1e-9)
        assert slot > 0.0


def test_a_parked_car_touches_nothing_where_it_is_to_stand() -> None:
    """Flush, half way between the neighbours' directions: free in slots of half a metre more than the shortest."""
    made = study(400, 4)
    values, labels = columns(made), made.design.labels
    gaps = []
    for run in range(400):
        wheelbase, front, rear, width = (
            values[f"vehicle.car.{name}"][run] for name in ("wheelbase", "front_overhang", "rear_overhang", "width")
        )
        pose = [values[f"target.{axis}"][run] for axis in ("x", "y", "heading")]
        ahead = 0.5 * (wheelbase + front - rear)
        middle = (pose[0] + ahead * math.cos(pose[2]), pose[1] + ahead * math.sin(pose[2]))
        car = Box(*middle, pose[2], wheelbase + front + rear, width)
        if labels["extra"][run] > 0.5:
            gaps += [boxes_gap(car, box(values, number, run)) for number in (1, 2)]
        slot = Box(*(values[f"slot.{name}"][run] for name in Box._fields))
        assert boxes_gap(car, slot) == 0.0
    assert min(gaps) > 0.25


def test_at_the_nominal_point_nothing_is_disturbed() -> None:
    world = space(list(FACTORS))
    named = world.named(world.nominal()[None])
    assert {factor.name: named[factor.name][0] for factor in FACTORS} == pytest.approx(
        {factor.name: factor.nominal for factor in FACTORS}
    )
    mild = [factor.mild() for factor in FACTORS]
    assert all(
        own.low <= half.low <= half.nominal <= half.high <= own.high for own, half in zip(FACTORS, mild, strict=True)
    )


def test_fewer_runs_are_the_first_of_more() -> None:
    few, many = study(5, 7), study(9, 7)
    assert (many.design.values[:5] == few.design.values).all()
    assert (many.design.seeds[:5] == few.design.seeds).all()
    assert (study(5, 8).design.values != few.design.values).any()
    assert len(fields()) == few.design.values.shape[1]


def test_a_contact_is_the_end_whatever_is_said_after_it() -> None:
    touched = {"touched.x": 1.0, "touched.mode": 4.0, "touched.takeover": 0.0, "mode": 6.0, "reason": "none"}
    assert ends.end_of({**touched, "kind": 0.0, "within GB/T 41630, parallel": True}) == ends.CONTACT
    assert ends.end_of({**touched, "touched.mode": 2.0}) == ends.DRIVER
    free = {**touched, "touched.x": math.nan, "kind": 1.0}
    assert ends.end_of({**free, "within GB/T 41630, perpendicular": True}) == ends.PARKED
    assert ends.end_of({**free, "within GB/T 41630, perpendicular": False}) == ends.FALSE
    assert ends.end_of({**free, "mode": 7.0, "reason": "no_slot"}) == ends.FAILED
    assert ends.end_of({**free, "mode": 4.0}) == ends.ENDLESS


def test_a_contact_of_the_table_comes_back(tmp_path: Path) -> None:
    """The first runs of a draw: each row says how it ended and who was touched; one that touched is run again."""
    made = chosen_study("apa-world", ["runs=60", "seed=1"])
    swept = sweep(made, tmp_path, Options())
    assert swept.table is not None
    table = Table(swept.table)
    ended, touched = table.column("end"), table.column("touched")
    assert set(ended.tolist()) <= set(ends.ENDS)
    assert ends.PARKED in ended
    assert ((touched != "") == np.isfinite(table.column("touched.x"))).all()
    again = repeat_row(table, int(np.flatnonzero(ended == ends.PARKED)[0]), tmp_path / "again", pages=False)
    assert again.different == []
