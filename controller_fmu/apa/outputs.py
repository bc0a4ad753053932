"""What the parking assist puts out: requests, prompts, warnings, and what it knows of slot and plan."""

from controller_fmu.apa.chart import Mode
from controller_fmu.apa.manoeuvre_chart import Step
from controller_fmu.apa.params import ApaSystemParams
from controller_fmu.apa.parking import Parking, is_planned, site_for
from controller_fmu.apa.phases import ApaPhase
from controller_fmu.apa.signals import Alarm, ApaOutput, ApaSignals, Family, OfferedSlot, PlannedMove
from controller_fmu.apa.slot import Kind, Slot, mirror_of
from controller_fmu.apa.system import ApaState, has_slot
from controller_fmu.apa.ways.move import Piece
from controller_fmu.apa.ways.planner import FOUND, IN_PERPENDICULAR, TURN
from controller_fmu.apa.ways.shortest_slot import ISO_16787, shortest_slot
from controller_fmu.common.driver_selection import MAX_OFFERS, ChosenTask
from controller_fmu.common.params import Longitudinal
from controller_fmu.common.slot_frame import SlotFrame, to_world
from controller_fmu.interface import PlannedPiece
from modelkit.vocabulary import Pose, Prompt

PHASE_OF_STEP = (
    ApaPhase.STANDBY,
    ApaPhase.STOP,
    ApaPhase.PRE_STEER,
    ApaPhase.PATH_TRACKING,
    ApaPhase.STOP,
    ApaPhase.STRAIGHTEN,
    ApaPhase.STRAIGHTEN,
)
"""One for each member of Step, in its order."""
MOVING = 0.05


def phase_of(state: ApaState) -> int:
    """Return the phase as every controller tells it, for what judges and ends a run."""
    if state.mode == Mode.FAIL:
        return ApaPhase.TAKEOVER if state.taken_over else ApaPhase.FAILED
    if state.mode == Mode.PARKING_FINISH:
        return ApaPhase.PARKED
    if state.mode in (Mode.AUTO_PARKING_ASSIST, Mode.POSITION_TUNING):
        return PHASE_OF_STEP[state.parking.step]
    return ApaPhase.STANDBY


def prompt_of(state: ApaState, params: ApaSystemParams) -> int:
    """Return what the driver is asked for."""
    if state.mode == Mode.PARKING_SPACE_SEARCH:
        if has_slot(state):
            return Prompt.STOP
        return Prompt.SLOW_DOWN if state.search.way > MOVING and state.waited_ns == 0 else Prompt.FORWARD
    if state.mode == Mode.STANDBY:
        return Prompt.STOP if params.apa.search.given or state.task == ChosenTask.PULL_OUT else Prompt.SLOW_DOWN
    if state.mode == Mode.PARKING_SPACE_APPEARS:
        return Prompt.CONFIRM if is_planned(state.parking) else Prompt.STOP
    if state.mode == Mode.PARKING_FINISH and state.parking.out:
        return Prompt.TAKE_OVER
    if state.mode in (Mode.PARKING_FINISH, Mode.FAIL):
        return Prompt.NONE if state.taken_over else Prompt.STOP
    driving = state.mode in (Mode.AUTO_PARKING_ASSIST, Mode.POSITION_TUNING)
    if driving and params.apa.drive.longitudinal != Longitudinal.OWN_SPEED:
        if state.parking.step != Step.DRIVE:
            return Prompt.STOP
        if state.parking.tracked.way > MOVING and state.watch.waiting == 0:
            return Prompt.SLOW_DOWN
        return Prompt.FORWARD if state.parking.direction > 0 else Prompt.REVERSE
    return Prompt.NONE


def alarm_of(state: ApaState, params: ApaSystemParams) -> int:
    """Return the warning shown."""
    if state.mode == Mode.FAIL:
        return Alarm.TAKEN_OVER if state.taken_over else Alarm.FAILED
    if state.mode == Mode.STANDBY:
        return Alarm.SLOW_DOWN
    if state.watch.mute * 1e-9 > params.apa.sensors.blind_time:
        return Alarm.SENSOR_LOST
    if state.parking.sight.blocked:
        return Alarm.OBSTACLE
    if state.mode == Mode.PARKING_SPACE_SEARCH and state.search.refusals > 0 and state.search.valid == 0:
        return Alarm.SLOT_TOO_SHALLOW if state.search.refused.shallow else Alarm.SLOT_TOO_SHORT
    return Alarm.NONE


