"""What the valet puts out, from what it remembers."""

from controller_fmu.interface import PlannedPiece, Reason
from controller_fmu.planning.plan import PATH
from controller_fmu.sensing.gap import GapLayout
from controller_fmu.valet.chart import Step
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.phases import ValetPhase
from controller_fmu.valet.signals import PIECES, FoundSlot, Move, Planning, ValetOutput, ValetSignals
from controller_fmu.valet.state import ValetState
from modelkit.maths import sign
from modelkit.vocabulary import Prompt

PHASE_OF_STEP = (
    ValetPhase.STANDBY,
    ValetPhase.PRE_STEER,
    ValetPhase.PATH_TRACKING,
    ValetPhase.STOP,
    ValetPhase.STRAIGHTEN,
    ValetPhase.PARKED,
    ValetPhase.FAILED,
    ValetPhase.TAKEOVER,
    ValetPhase.STANDBY,
    ValetPhase.STANDBY,
    ValetPhase.STANDBY,
)
"""One for each member of Step, in its order."""

MOVING = 0.05


def valet_outputs(state: ValetState, params: ValetParams) -> ValetOutput:
    """Return the outputs that hold until the next sample."""
    driving = state.step == Step.DRIVE
    over = state.step in (Step.PARKED, Step.FAILED, Step.TAKEN_OVER)
    taken = state.step == Step.TAKEN_OVER
    seeks = state.step in (Step.OFF, Step.SEARCH, Step.SHOWN)
    steers = not over and not seeks and state.step != Step.PLAN
    return ValetOutput(
        steering_wheel_request=state.wheel if steers else 0.0,
        steering_active=steers,
        prompt=prompt_of(state),
        advised_speed=params.search.speed if state.step == Step.SEARCH else abs(state.speed),
        speed_control_active=not over and not seeks,
        speed_request=state.speed if driving else 0.0,
        brake_request=not driving and not taken and not seeks,
        phase=PHASE_OF_STEP[state.step],
        reason=state.reason,
        manoeuvres=state.manoeuvres,
        reference=state.tracked.reference,
        lateral_error=state.tracked.lateral_error,
        heading_error=state.tracked.heading_error,
        valet=_signals(state),
    )


def prompt_of(state: ValetState) -> int:
    """Return what the driver is asked for."""
    if state.step in (Step.PARKED, Step.FAILED):
        return Prompt.STOP
    if state.step == Step.SHOWN:
        return Prompt.CONFIRM if state.path.used > 0 else Prompt.STOP
    if state.step == Step.SEARCH:
        if state.search.gap.layout != GapLayout.NONE:
            return Prompt.STOP
        return Prompt.SLOW_DOWN if state.search.way > MOVING and state.search.waited_ns == 0 else Prompt.FORWARD
    return Prompt.NONE


def _signals(state: ValetState) -> ValetSignals:
    planned = state.path.used > 0
    found = Planning.PLANNING
    if planned:
        found = Planning.PLANNED
    elif state.reason == Reason.NO_PATH:
        found = Planning.NO_WAY
    return ValetSignals(
        step=state.step,
        search=found,
        searched=state.searched,
        plans=state.plans,
        margin=state.path.margin,
        pieces=state.path.used,
        piece=state.piece,
        blocked=state.sight.blocked,
        seen=state.seen_count,
        target=state.request.goal,
        slot=_slot(state),
        move=_move(state),
    )


def _slot(state: ValetState) -> FoundSlot:
    gap = state.search.gap
    if gap.layout == GapLayout.NONE:
        return FoundSlot()
    return FoundSlot(gap.layout, state.search.side, gap.a.x, gap.a.y, gap.b.x, gap.b.y, gap.into, gap.depth, gap.width)


def _move(state: ValetState) -> Move:
    """Return the pieces from the one in hand up to the next change of direction."""
    direction = sign(state.path.pieces[state.piece].way)
    count = 0
    for number in range(PIECES):
        at = state.piece + number
        if count == number and at < PATH and state.path.pieces[at if at < PATH else 0].way * direction > 0.0:
            count = count + 1
    pieces = tuple(
        _piece(state, state.piece + number) if number < count else PlannedPiece() for number in range(PIECES)
    )
    return Move(state.begin, int(direction), pieces)


def _piece(state: ValetState, number: int) -> PlannedPiece:
    piece = state.path.pieces[number if number < PATH else 0]
    return PlannedPiece(abs(piece.way), piece.k, piece.k)
