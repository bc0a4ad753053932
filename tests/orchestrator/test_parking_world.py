"""The parking study: the same rows for each system, what stands in its scenes, outcomes by the scene alone."""

import numpy as np
import pytest

from orchestrator.studies.parking.parking_world.factors import FACTORS, HITCH
from orchestrator.studies.parking.parking_world.outcome import DRIVER, FALSE, MOVING, PARKED, STANDING, end_of, is_valid
from orchestrator.studies.parking.parking_world.scene import BIN, OVERHANG, ROWS, parameters
from orchestrator.studies.parking.parking_world.study import VALET_SYSTEM, study
from orchestrator.studies.sweep.study.space import Space

SPACE = Space(FACTORS, lambda values, seeds: np.zeros((len(seeds), 1)))
ROW = {"kind": 0, "outcome": "parked", "reason": "all checks passed", "steered": 1.0, "touched.speed": float("nan")}


def drawn(count: int = 200) -> dict[str, np.ndarray]:
    return SPACE.values_by_name(np.random.default_rng(5).random((count, len(FACTORS))))


def test_rows_do_not_depend_on_the_system() -> None:
    one, other = study(20, 3), study(20, 3, VALET_SYSTEM)
    assert np.array_equal(one.design.values, other.design.values, equal_nan=True)
    assert one.scenario.controller["system"] != other.scenario.controller["system"]


def test_cars_of_a_row_stand_apart_by_their_gap() -> None:
    f = drawn()
    found = parameters(f, np.arange(1, 201))
    along = np.where(f["kind"] == 0, f["length_b"], f["width_b"])
    first, second = (found[f"scene.boxes[{number}].x"] for number in ROWS["b"][:2])
    assert second - first - along == pytest.approx(f["gap_b"])
    for place, number in enumerate(ROWS["a"]):
        assert np.array_equal(found[f"scene.boxes[{number}].length"] > 0.0, f["cars_a"] > place)


def test_a_hitch_shortens_a_parallel_slot_and_a_bin_leaves_none() -> None:
    f = drawn()
    found = parameters(f, np.arange(1, 201))
    valid = is_valid(f)
    short = (f["kind"] == 0) & (f["overhang"] >= HITCH) & (f["overhang_length"] > f["extra"])
    assert short.any()
    assert not valid[short].any()
    assert not valid[found[f"scene.boxes[{BIN}].length"] > 0.0].any()
    beside = (f["kind"] == 0) & (found[f"scene.boxes[{OVERHANG}].length"] > 0.0)
    x, length = (found[f"scene.boxes[{OVERHANG}].{name}"][beside] for name in ("x", "length"))
    assert x - 0.5 * length == pytest.approx(np.zeros(beside.sum()))
    assert valid.mean() > 0.5


@pytest.mark.parametrize(
    ("changed", "valid", "end"),
    [
        ({}, True, PARKED),
        ({}, False, FALSE),
        ({"within parallel": False}, True, FALSE),
        ({"touched.speed": -0.06}, True, MOVING),
        ({"touched.speed": 0.05}, True, STANDING),
        ({"touched.speed": 0.5, "touched.steering_active": 0.0}, True, DRIVER),
        ({"touched.speed": 0.5, "touched.takeover": 1.0}, True, DRIVER),
        ({"touched.speed": 0.0, "touched.steering_active": 0.0}, True, STANDING),
    ],
)
def test_how_a_run_ends(changed: dict[str, float], valid: bool, end: str) -> None:
    from orchestrator.studies.parking.parkings import GBT
    from orchestrator.studies.sweep.columns import WITHIN

    within = changed.get("within parallel", True)
    row = {**ROW, "touched.takeover": 0.0, "touched.steering_active": 1.0, **changed, WITHIN.format(GBT[1]): within}
    assert end_of(row, valid) == end
