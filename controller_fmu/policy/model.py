"""Observation and actions of a learned policy, and when its car counts as parked.

The observation, scaled to about 1 and limited to +-10, in the target's frame (x along its heading):

    1, 2    position of the rear-axle midpoint / 10 m         7 to 18  measured ranges / maximum range
    3, 4    cos and sin of the heading error                  19, 20   slot: middle / 10 m
    5       measured speed / largest requested speed          21, 22   slot: length and width / 10 m
    6       steering-wheel angle / its limit                  23, 24   slot: cos and sin of its heading

The actions hold until the next ones: speed (or accelerator, in reverse if negative) and steering wheel, as shares of
their limits; brake. The car is parked when it stands within the tolerances; it has then no further request.
"""

import math
from typing import NamedTuple

from controller_fmu.common.clock import Clock, tick
from controller_fmu.common.slot_frame import SlotFrame, to_slot
from controller_fmu.interface import Reason
from controller_fmu.policy.params import PolicyParams, ToleranceParams
from controller_fmu.policy.signals import ACTION_COUNT, ManualRequest, PolicyInput, PolicyOutput, PolicyPhase
from modelkit.maths import clamp, is_finite
from modelkit.vocabulary import Gear, Pose

POSITION_SCALE = 10.0
OBSERVATION_LIMIT = 10.0
MIN_MOTION_SPEED = 0.02
"""A car faster than this [m/s] moves in a direction."""


class PolicyState(NamedTuple):
    """What has become of the drive, and the last outputs' memory."""

    clock: Clock = Clock()
    phase: int = PolicyPhase.STANDBY
    reason: int = Reason.NONE
    direction: int = 0
    """Of the last motion: 1 forward, -1 reverse, 0 none yet."""
    manoeuvres: int = 0
    lever: int = Gear.PARK
    action: tuple[float, ...] = (0.0,) * ACTION_COUNT
    """The last one acted on."""
    outputs: PolicyOutput = PolicyOutput()


def policy_initialize(params: PolicyParams) -> tuple[PolicyState, PolicyOutput]:
    """Return the controller before its first sample."""
    if _is_usable(params):
        return PolicyState(), PolicyOutput()
    refused = PolicyOutput(brake_request=True, phase=PolicyPhase.FAILED, reason=Reason.BAD_PARAMETER)
    return PolicyState(Clock(usable=False), refused.phase, refused.reason, outputs=refused), refused


def policy_step(
    state: PolicyState, inputs: PolicyInput, params: PolicyParams, dt_ns: int
) -> tuple[PolicyState, PolicyOutput]:
    """Return (state, outputs) ``dt_ns`` later: it acts at the instants k * sample_time with what holds then."""
    clock, samples, _ = tick(state.clock, params, dt_ns)
    state = state._replace(clock=clock)
    if samples > 0:
        state = _sample(state._replace(action=inputs.action), inputs, params)
    return state, state.outputs


def _sample(state: PolicyState, inputs: PolicyInput, params: PolicyParams) -> PolicyState:
    if not _is_finite_input(inputs):
        failed = PolicyOutput(brake_request=True, phase=PolicyPhase.FAILED, reason=Reason.BAD_INPUT)
        failed = failed._replace(manoeuvres=state.manoeuvres, cost_to_go=state.outputs.cost_to_go)
        failed = failed._replace(observation=state.outputs.observation)
        return state._replace(phase=PolicyPhase.FAILED, reason=Reason.BAD_INPUT, outputs=failed)
    error = to_slot(inputs.odometry, SlotFrame(params.target))
    state = _count_manoeuvres(state, inputs.measured_speed)
    state = _next_phase(state, inputs, error, params)
    lever = state.lever
    if params.action.pedals and inputs.action[0] != 0.0:
        lever = Gear.DRIVE if inputs.action[0] > 0.0 else Gear.REVERSE
    state = state._replace(lever=lever)
    return state._replace(outputs=_outputs(state, inputs, error, params))


def _count_manoeuvres(state: PolicyState, speed: float) -> PolicyState:
    if abs(speed) < MIN_MOTION_SPEED:
        return state
    direction = 1 if speed > 0.0 else -1
    counts = direction != state.direction and not (state.direction == 0 and direction == 1)
    return state._replace(direction=direction, manoeuvres=state.manoeuvres + (1 if counts else 0))


