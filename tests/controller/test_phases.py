"""Phases: each system's own, the common ones among them, and the union of all that a controller of all tells."""

from enum import IntEnum
from typing import Any

import pytest

from controller_fmu import APA, MODEL, SYSTEM_MODELS, SYSTEMS
from controller_fmu.adaptive.phases import AdaptivePhase
from controller_fmu.common.phases import CommonPhase, is_over, is_parking
from controller_fmu.parking.chart import ParkingPhase
from controller_fmu.registry import Phase, System
from fmus.contents.description3 import model_description3
from fmus.contents.variables import describe, fmi_variables
from modelkit.model import Model
from modelkit.states import parts_of

OF_SYSTEMS = {item.field: dict(item.states)["phase"] for item in SYSTEMS.systems}
ALL = dict(OF_SYSTEMS)


@pytest.mark.parametrize("system", ALL)
def test_every_system_has_the_common_phases_under_their_numbers(system: str) -> None:
    assert {(item.name, int(item)) for item in CommonPhase} <= {(item.name, int(item)) for item in ALL[system]}


def test_every_system_has_phases_of_its_own() -> None:
    assert len(set(ALL.values())) == len(ALL)
    assert {cls.__module__ for cls in ALL.values()} == {f"controller_fmu.{name}.phases" for name in ALL}


def test_the_controller_of_all_tells_the_union_of_its_systems() -> None:
    assert set(parts_of(Phase)) == {CommonPhase, *OF_SYSTEMS.values()}
    names = {int(item): item.name for item in Phase}
    assert all(names[int(item)] == item.name for states in ALL.values() for item in states)


def test_over_parking_and_standby() -> None:
    assert [item.name for item in Phase if is_over(item)] == ["PARKED", "FAILED", "TAKEOVER"]
    assert [item.name for item in Phase if not is_over(item) and not is_parking(item)] == ["STANDBY"]


@pytest.mark.parametrize("system", SYSTEM_MODELS)
def test_a_controller_of_one_system_names_that_systems_phases(system: System) -> None:
    model: Model[Any, Any, Any, Any] = SYSTEM_MODELS[system]
    own = next(dict(item.states)["phase"] for item in SYSTEMS.systems if system in item.values)
    assert phase_of(model) is own
    said = model_description3(model, token="", generation_tool="", flags={}).decode()
    assert f'EnumerationType name="{own.__name__}"' in said
    assert 'name="Phase"' not in said


def test_one_system_does_not_name_anothers_phases() -> None:
    phase = next(item for item in fmi_variables(SYSTEM_MODELS[System.HSIC]) if item.name == "phase")
    assert describe(phase).endswith(
        ": 0 STANDBY, 1 PRE_STEER, 2 PATH_TRACKING, 8 STRAIGHTEN, 9 PARKED, 10 FAILED, 11 TAKEOVER"
    )
    assert "TO_Q1" in describe(next(item for item in fmi_variables(MODEL) if item.name == "phase"))
    models = (MODEL, SYSTEM_MODELS[System.ADAPTIVE], APA)
    assert [phase_of(model) for model in models] == [Phase, AdaptivePhase, ParkingPhase]


def phase_of(model: Model[Any, Any, Any, Any]) -> type[IntEnum] | None:
    """Return the states of the output ``phase`` as an FMU of the model names them."""
    return next(item for item in fmi_variables(model) if item.name == "phase").signal.states
