"""The whole vehicle: bodies, driver, gears, sensors, faults, and what must hold for every one."""

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from modelkit.variables import constructor, flatten, variables, with_values
from modelkit.vocabulary import Gear, Pose, Prompt, VehicleFault
from vehicle_fmu import MODEL
from vehicle_fmu.interface import Body, VehicleInput, VehicleOutput, VehicleParams

BODIES = [int(body) for body in Body]
STEP_NS = 10_000_000
step = MODEL.stepper(None)


def params(**changes: Any) -> Any:
    return with_values(VehicleParams, {name.replace("__", "."): value for name, value in changes.items()})


def drive(car: Any, inputs: VehicleInput, seconds: float, state: Any = None, step_ns: int = STEP_NS) -> Any:
    """Return (state, outputs) after ``seconds`` with the inputs held."""
    outputs = None
    if state is None:
        state, outputs = MODEL.initialize(car)
    for _ in range(round(seconds * 1e9) // step_ns):
        state, outputs = step(state, inputs, car, step_ns)
    return state, outputs


def prompted(prompt: Prompt, wheel: float = 0.0, **more: Any) -> VehicleInput:
    return VehicleInput(steering_wheel_request=wheel, steering_active=True, prompt=int(prompt), **more)


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("prompt", [Prompt.FORWARD, Prompt.REVERSE])
def test_drives_a_circle_at_the_profiles_speed_and_stops(body: int, prompt: Prompt) -> None:
    car = params(body=body)
    state, out = drive(car, prompted(prompt, 5.0), 12.0)
    sign = 1.0 if prompt == Prompt.FORWARD else -1.0
    assert out.speed == pytest.approx(0.5 * sign, rel=0.005)
    assert out.gear == (Gear.DRIVE if sign > 0.0 else Gear.REVERSE)
    assert out.pose.heading == pytest.approx(out.distance * sign * math.tan(5.0 / 19.0) / 2.405, rel=0.02)
    state, out = drive(car, prompted(Prompt.STOP, 5.0), 3.0, state)
    assert out.speed == out.measured_speed == 0.0
    assert out.brake_pedal == 1.0
    _, later = drive(car, prompted(Prompt.STOP, 5.0), 2.0, state)
    assert math.dist((later.pose.x, later.pose.y), (out.pose.x, out.pose.y)) < 1e-4


@pytest.mark.parametrize("body", [int(Body.SINGLE_TRACK), int(Body.DOUBLE_TRACK)])
def test_bodies_with_mass_stay_near_the_kinematic_car_at_parking_speed(body: int) -> None:
    _, kinematic = drive(params(body=0), prompted(Prompt.REVERSE, 6.0), 8.0)
    _, dynamic = drive(params(body=body), prompted(Prompt.REVERSE, 6.0), 8.0)
    apart = math.dist((kinematic.pose.x, kinematic.pose.y), (dynamic.pose.x, dynamic.pose.y))
    assert 1e-4 < apart < 0.10
    assert dynamic.pose.heading == pytest.approx(kinematic.pose.heading, abs=0.02)


@pytest.mark.parametrize("body", BODIES)
def test_the_communication_step_does_not_matter(body: int) -> None:
    car = params(body=body)
    ends = [drive(car, prompted(Prompt.FORWARD, 3.0), 4.0, step_ns=ns)[1].pose for ns in (10_000_000, 50_000_000)]
    assert ends[0].x == pytest.approx(ends[1].x, abs=1e-9)
    assert ends[0].y == pytest.approx(ends[1].y, abs=1e-9)


def _stop_and_go(body: int, body_step: float) -> list[Pose]:
    """Return the poses while the car goes ahead, stops and reverses, its wheel always turning."""
    car = params(body=body, body_step=body_step)
    state, _ = MODEL.initialize(car)
    poses = []
    for n in range(500):
        t = 0.01 * n
        speed = 0.8 if t < 2.0 else -0.8 if t > 3.0 else 0.0
        inputs = VehicleInput(6.0 * math.sin(0.9 * t), True, speed_control_active=True, speed_request=speed)
        state, out = step(state, inputs, car, STEP_NS)
        poses.append(out.pose)
    return poses


@pytest.mark.parametrize("body", [Body.SINGLE_TRACK, Body.DOUBLE_TRACK])
def test_the_default_step_is_accurate_to_a_third_of_a_millimetre_and_a_tenth_of_a_milliradian(body: int) -> None:
    pairs = list(zip(_stop_and_go(body, VehicleParams().body_step), _stop_and_go(body, 0.0005), strict=True))
    assert max(math.dist(a[:2], b[:2]) for a, b in pairs) < 3e-4
    assert max(abs(a.heading - b.heading) for a, b in pairs) < 1e-4


@pytest.mark.parametrize("body", BODIES)
def test_mirrored_to_the_bit(body: int) -> None:
    car = params(body=body, steering__lag=0.05, steering__backlash=0.1, steering__dead_time=0.05)
    left, right = drive(car, prompted(Prompt.REVERSE, 6.0), 6.0)[1], drive(car, prompted(Prompt.REVERSE, -6.0), 6.0)[1]
    assert left.pose == (right.pose.x, -right.pose.y, -right.pose.heading)
    assert left.speed == right.speed


@pytest.mark.parametrize("body", BODIES)
def test_shift_time_needs_standstill_and_time(body: int) -> None:
    car = params(body=body, drive__shift_time=0.8)
    state, out = drive(car, prompted(Prompt.FORWARD), 4.0)
    assert out.gear == Gear.DRIVE
    gears, speeds = [], []
    for _ in range(400):
        state, out = step(state, prompted(Prompt.REVERSE), car, STEP_NS)
        gears.append(out.gear)
        speeds.append(out.speed)
    neutral = [k for k, gear in enumerate(gears) if gear == Gear.NEUTRAL]
    assert 0.7 <= len(neutral) * 0.01 <= 0.9
    assert all(abs(speeds[k]) < 0.05 for k in neutral), "the car rocks on its tyres, no more"
    assert gears[-1] == Gear.REVERSE
    assert speeds[-1] < -0.4


@pytest.mark.parametrize("limit", [1.5, 10.0])
def test_pedals_overshoot_by_less_than_a_tenth_even_when_more_is_asked_than_the_drive_has(limit: float) -> None:
    car = with_values(VehicleParams, {"body": 1, "drive.acceleration_limit": limit, "driver.profile[1].speed": 1.5})
    state, out = MODEL.initialize(car)
    fastest = 0.0
    for _ in range(600):
        state, out = step(state, prompted(Prompt.FORWARD), car, STEP_NS)
        fastest = max(fastest, out.speed)
    assert 1.5 < fastest < 1.65
    assert out.speed == pytest.approx(1.5, rel=0.005)


def test_force_request_moves_and_brakes() -> None:
    for body in BODIES:
        car = params(body=body)
        push = VehicleInput(force_control_active=True, speed_request=1.0, force_request=1100.0)
        state, out = drive(car, push, 1.0)
        assert 0.6 < out.speed < 1.05
        hold = VehicleInput(force_control_active=True, speed_request=1.0, force_request=-3000.0)
        assert drive(car, hold, 2.0, state)[1].speed == 0.0


def test_creep_moves_an_idle_car_and_the_brake_holds_it() -> None:
    car = params(body=2, drive__creep_force=400.0)
    idle = VehicleInput(force_control_active=True, speed_request=1.0, force_request=0.0)
    state, out = drive(car, idle, 4.0)
    assert 0.3 < out.speed < 2.0
    assert drive(car, VehicleInput(brake_request=True), 3.0, state)[1].speed == 0.0


def test_wheel_spins_up_on_ice_only_without_traction() -> None:
    push = VehicleInput(force_control_active=True, speed_request=1.0, force_request=4000.0)
    grip = drive(params(body=2), push, 1.0)[1].speed
    ice = drive(params(body=2, **{f"road__grip[{n}]": 0.1 for n in (1, 2, 3, 4)}), push, 1.0)[1].speed
    assert grip > 2.5
    assert 0.2 < ice < 0.8, "front wheels carry about 6 kN: 0.1 times that over 1100 kg for 1 s"


def test_driver_errors() -> None:
    fast = drive(params(driver__speed_error=0.2), prompted(Prompt.FORWARD), 3.0)[1].speed
    assert fast == pytest.approx(0.6)
    car = params(driver__speed_oscillation_amplitude=0.1, driver__speed_oscillation_period=2.0)
    state, _ = drive(car, prompted(Prompt.FORWARD), 3.0)
    speeds = []
    for _ in range(200):
        state, out = step(state, prompted(Prompt.FORWARD), car, STEP_NS)
        speeds.append(out.speed)
    assert (min(speeds), max(speeds)) == pytest.approx((0.4, 0.6), abs=0.005)


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("curvature", [1.0 / 30.0, -1.0 / 15.0])
def test_a_driver_follows_a_bend_until_the_controller_steers(body: int, curvature: float) -> None:
    backlash = math.radians(5.0)
    car = params(body=body, driver__road_curvature=curvature, steering__backlash=backlash, start__heading=0.3)
    idle = VehicleInput(prompt=int(Prompt.FORWARD))
    state, out = drive(car, idle, 30.0)
    centre = (-math.sin(0.3) / curvature, math.cos(0.3) / curvature)
    assert math.dist((out.pose.x, out.pose.y), centre) == pytest.approx(1.0 / abs(curvature), abs=0.03)
    assert out.pose.heading == pytest.approx(0.3 + curvature * out.distance, abs=0.02)
    _, steered = drive(car, prompted(Prompt.FORWARD, 2.0), 3.0, state)
    assert steered.steering_wheel_angle == pytest.approx(2.0)


def test_driver_brakes_and_grabs_the_wheel() -> None:
    car = params(driver__brake_time=2.0)
    assert drive(car, prompted(Prompt.FORWARD), 1.9)[1].brake_pedal == 0.0
    out = drive(car, prompted(Prompt.FORWARD), 4.0)[1]
    assert (out.speed, out.brake_pedal, out.driver_takeover) == (0.0, 1.0, False)
    out = drive(
        params(driver__steering_override_time=1.0, driver__steering_override_angle=-2.0),
        prompted(Prompt.FORWARD, 5.0),
        3.0,
    )[1]
    assert out.steering_wheel_angle == pytest.approx(-2.0)


@pytest.mark.parametrize("body", BODIES)
def test_a_stuck_wheel_stays_where_it_was_whoever_turns_it(body: int) -> None:
    car = params(
        body=body, steering__fault_time=1.0, driver__steering_override_time=3.0, driver__steering_override_angle=-1.0
    )
    state, before = drive(car, prompted(Prompt.FORWARD, 1.0 + 9.0), 1.0)
    assert before.steering_wheel_angle > 9.0
    state, out = drive(car, prompted(Prompt.FORWARD, -5.0), 1.0, state)
    assert out.steering_wheel_angle == before.steering_wheel_angle
    _, grabbed = drive(car, prompted(Prompt.FORWARD, -5.0), 2.0, state)
    assert grabbed.steering_wheel_angle == before.steering_wheel_angle
    assert grabbed.front_wheel_angle == before.front_wheel_angle


def test_apa_switch_and_confirmation() -> None:
    car = params(driver__apa_switch_time=1.0, driver__apa_switch_off_time=3.0, driver__confirm_time=2.0)
    state, out = MODEL.initialize(car)
    seen = []
    for _ in range(40):
        state, out = step(state, VehicleInput(), car, 100_000_000)
        seen.append((out.apa_switch, out.driver_confirm))
    assert [switch for switch, _ in seen].count(True) == 20
    assert [confirm for _, confirm in seen].count(True) == 5
    asked = drive(params(), prompted(Prompt.CONFIRM), 1.0)[1]
    assert asked.driver_confirm
    assert not drive(params(driver__confirms_when_asked=False), prompted(Prompt.CONFIRM), 1.0)[1].driver_confirm


def test_odometry_drifts_as_the_closed_form_says() -> None:
    car = params(body=2, odometry__ideal=False, odometry__radius_error=0.01, drive__shift_time=0.0)
    out = drive(car, prompted(Prompt.FORWARD), 10.0)[1]
    assert out.odometry.x == pytest.approx(1.01 * out.pose.x, rel=2e-3)
    assert out.measured_speed == pytest.approx(1.01 * out.speed, rel=2e-3)
    car = params(odometry__ideal=False, odometry__steering_offset=0.004)
    out = drive(car, prompted(Prompt.FORWARD), 10.0)[1]
    assert out.odometry.heading == pytest.approx(out.distance * math.tan(0.004) / 2.405, rel=1e-9)


def test_contact_and_ultrasonic_reach_the_outputs() -> None:
    wall = {"scene.boxes[1].x": 5.0, "scene.boxes[1].length": 0.4, "scene.boxes[1].width": 6.0}
    car = with_values(VehicleParams, wall)
    _, start = MODEL.initialize(car)
    assert start.clearance == pytest.approx(5.0 - 0.2 - 3.205)
    assert start.ultrasonic[1] == pytest.approx(1.595, abs=0.0051)
    assert not start.contact
    assert start.ultrasonic[5] == 5.0
    _, end = drive(car, prompted(Prompt.FORWARD), 6.0)
    assert end.contact
    assert end.clearance == pytest.approx(5.0 - 0.2 - 3.205 - end.pose.x)


@pytest.mark.parametrize("body", BODIES)
def test_bad_input_brakes_and_holds_the_wheel(body: int) -> None:
    car = params(body=body)
    state, out = drive(car, prompted(Prompt.FORWARD, 2.0), 3.0)
    wheel = out.steering_wheel_angle
    _, out = drive(car, prompted(Prompt.FORWARD, math.nan), 3.0, state)
    assert (out.vehicle_fault, out.brake_pedal) == (VehicleFault.BAD_INPUT, 1.0)
    assert out.speed == 0.0
    assert out.steering_wheel_angle == wheel


BAD = [
    ("car.wheelbase", 0.0),
    ("start.x", math.nan),
    ("car.steering.ratio", 0.0),
    ("chassis.mass", 0.0),
    ("car.cg_to_rear", 9.0),
    ("double_track.tires.shape_x", 0.0),
    ("double_track.hub.inertia", math.inf),
    ("scene.boxes[3].x", math.nan),
    ("car.ultrasonic.cycle", 0.0),
    ("car.ultrasonic.mounts[2].yaw", math.inf),
    ("body_step", 0.0),
    ("road.grade", math.nan),
    ("road.ramp.grade", math.nan),
    ("scene.boxes[2].height", math.nan),
    ("driver.road_curvature", math.nan),
]


@pytest.mark.parametrize(("name", "value"), BAD)
def test_parameters_without_meaning_give_a_status(name: str, value: float) -> None:
    names = [variable.name for variable in variables(VehicleParams)]
    scalars = [variable.start for variable in variables(VehicleParams)]
    scalars[names.index("body")] = int(Body.DOUBLE_TRACK)
    scalars[names.index(name)] = value
    car = constructor(VehicleParams)(scalars)
    state, out = MODEL.initialize(car)
    state, out = step(state, prompted(Prompt.FORWARD, 1.0), car, STEP_NS)
    assert out.vehicle_fault == VehicleFault.BAD_PARAMETER
    assert all(math.isfinite(number) for number in flatten(out))


@settings(max_examples=60)
@given(
    st.sampled_from(BODIES),
    st.lists(
        st.tuples(
            st.floats(-20.0, 20.0), st.integers(0, 6), st.floats(0.0, 5.0), st.booleans(), st.floats(-10.0, 10.0)
        ),
        min_size=1,
        max_size=6,
    ),
    st.floats(-0.3, 0.3),
    st.floats(0.0, 1.0),
)
def test_no_nan_for_any_input_in_range(body: int, commands: Any, slope: float, grip: float) -> None:
    car = params(body=body, road__grade=slope, odometry__ideal=False, steering__lag=0.1, **{"road__grip[2]": grip})
    state, out = MODEL.initialize(car)
    for wheel, prompt, advised, control, speed in commands:
        inputs = VehicleInput(wheel, True, prompt, advised, control, speed, False, 0.0, False)
        state, out = step(state, inputs, car, 200_000_000)
    assert all(math.isfinite(number) for number in flatten((state, out)))


def test_initial_outputs_have_the_lengths_of_their_types() -> None:
    _, out = MODEL.initialize(VehicleParams())
    assert len(flatten(out)) == len(variables(VehicleOutput))
