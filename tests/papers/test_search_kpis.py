"""The search in numbers: what is counted as found, missed, false and refused, and a part of the study."""

import math

import numpy as np
import pytest

from orchestrator.simulation.cosim.fmu_files import can_compile
from orchestrator.studies.parking.search_kpis import (
    BESIDE,
    FALSE,
    FOUND,
    HEADS,
    MISSED,
    REFUSED,
    SPEEDS,
    cases,
    groups,
    kpis,
    rows_of,
    study_of,
)
from orchestrator.studies.sweep.in_memory import columns_in_memory


def columns(**more: list[object]) -> dict[str, np.ndarray]:
    given: dict[str, list[object]] = {
        "row": list(range(4)),
        "search": [FOUND, MISSED, FALSE, REFUSED],
        "extra": [0.0, 0.8, -0.5, -0.5],
        "outcome": ["parked", "failed", "failed", "failed"],
        "corner_a": [0.02, math.nan, 0.1, math.nan],
        "corner_b": [0.05, math.nan, 0.1, math.nan],
        "slot_heading": [-0.01, math.nan, 0.3, math.nan],
        "kind_right": [1.0, math.nan, 0.0, math.nan],
        "parking_time": [20.0, 0.0, 0.0, 0.0],
        "manoeuvres": [2, 0, 0, 0],
        "kind": ["parallel"] * 4,
        "speed": [5.0] * 4,
        "beside": [0.5] * 4,
        **more,
    }
    return {name: np.array(values) for name, values in given.items()}


def test_what_is_counted() -> None:
    found = kpis(columns(), np.ones(4, dtype=bool))
    assert (found.fits, found.found, found.small, found.false, found.right, found.parked) == (2, 1, 2, 1, 1, 1)
    assert found.corner == (0.05, 0.05)
    assert found.heading == (0.01, 0.01)
    assert found.time == (20.0, 20.0)


def test_a_group_without_runs_has_no_numbers() -> None:
    found = kpis(columns(), np.zeros(4, dtype=bool))
    assert (found.fits, found.found) == (0, 0)
    assert math.isnan(found.corner[0])


def test_every_run_is_in_one_group_of_each_kind() -> None:
    made = dict(groups(columns()))
    assert sum(rows.sum() for name, rows in made.items() if name.endswith("km/h")) == 4
    assert sum(rows.sum() for name, rows in made.items() if name.endswith("beside")) == 4
    assert len(rows_of(columns())) == len(made) == 3 + len(SPEEDS) + len(BESIDE)
    assert all(len(line) == 1 + len(HEADS) for line in rows_of(columns()))


def test_cases_follow_from_their_number() -> None:
    assert cases(0)[17] == cases(0)[17]
    assert cases(0)[17] != cases(1)[17]
    assert {(case.kind, case.extra < 0.0) for case in cases()} == {(1, False), (1, True), (2, False), (2, True)}
    assert {case.side for case in cases()} == {1, -1}
    assert {case.body for case in cases()} == {"kinematic", "double_track"}


@pytest.mark.skipif(not can_compile(), reason="runs of seconds take a C compiler")
def test_a_part_of_the_study() -> None:
    """One in 32: every gap that fits is found at its place, nothing is touched.

    Gaps of the car's width and half a metre, narrower than ISO 16787 requires, are used.
    """
    found = columns_in_memory(study_of(cases()[5::32]))
    made = kpis(found, np.ones(len(found["row"]), dtype=bool))
    assert made.fits == made.found == made.right == 8
    assert (made.small, made.false) == (4, 2)
    assert made.corner[0] < 0.1
    assert (found["min_clearance"] > 0.0).all()
    assert set(found["search"]) == {FOUND, FALSE, REFUSED}
