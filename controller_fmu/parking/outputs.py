"""Outputs of the parking system, from what it remembers."""

from controller_fmu.interface import PlannedPiece, Reason
from controller_fmu.parking.chart import ParkingPhase, ParkingState, Strategy
from controller_fmu.parking.following.path_tracking import PathProgress
from controller_fmu.parking.map.local_map import is_confirmed
from controller_fmu.parking.measurement.cycle import seconds
from controller_fmu.parking.measurement.sensor import MAX_SENSORS
from controller_fmu.parking.measurement.silent_sensor import is_silent
from controller_fmu.parking.params import ParkingParams, is_driver_driving
from controller_fmu.parking.planning.gear_segments import gear_segment
from controller_fmu.parking.planning.planner import PathSegment
from controller_fmu.parking.signals import (
    MOVE_SEGMENTS,
    DrivenMove,
    ParkingAlarm,
    ParkingOutput,
    ParkingSignals,
    SlotSignals,
)
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType, row_point
from controller_fmu.parking.state import ParkingMemory
from modelkit.maths import sign
from modelkit.vocabulary import Prompt

PHASE_OF_STATE = (ParkingPhase.STANDBY,) * 4 + (
    ParkingPhase.PRE_STEER,
    ParkingPhase.PATH_TRACKING,
    ParkingPhase.STOP,
    ParkingPhase.STRAIGHTEN,
    ParkingPhase.PARKED,
    ParkingPhase.FAILED,
    ParkingPhase.TAKEOVER,
)
"""One for each member of ParkingState, in its order."""
MIN_MOVEMENT = 0.05
"""A search has begun when the vehicle has moved this far [m]."""


def parking_outputs(memory: ParkingMemory, params: ParkingParams) -> ParkingOutput:
    """Return the outputs that hold until the next sample."""
    state = memory.state
    over = state in (ParkingState.PARKED, ParkingState.FAILED, ParkingState.TAKEOVER)
    manual = state in (ParkingState.STANDBY, ParkingState.SEARCHING, ParkingState.CONFIRMING)
    steers = not over and not manual and state != ParkingState.PLANNING
    by_driver = is_driver_driving(params)
    brakes = memory.verdict.is_blocked or not (by_driver or state == ParkingState.DRIVING or memory.speed != 0.0)
    return ParkingOutput(
        steering_wheel_request=memory.steering_wheel_angle if steers else 0.0,
        steering_active=steers,
        prompt=prompt_of(memory, params),
        advised_speed=params.slot.speed if state == ParkingState.SEARCHING else abs(memory.speed),
        speed_control_active=not over and not manual and not by_driver,
        speed_request=0.0 if by_driver else memory.speed,
        brake_request=(over or (brakes and not manual)) and state != ParkingState.TAKEOVER,
        phase=PHASE_OF_STATE[state],
        reason=memory.reason,
        manoeuvres=memory.progress.manoeuvres,
        reference=memory.progress.reference,
        lateral_error=memory.progress.lateral_error,
        heading_error=memory.progress.heading_error,
        apa=_signals(memory, params),
    )


def prompt_of(memory: ParkingMemory, params: ParkingParams) -> int:
    """Return the prompt to the driver."""
    state = memory.state
    if state == ParkingState.PARKED and memory.strategy == Strategy.PULL_OUT:
        return Prompt.TAKE_OVER
    if state == ParkingState.PARKED or state == ParkingState.FAILED:
        return Prompt.STOP
    if state == ParkingState.CONFIRMING:
        return Prompt.CONFIRM if memory.plan.is_found else Prompt.STOP
    if state == ParkingState.SEARCHING:
        if memory.search.slot.type != SlotType.NONE:
            return Prompt.STOP
        begun = memory.search.distance > MIN_MOVEMENT and memory.search.waited == 0
        return Prompt.SLOW_DOWN if begun else Prompt.FORWARD
    if is_driver_driving(params) and state not in (ParkingState.STANDBY, ParkingState.TAKEOVER):
        if state != ParkingState.DRIVING:
            return Prompt.STOP
        if memory.clocks.common.waiting == 0:
            return Prompt.SLOW_DOWN
        return Prompt.FORWARD if memory.progress.direction > 0.0 else Prompt.REVERSE
    return Prompt.NONE


def alarm_of(memory: ParkingMemory) -> int:
    """Return the warning on the display."""
    if memory.state == ParkingState.FAILED:
        return ParkingAlarm.FAILED
    if memory.state == ParkingState.TAKEOVER:
        return ParkingAlarm.TAKEN_OVER
    if memory.verdict.is_blocked:
        return ParkingAlarm.OBSTACLE
    if any(is_silent(memory.perception.local_map.missed, number) for number in range(MAX_SENSORS)):
        return ParkingAlarm.SENSOR_LOST
    if memory.state != ParkingState.SEARCHING:
        return ParkingAlarm.NONE
    if memory.search.is_fast:
        return ParkingAlarm.SLOW_DOWN
    refuses = memory.search.slot.type == SlotType.NONE
    if refuses and memory.search.rejected == Reason.SLOT_TOO_SHORT:
        return ParkingAlarm.SLOT_TOO_SHORT
    is_shallow = refuses and memory.search.rejected == Reason.SLOT_TOO_SHALLOW
    return ParkingAlarm.SLOT_TOO_SHALLOW if is_shallow else ParkingAlarm.NONE


def _signals(memory: ParkingMemory, params: ParkingParams) -> ParkingSignals:
    landmarks = memory.perception.local_map.landmarks
    return ParkingSignals(
        state=memory.state,
        landmarks=sum(1 if is_confirmed(landmark, params.mapping) else 0 for landmark in landmarks),
        steps=memory.plan.steps,
        plans=memory.plan.plans,
        margin=memory.progress.path.margin,
        segments=memory.progress.path.used,
        segment=memory.progress.segment,
        is_blocked=memory.verdict.is_blocked,
        free_distance=memory.verdict.free_distance,
        parking_time=seconds(memory.clocks.running),
        goal=memory.plan.request.goal,
        slot=_slot_signals(memory.search.slot),
        offered=tuple(_slot_signals(slot) for slot in memory.search.offered),
        alarm=alarm_of(memory),
        missing=memory.search.missing,
        shown=memory.search.shown,
        move=_current_move(memory.progress),
    )


def _current_move(progress: PathProgress) -> DrivenMove:
    """Return the segments from the one in hand up to the next change of direction."""
    last = gear_segment(progress.path, progress.segment).last
    pieces = tuple(
        _move_piece(progress.path.segments[progress.segment + number])
        if progress.segment + number <= last
        else PlannedPiece()
        for number in range(MOVE_SEGMENTS)
    )
    return DrivenMove(progress.begin, int(sign(progress.path.segments[progress.segment].distance)), pieces)


def _move_piece(segment: PathSegment) -> PlannedPiece:
    return PlannedPiece(abs(segment.distance), segment.curvature, segment.curvature)


def _slot_signals(slot: SlotCandidate) -> SlotSignals:
    if slot.type == SlotType.NONE:
        return SlotSignals()
    a = row_point(slot.row, slot.behind.end, slot.front)
    b = row_point(slot.row, slot.ahead.start, slot.front)
    return SlotSignals(slot.type, 1 if slot.row.side > 0.0 else -1, a.x, a.y, b.x, b.y, slot.depth)
