"""Studies of parking: all that is set and kept exists in the system that they drive."""

from collections.abc import Callable

import pytest

from modelkit.variables import variables
from orchestrator.simulation.cosim.fmu_files import can_compile
from orchestrator.studies.parking import detected_slot_study, pull_out_study, study
from orchestrator.studies.parking.cases import cases as grid_cases
from orchestrator.studies.parking.parking_world import study as parking_world
from orchestrator.studies.parking.system_signals import APA_SYSTEM
from orchestrator.studies.parking.world import study as world
from orchestrator.studies.sweep.in_memory import columns_in_memory
from orchestrator.studies.sweep.study.imported_fmu import signals_of
from orchestrator.studies.sweep.study.study import Study

MADE: dict[str, Callable[[], Study]] = {
    "apa-grid": lambda: study.study_of(grid_cases()[:3]),
    "apa-out": lambda: pull_out_study.study(3),
    "apa-world": lambda: world.study(3),
    "parking-world": lambda: parking_world.study(3),
    "valet-slots": lambda: detected_slot_study.study(3, ways=True),
}
"""Study -> some of its runs."""


@pytest.mark.parametrize("name", sorted(MADE))
def test_all_that_is_set_and_kept_exists(name: str) -> None:
    made = MADE[name]()
    assert made.scenario.controller["system"] == APA_SYSTEM
    known = signals_of(made.scenario)
    wanted = [measure.signal for measure in made.measures.values()]
    wanted += [item.signal for items in made.within.values() for item in items if "." in item.signal]
    assert [signal for signal in wanted if signal.startswith("controller.") and signal not in known] == []
    assert made.scenario.controller.keys() <= {
        item.name for item in variables(made.scenario.models["controller"].params)
    }


@pytest.mark.skipif(not can_compile(), reason="runs of seconds take a C compiler")
def test_the_slot_shown_is_measured() -> None:
    found = columns_in_memory(study.study_of(grid_cases()[5:7]))
    assert (found["corner_a"] < 0.15).all()
    assert (found["parking_time"] > 5.0).all()
    assert (found["parking_time"] < found["duration"]).all()