def apa_outputs(state: ApaState, params: ApaSystemParams) -> ApaOutput:
    """Return the outputs that hold until the next sample."""
    driving = state.mode in (Mode.AUTO_PARKING_ASSIST, Mode.POSITION_TUNING)
    own = driving and params.apa.drive.longitudinal == Longitudinal.OWN_SPEED
    parking = state.parking
    site = site_for(state.around.slot, parking.attempt, parking.out, params)
    advised = params.apa.search.speed if state.mode in (Mode.PARKING_SPACE_SEARCH, Mode.STANDBY) else abs(parking.speed)
    stopping = driving and parking.step != Step.DRIVE
    braking = (own and stopping) or (driving and parking.sight.blocked)
    failed = state.mode == Mode.FAIL and not state.taken_over
    return ApaOutput(
        steering_wheel_request=parking.wheel if driving else 0.0,
        steering_active=driving,
        prompt=prompt_of(state, params),
        advised_speed=advised,
        speed_control_active=own,
        speed_request=parking.speed if own else 0.0,
        brake_request=braking or failed or state.mode == Mode.PARKING_FINISH,
        phase=phase_of(state),
        reason=state.reason,
        manoeuvres=parking.manoeuvres,
        reference=to_world(parking.tracked.reference, site.frame),
        lateral_error=parking.tracked.lateral_error,
        heading_error=parking.tracked.heading_error,
        apa=_signals(state, site.frame, params),
    )


def _signals(state: ApaState, frame: SlotFrame, params: ApaSystemParams) -> ApaSignals:
    slot = state.around.slot
    shown = slot.kind > 0
    b = to_world(Pose(slot.length, slot.b_out, 0.0), SlotFrame(slot.a, mirror_of(slot)))
    return ApaSignals(
        mode=state.mode,
        alarm=alarm_of(state, params),
        confirm=state.mode == Mode.PARKING_SPACE_APPEARS and is_planned(state.parking),
        slots=state.search.valid,
        offered=_offered(state),
        shown=state.shown,
        family=family_of(state.parking, slot.kind),
        missing=state.search.refused.missing,
        slot=slot,
        corner_b=b if shown else Pose(),
        target=to_world(Pose(), frame) if shown else Pose(),
        moves=state.parking.plan.moves,
        parking_time=state.watch.running * 1e-9,
        iso_spare=slot.length - shortest_slot(slot.kind, params.car, ISO_16787) if shown else 0.0,
        move=_move(state.parking, frame),
    )


def _offered(state: ApaState) -> tuple[OfferedSlot, ...]:
    """Return the slots that the driver may choose from; a slot from outside is the only one."""
    if state.told.slot.kind > 0:
        return (_offer(state.told.slot), OfferedSlot(), OfferedSlot())
    if state.mode not in (Mode.PARKING_SPACE_SEARCH, Mode.PARKING_SPACE_APPEARS):
        return (OfferedSlot(),) * MAX_OFFERS
    slots = state.search.slots
    return (_offer(slots[0]), _offer(slots[1]), _offer(slots[2]))


def _offer(slot: Slot) -> OfferedSlot:
    return OfferedSlot(slot.kind, slot.side, slot.a, slot.length)


def family_of(parking: Parking, kind: int) -> int:
    """Return the family of ways that the move being driven is of."""
    plan = parking.plan
    if plan.status != FOUND or plan.moves == 0:
        return Family.NONE
    if parking.out:
        return Family.PULL_OUT
    if kind == Kind.PARALLEL:
        return Family.ENTRY if plan.way_in.found else Family.SHORT_MOVES
    found_at = plan.stage - 1
    return Family.TURN if found_at >= 0 and IN_PERPENDICULAR[found_at] >= TURN else Family.SHORT_MOVES


def _move(parking: Parking, frame: SlotFrame) -> PlannedMove:
    move = parking.plan.move
    pieces = tuple(_piece(piece, frame.mirror) for piece in move.pieces)
    return PlannedMove(to_world(move.start, frame), move.direction, pieces)


def _piece(piece: Piece, mirror: float) -> PlannedPiece:
    return PlannedPiece(piece.length, mirror * piece.k0, mirror * piece.k1)