def _next_phase(state: PolicyState, inputs: PolicyInput, error: Pose, params: PolicyParams) -> PolicyState:
    if state.phase != PolicyPhase.STANDBY and state.phase != PolicyPhase.POLICY_DRIVES:
        return state
    if inputs.driver_takeover:
        return state._replace(phase=PolicyPhase.TAKEOVER)
    if inputs.vehicle_fault != 0:
        return state._replace(phase=PolicyPhase.FAILED, reason=Reason.VEHICLE_FAULT)
    if math.sqrt(error.x * error.x + error.y * error.y) > params.max_distance:
        return state._replace(phase=PolicyPhase.FAILED, reason=Reason.LEFT_PATH)
    stands = abs(inputs.measured_speed) < params.tolerance.standstill
    if stands and _is_within(error, params.tolerance):
        return state._replace(phase=PolicyPhase.PARKED)
    return state._replace(phase=PolicyPhase.POLICY_DRIVES)


def _is_within(error: Pose, tolerance: ToleranceParams) -> bool:
    return (
        abs(error.x) <= tolerance.longitudinal
        and abs(error.y) <= tolerance.lateral
        and abs(error.heading) <= tolerance.heading
    )


def _outputs(state: PolicyState, inputs: PolicyInput, error: Pose, params: PolicyParams) -> PolicyOutput:
    drives = state.phase == PolicyPhase.POLICY_DRIVES
    first, wheel = clamp(inputs.action[0], -1.0, 1.0), clamp(inputs.action[1], -1.0, 1.0)
    speed = first * params.action.max_speed
    if abs(speed) < params.action.min_speed:
        speed = 0.0
    request = wheel * params.car.steering.angle_limit if drives else inputs.steering_wheel_angle
    manual = ManualRequest()
    if params.action.pedals:
        manual = ManualRequest(True, abs(first), clamp(inputs.action[2], 0.0, 1.0), state.lever)
    return PolicyOutput(
        steering_wheel_request=request,
        steering_active=drives,
        speed_control_active=drives and not params.action.pedals,
        speed_request=speed if drives else 0.0,
        brake_request=not drives,
        manual=manual,
        phase=state.phase,
        reason=state.reason,
        manoeuvres=state.manoeuvres,
        cost_to_go=math.sqrt(error.x * error.x + error.y * error.y) + params.car.wheelbase * abs(error.heading),
        observation=_observation(inputs, error, params),
    )


def _observation(inputs: PolicyInput, error: Pose, params: PolicyParams) -> tuple[float, ...]:
    slot = to_slot(Pose(params.slot.x, params.slot.y, params.slot.heading), SlotFrame(params.target))
    length, width = params.slot.length, params.slot.width
    if length <= 0.0:
        slot = Pose()
    far = params.car.ultrasonic.max_range
    vehicle = (
        _scale(error.x, POSITION_SCALE),
        _scale(error.y, POSITION_SCALE),
        math.cos(error.heading),
        math.sin(error.heading),
        _scale(inputs.measured_speed, params.action.max_speed),
        _scale(inputs.steering_wheel_angle, params.car.steering.angle_limit),
    )
    known_slot = (
        _scale(slot.x, POSITION_SCALE),
        _scale(slot.y, POSITION_SCALE),
        _scale(length, POSITION_SCALE),
        _scale(width, POSITION_SCALE),
        math.cos(slot.heading),
        math.sin(slot.heading),
    )
    return vehicle + tuple(_scale(measured, far) for measured in inputs.ultrasonic) + known_slot


def _scale(value: float, scale: float) -> float:
    """Return ``value / scale`` within the limit; a range that is no number reads as the limit."""
    if not is_finite(value):
        return OBSERVATION_LIMIT
    return clamp(value / scale, -OBSERVATION_LIMIT, OBSERVATION_LIMIT)


def _is_finite_input(inputs: PolicyInput) -> bool:
    pose = inputs.odometry
    action = inputs.action[0] + inputs.action[1] + inputs.action[2]
    return is_finite(pose.x + pose.y + pose.heading + inputs.measured_speed + inputs.steering_wheel_angle + action)


def _is_usable(params: PolicyParams) -> bool:
    target, slot, steering = params.target, params.slot, params.car.steering
    return (
        is_finite(target.x + target.y + target.heading + slot.x + slot.y + slot.heading + slot.length + slot.width)
        and is_finite(params.car.wheelbase + steering.angle_limit + params.car.ultrasonic.max_range)
        and params.car.wheelbase > 0.0
        and params.car.ultrasonic.max_range > 0.0
        and steering.angle_limit > 0.0
        and params.action.max_speed > 0.0
        and params.sample_time >= 1e-4
    )
