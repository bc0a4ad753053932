"""The closed loop of NTBPTcwPT and the kinematic car: frames, faults, limits, sampling."""

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller_fmu import MODEL as CONTROLLER
from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.interface import Reason
from controller_fmu.registry import ControllerInput, ControllerParams, System
from modelkit.variables import constructor, variables, with_values
from modelkit.vocabulary import Pose, Prompt
from tests.controller.closed_loop import Run, drive

CASE_4 = {
    "drive.acceleration_limit": 10.0,
    "drive.deceleration_limit": 3.5,
    "driver.profile[1].speed": 1.5,
    "driver.profile[2].at": 4.3,
    "driver.profile[2].speed": 0.53,
    "driver.reaction_delay": 0.0,
    "driver.complies_with_slow_down": False,
}
PROMPTS = {"guo2015.prompting.reaction": 0.0}
initialize, step = CONTROLLER.initialize, CONTROLLER.stepper(None)
TARGET = (-7.608, -3.056)


def moved(x: float, y: float, turn: float, ox: float, oy: float, mirror: float) -> tuple[float, float]:
    return ox + x * math.cos(turn) - mirror * y * math.sin(turn), oy + x * math.sin(turn) + mirror * y * math.cos(turn)


def case_4_at(turn: float, ox: float, oy: float, mirror: float = 1.0) -> Run:
    x, y = moved(*TARGET, turn, ox, oy, mirror)
    vehicle = {**CASE_4, "start.x": ox, "start.y": oy, "start.heading": turn}
    return drive(vehicle, {**PROMPTS, "target.x": x, "target.y": y, "target.heading": turn})


@pytest.fixture(scope="module")
def case_4() -> Run:
    return drive(CASE_4, PROMPTS)


def test_case_4_goes_the_paper_s_way(case_4: Run) -> None:
    ways = [phase for phase in case_4.visited if phase not in (GuoPhase.STOP, GuoPhase.PRE_STEER)]
    assert ways == [
        GuoPhase.STANDBY,
        GuoPhase.PATH_TRACKING,
        GuoPhase.TO_Q2,
        GuoPhase.TO_Q1,
        GuoPhase.PATH_TRACKING,
        GuoPhase.STRAIGHTEN,
        GuoPhase.PARKED,
    ]
    end = case_4.vehicle[-1]
    assert abs(end.pose.y - TARGET[1]) < 0.05
    assert abs(end.pose.heading) < math.radians(1.0)
    assert case_4.controller[-1].manoeuvres == 3


@pytest.mark.parametrize(
    ("turn", "ox", "oy", "mirror", "tolerance"),
    [
        (0.0, 0.0, 0.0, -1.0, 0.0),
        (2.1, 10.0, -20.0, 1.0, 1e-9),
        (-math.pi, 3.0, 4.0, -1.0, 1e-9),
        (math.radians(217.0), 1234.5, -987.25, 1.0, 1e-9),
        (0.3, 1e6, -1e6, -1.0, 1e-6),
    ],
)
def test_same_way_anywhere(case_4: Run, turn: float, ox: float, oy: float, mirror: float, tolerance: float) -> None:
    there = case_4_at(turn, ox, oy, mirror)
    assert there.phases == case_4.phases
    for a, b in zip(case_4.vehicle, there.vehicle, strict=True):
        x, y = moved(a.pose.x, a.pose.y, turn, ox, oy, mirror)
        assert abs(b.pose.x - x) <= tolerance
        assert abs(b.pose.y - y) <= tolerance
        assert abs(b.pose.heading - (mirror * a.pose.heading + turn)) <= tolerance


def test_reverse_only_after_the_wheel_is_set(case_4: Run) -> None:
    start = case_4.phases.index(GuoPhase.PATH_TRACKING)
    assert all(outputs.pose == Pose(0.0, 0.0, 0.0) for outputs in case_4.vehicle[: start + 1])
    angle = abs(case_4.vehicle[start].front_wheel_angle)
    assert angle == pytest.approx(math.atan(2.405 / 5.499), abs=2e-3)  # 23.6 deg, as the paper's times need
    assert start * 0.01 == pytest.approx(0.79, abs=0.03)


def test_slow_down_prompt_comes_before_the_tangent_point(case_4: Run) -> None:
    prompts = [outputs.prompt for outputs in case_4.controller]
    assert case_4.vehicle[prompts.index(Prompt.SLOW_DOWN)].pose.x > -3.8


@pytest.mark.parametrize(
    ("vehicle", "controller", "reason"),
    [
        ({"driver.complies_with_stop": False, "driver.complies_with_direction": False}, {}, Reason.NOT_STOPPING),
        ({"driver.profile[1].speed": 0.0, "driver.profile[2].speed": 0.0}, {}, Reason.NOT_MOVING),
        ({}, {"target.x": -2.0}, Reason.NO_PATH),
        ({}, {"target.x": 7.0}, Reason.NO_PATH),
        ({}, {"limit.manoeuvres": 1}, Reason.TOO_MANY_SHIFTS),
        ({}, {"limit.duration": 3.0}, Reason.TIMEOUT),
        ({"car.steering.rate_limit": 0.05}, {}, Reason.STEERING_FAULT),
        ({"driver.profile[2].speed": 1.5}, {"system": int(System.NTBPT)}, Reason.MISSED_TARGET),
        ({"start.x": math.nan}, {}, Reason.VEHICLE_FAULT),
        ({}, {"target.y": math.nan}, Reason.BAD_PARAMETER),
        ({}, {"sample_time": math.nan}, Reason.BAD_PARAMETER),
    ],
)
def test_every_trouble_ends_with_its_reason(
    vehicle: dict[str, Any], controller: dict[str, Any], reason: Reason
) -> None:
    if any(isinstance(value, float) and math.isnan(value) for value in (*vehicle.values(), *controller.values())):
        run = _drive_unchecked({**CASE_4, **vehicle}, {**PROMPTS, **controller})
    else:
        run = drive({**CASE_4, **vehicle}, {**PROMPTS, **controller})
    assert run.phases[-1] == GuoPhase.FAILED
    assert Reason(run.controller[-1].reason) == reason
    assert run.vehicle[-1].speed == 0.0
    assert run.controller[-1].prompt == Prompt.STOP
    assert run.controller[-1].brake_request


