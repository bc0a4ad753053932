"""A person at pedals and lever: the car obeys in all bodies, and nobody there changes nothing."""

import math
from typing import Any

import pytest

from modelkit.vocabulary import Gear, Prompt, VehicleFault
from tests.vehicle.test_vehicle import BODIES, drive, params, prompted, step
from vehicle_fmu.interface import ManualInput, VehicleInput


def person(lever: Gear = Gear.REVERSE, accelerator: float = 0.0, brake: float = 0.0, **more: Any) -> ManualInput:
    return ManualInput(True, accelerator, brake, int(lever), **more)


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize(("lever", "sign"), [(Gear.DRIVE, 1.0), (Gear.REVERSE, -1.0)])
def test_the_accelerator_drives_the_way_of_the_lever_and_the_brake_stops(body: int, lever: Gear, sign: float) -> None:
    car = params(body=body)
    state, out = drive(car, VehicleInput(manual=person(lever, 0.25)), 1.0)
    assert out.gear == lever
    # 0.25 * 4000 N on 1100 kg for 1 s less the lag of 0.1 s and rolling resistance
    assert out.speed * sign == pytest.approx(0.9 * 1000.0 / 1100.0 - 0.118, abs=0.1)
    _, out = drive(car, VehicleInput(manual=person(lever, 0.0, 0.5)), 2.0, state)
    assert out.speed == 0.0
    assert out.brake_pedal == 0.5


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("lever", [Gear.PARK, Gear.NEUTRAL])
def test_without_a_gear_the_accelerator_moves_nothing(body: int, lever: Gear) -> None:
    _, out = drive(params(body=body), VehicleInput(manual=person(lever, 1.0)), 2.0)
    assert abs(out.pose.x) < 1e-3
    assert out.gear == lever


@pytest.mark.parametrize("body", BODIES)
def test_the_gear_follows_the_lever_only_at_standstill(body: int) -> None:
    car = params(body=body, drive__shift_time=0.3)
    state, out = drive(car, VehicleInput(manual=person(Gear.DRIVE, 0.5)), 1.5)
    assert out.speed > 0.5
    state, out = drive(car, VehicleInput(manual=person(Gear.REVERSE)), 0.5, state)
    assert (out.gear, out.speed > 0.3) == (Gear.DRIVE, True)
    state, out = drive(car, VehicleInput(manual=person(Gear.REVERSE, 0.0, 1.0)), 3.0, state)
    assert (out.gear, out.speed) == (Gear.REVERSE, 0.0)


def test_a_car_let_roll_comes_to_rest_by_its_rolling_resistance() -> None:
    car = params()
    state, _ = drive(car, VehicleInput(manual=person(Gear.DRIVE, 0.5)), 1.0)
    state, out = drive(car, VehicleInput(manual=person(Gear.DRIVE)), 1.0, state)
    _, later = drive(car, VehicleInput(manual=person(Gear.DRIVE)), 2.0, state)
    assert out.speed - later.speed == pytest.approx(2.0 * 0.012 * 9.81, rel=1e-3)
    assert drive(car, VehicleInput(manual=person(Gear.DRIVE)), 30.0, state)[1].speed == 0.0


def test_the_prompts_ask_a_person_but_do_not_move_the_car() -> None:
    _, out = drive(params(), prompted(Prompt.REVERSE, manual=person(Gear.DRIVE, 0.2)), 1.0)
    assert out.speed > 0.3


def test_asked_to_take_over_the_car_is_stopped_as_by_the_driver_modelled() -> None:
    state, out = drive(params(), prompted(Prompt.FORWARD, manual=person(Gear.DRIVE, 0.5)), 1.0)
    _, out = drive(params(), prompted(Prompt.TAKE_OVER, manual=person(Gear.DRIVE, 0.5)), 2.0, state)
    assert (out.speed, out.driver_takeover, out.brake_pedal) == (0.0, True, 1.0)


@pytest.mark.parametrize("body", BODIES)
def test_while_the_controller_drives_a_person_can_brake_and_no_more(body: int) -> None:
    car = params(body=body)
    driven = VehicleInput(speed_control_active=True, speed_request=1.0)
    plain, _ = drive(car, driven, 2.0)
    state, out = drive(car, driven._replace(manual=person(Gear.REVERSE, 1.0)), 2.0)
    assert state == plain
    _, out = drive(car, driven._replace(manual=person(Gear.REVERSE, 0.0, 0.3)), 2.0, state)
    assert (out.speed, out.brake_pedal) == (0.0, 0.3)


def test_a_person_confirms() -> None:
    assert drive(params(), VehicleInput(manual=person(confirm=True)), 0.01)[1].driver_confirm
    assert not drive(params(), VehicleInput(manual=person(confirm=False)), 0.01)[1].driver_confirm


@pytest.mark.parametrize("body", BODIES)
def test_nobody_there_changes_no_bit(body: int) -> None:
    idle = ManualInput(False, 1.0, 1.0, int(Gear.DRIVE), True)
    reverse = prompted(Prompt.REVERSE, 5.0)
    assert drive(params(body=body), reverse._replace(manual=idle), 3.0) == drive(params(body=body), reverse, 3.0)


@pytest.mark.parametrize("pedals", [person(accelerator=math.nan), person(brake=math.nan)])
def test_a_pedal_that_is_no_number_stops_the_car(pedals: ManualInput) -> None:
    sat = drive(params(), VehicleInput(), 0.01)[0]
    _, out = step(sat, VehicleInput(manual=pedals), params(), 10)
    assert (out.vehicle_fault, out.brake_pedal) == (VehicleFault.BAD_INPUT, 1.0)
