"""The systems in one controller: each acts alone, and all refuse parameters that make no sense alike."""

import math
from typing import Any

import pytest

from controller_fmu import APA, MODEL, SYSTEM_MODELS, SYSTEMS
from controller_fmu.common.phases import CommonPhase
from controller_fmu.interface import Reason
from controller_fmu.registry import ControllerInput, ControllerParams, System
from fmus.contents.variables import visible_variables
from modelkit.car import Car, CarSteering
from modelkit.vocabulary import Prompt

NAMES = [branch.field for branch in SYSTEMS.systems]

APART = {System.APA, System.POLICY, System.APA_LARGE}
"""Controllers of their own."""


def after(params: Any, dts: Any) -> Any:
    state, out = MODEL.initialize(params)
    for dt_ns in dts:
        state, out = MODEL.stepper(None)(state, ControllerInput(), params, dt_ns)
    return state, out


def test_every_system_has_a_branch() -> None:
    assert sorted(value for branch in SYSTEMS.systems for value in branch.values) == sorted(set(System) - APART)
    assert set(NAMES) == set(MODEL.state._fields) - {SYSTEMS.clock}


@pytest.mark.parametrize("system", sorted(set(System) - APART))
def test_only_the_chosen_system_remembers_anything(system: Any) -> None:
    params = ControllerParams(system=int(system))
    before, _ = MODEL.initialize(params)
    state, _ = after(params, [10_000_000] * 30)
    (own,) = (branch.field for branch in SYSTEMS.systems if system in branch.values)
    assert getattr(state, own) != getattr(before, own)
    assert all(getattr(state, name) == getattr(before, name) for name in NAMES if name != own)
    assert state.clock.time_ns == 300_000_000


@pytest.mark.parametrize("dts", [[], [10_000_000] * 5])
def test_an_unknown_system_is_refused_and_the_car_is_stopped(dts: Any) -> None:
    state, out = after(ControllerParams(system=99), dts)
    assert (out.phase, out.reason) == (CommonPhase.FAILED, Reason.BAD_PARAMETER)
    assert out.brake_request
    assert state.clock.time_ns == sum(dts)


@pytest.mark.parametrize("system", sorted(set(System) - APART))
def test_all_refuse_parameters_without_meaning(system: Any) -> None:
    cars = (Car(wheelbase=math.nan), Car(steering=CarSteering(ratio=0.0)))
    for bad in (*(ControllerParams(car=car) for car in cars), ControllerParams(sample_time=0.0)):
        for dts in ([], [10_000_000] * 3):
            _, out = after(bad._replace(system=int(system)), dts)
            assert (out.phase, out.reason) == (CommonPhase.FAILED, Reason.BAD_PARAMETER)
            assert out.brake_request
            assert out.prompt == Prompt.STOP


@pytest.mark.parametrize("steps", [[7_000_000] * 10, [70_000_000], [1] * 3 + [69_999_997]])
def test_samples_fall_on_whole_periods_whatever_the_step(steps: Any) -> None:
    state, _ = after(ControllerParams(sample_time=0.02), steps)
    assert state.clock.time_ns == 70_000_000
    assert state.clock.next_sample_ns == 80_000_000


@pytest.mark.parametrize("model", [MODEL, APA, *SYSTEM_MODELS.values()], ids=lambda model: model.name)
def test_an_fmu_offers_the_systems_alone_that_act_in_it(model: Any) -> None:
    offered = [item.signal.states for item in visible_variables(model) if item.name == "system"]
    assert len(offered) == (model is MODEL)
    for states in offered:
        assert states is not None
        assert {state.name: state.value for state in states} == {s.name: s.value for s in System if s not in APART}
        for system in states:
            _, out = MODEL.initialize(ControllerParams(system=int(system)))
            assert out.reason == Reason.NONE
