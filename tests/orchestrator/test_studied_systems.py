"""Studies of parking driven by a system that they were not written for: the same rows, what is set, what is kept."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from modelkit.variables import variables
from orchestrator.cli import main
from orchestrator.commands.sweep import select_study
from orchestrator.inputs.scenario.requirements import library_requirements
from orchestrator.simulation.cosim.fmu_files import can_compile
from orchestrator.studies.parking import detected_slot_study, pull_out_study, search_kpis, slot_rows, study
from orchestrator.studies.parking.cases import cases as grid_cases
from orchestrator.studies.parking.studied_systems import PARKING_SYSTEM, system_requirements
from orchestrator.studies.sweep.in_memory import columns_in_memory
from orchestrator.studies.sweep.study.imported_fmu import signals_of
from orchestrator.studies.sweep.study.study import Study

MADE: dict[str, Callable[..., Any]] = {
    "apa-grid": lambda **own: study.study_of(grid_cases()[:3], **own),
    "apa-out": lambda **own: pull_out_study.study(3, **own),
    "search-kpis": lambda **own: search_kpis.study_of(search_kpis.cases()[:3], **own),
}
"""Study written for another system -> some of its runs."""
OWN: dict[str, Callable[..., Any]] = {
    "valet-rows": slot_rows.study,
    "valet-slots": lambda **own: detected_slot_study.study(3, ways=True, **own),
}
"""Study written for this system -> some of its runs."""


def check(made: Study) -> None:
    known = signals_of(made.scenario)
    wanted = [measure.signal for measure in made.measures.values()]
    wanted += [item.signal for items in made.within.values() for item in items if "." in item.signal]
    assert [signal for signal in wanted if signal.startswith("controller.") and signal not in known] == []
    params = {item.name for item in variables(made.scenario.models["controller"].params)}
    assert {name for name in made.scenario.controller if name not in params} == set()


@pytest.mark.parametrize("name", sorted(MADE))
def test_the_rows_are_the_same_and_all_that_is_kept_exists(name: str) -> None:
    own, other = MADE[name](), MADE[name](system=PARKING_SYSTEM)
    assert other.name == f"{name}-{PARKING_SYSTEM}"
    assert other.scenario.controller["system"] == PARKING_SYSTEM
    check(own)
    check(other)
    vehicle = [
        {field.key: column for field, column in zip(made.design.fields, made.design.values.T, strict=True)}
        for made in (own, other)
    ]
    assert {key for key in vehicle[0] if key.startswith("vehicle.")} == {
        key for key in vehicle[1] if key.startswith("vehicle.")
    }
    for key, column in vehicle[0].items():
        if key.startswith("vehicle."):
            np.testing.assert_array_equal(column, vehicle[1][key])


@pytest.mark.parametrize("name", sorted(OWN))
def test_a_study_keeps_what_exists_and_sets_what_its_system_has(name: str) -> None:
    check(OWN[name]())


@pytest.mark.parametrize("name", sorted({**MADE, **OWN}))
def test_a_system_that_cannot_drive_a_study_is_refused(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", name, "--set", "system=1"]) == 2
    assert f"1 cannot drive {name}: expected" in capsys.readouterr().err
    assert select_study(name, ["system=8"]).name == (name if name in OWN else f"{name}-8")


def test_requirements_of_the_assist_are_measured_where_the_system_reports_them() -> None:
    names = [item.signal for item in system_requirements(library_requirements("apa"), PARKING_SYSTEM)]
    assert "controller.parking.parking_time" in names
    assert not any(name.startswith("controller.apa") for name in names)


@pytest.mark.skipif(not can_compile(), reason="runs of seconds take a C compiler")
def test_the_slot_shown_is_measured_of_the_parking_system() -> None:
    found = columns_in_memory(search_kpis.study_of(search_kpis.cases()[5:7], PARKING_SYSTEM))
    assert set(found["search"]) == {search_kpis.FOUND}
    assert (found["corner_a"] < 0.15).all()
    assert (found["parking_time"] > 5.0).all()
    assert (found["parking_time"] < found["duration"]).all()