def _drive_unchecked(vehicle: dict[str, Any], controller: dict[str, Any]) -> Run:
    """``with_values`` refuses NaN at the edge; here it must get past it."""
    from orchestrator.simulation.cosim import model_instance as in_process_instance

    def force(cls: type[Any], changes: dict[str, Any]) -> Any:
        known = variables(cls)
        return constructor(cls)([changes.get(variable.name, variable.start) for variable in known])

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(in_process_instance, "with_values", force)
        return drive(vehicle, controller)


def test_takeover_stops_the_car_and_frees_the_wheel() -> None:
    run = drive({**CASE_4, "driver.takeover_time": 3.0}, PROMPTS)
    assert run.phases[-1] == GuoPhase.TAKEOVER
    assert run.vehicle[-1].speed == 0.0
    assert not run.controller[-1].steering_active
    assert not run.controller[-1].brake_request


def test_steps_of_any_length_sample_at_the_same_instants() -> None:
    params = ControllerParams()
    inputs = ControllerInput()

    def outputs_after(steps: list[int]) -> Any:
        state, _ = initialize(params)
        for dt_ns in steps:
            state, out = step(state, inputs, params, dt_ns)
        return state, out

    whole = outputs_after([50_000_000])
    assert outputs_after([10_000_000] * 5) == whole
    assert outputs_after([1_000_000] * 50) == whole
    assert outputs_after([7_000_000, 13_000_000, 29_999_999, 1]) == whole


def test_a_car_that_never_stands_at_first_is_not_waited_for_for_ever() -> None:
    params = ControllerParams(limit=ControllerParams().limit._replace(duration=5.0))
    state, _ = initialize(params)
    rolling = ControllerInput(measured_speed=0.02)
    for seconds in range(1, 8):
        state, out = step(state, rolling, params, 1_000_000_000)
        assert (out.phase == GuoPhase.FAILED) == (seconds > 5)
    assert out.reason == Reason.TIMEOUT


numbers = st.one_of(st.floats(-100.0, 100.0), st.floats(), st.sampled_from([0.0, math.nan, math.inf, 1e300]))


@settings(max_examples=80)
@given(data=st.data())
def test_no_input_raises_or_gives_nan(data: st.DataObject) -> None:
    known = variables(CONTROLLER.inputs)
    build = constructor(CONTROLLER.inputs)
    params = ControllerParams()
    state, _ = initialize(params)
    for _ in range(8):
        usual = [variable.start for variable in known]
        flat = [
            data.draw(numbers) if variable.kind is float and data.draw(st.booleans()) else usual[k]
            for k, variable in enumerate(known)
        ]
        state, out = step(state, build(flat), params, 10_000_000)
        assert math.isfinite(out.steering_wheel_request)
        assert abs(out.steering_wheel_request) <= params.car.steering.angle_limit
        assert math.isfinite(out.advised_speed)


inside = st.floats(0.02, 0.98)


@settings(max_examples=40)
@given(data=st.data())
def test_no_parameter_in_range_raises(data: st.DataObject) -> None:
    changes: dict[str, Any] = {}
    for variable in variables(ControllerParams):
        if variable.kind is float and data.draw(st.booleans()):
            low, high = max(variable.signal.low, -50.0), min(variable.signal.high, 50.0)
            changes[variable.name] = low + (high - low) * data.draw(inside)
    params = with_values(ControllerParams, changes)
    state, _ = initialize(params)
    for k in range(20):
        pose = Pose(-0.3 * k, -0.05 * k, 0.02 * k)
        state, out = step(state, ControllerInput(odometry=pose, measured_speed=-0.3 * (k % 3)), params, 50_000_000)
        assert math.isfinite(out.steering_wheel_request)


@pytest.mark.parametrize("mirror", [1.0, -1.0])
def test_the_path_told_leads_to_the_target_in_reverse(mirror: float) -> None:
    params = with_values(ControllerParams, {"target.x": -9.0, "target.y": mirror * -3.056, "system": System.NTBPTCWPT})
    state, _ = initialize(params)
    _, reported = step(state, ControllerInput(), params, 10_000_000)
    x, y, heading = reported.path.start
    for segment in reported.path.segments:
        turned = heading - segment.curvature * segment.length
        chord = segment.length
        if segment.curvature != 0.0:
            chord = 2.0 / segment.curvature * math.sin(0.5 * segment.curvature * segment.length)
        x -= chord * math.cos(0.5 * (heading + turned))
        y -= chord * math.sin(0.5 * (heading + turned))
        heading = turned
    assert (x, y, heading) == pytest.approx((-9.0, mirror * -3.056, 0.0), abs=1e-6)
    assert reported.path.segments[1].length > 0.5
