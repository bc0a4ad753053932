"""What the valet puts out, from what it remembers."""

from controller_fmu.interface import Reason
from controller_fmu.planning.plan import PATH
from controller_fmu.valet.chart import Step
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.phases import ValetPhase
from controller_fmu.valet.signals import PIECES, Move, MovePiece, Planning, ValetOutput, ValetSignals
from controller_fmu.valet.system import ValetState
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
)
"""One for each member of Step, in its order."""


def valet_outputs(state: ValetState, params: ValetParams) -> ValetOutput:
    """Return the outputs that hold until the next sample."""
    driving = state.step == Step.DRIVE
    over = state.step >= Step.PARKED
    taken = state.step == Step.TAKEN_OVER
    steers = not over and state.step != Step.PLAN
    return ValetOutput(
        steering_wheel_request=state.wheel if steers else 0.0,
        steering_active=steers,
        prompt=Prompt.NONE if taken or not over else Prompt.STOP,
        advised_speed=abs(state.speed),
        speed_control_active=not over,
        speed_request=state.speed if driving else 0.0,
        brake_request=not driving and not taken,
        phase=PHASE_OF_STEP[state.step],
        reason=state.reason,
        shifts=state.shifts,
        reference=state.tracked.reference,
        lateral_error=state.tracked.lateral_error,
        heading_error=state.tracked.heading_error,
        valet=_signals(state),
    )


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
        move=_move(state),
    )


def _move(state: ValetState) -> Move:
    """Return the pieces from the one in hand up to the next change of direction."""
    direction = sign(state.path.pieces[state.piece].way)
    count = 0
    for number in range(PIECES):
        at = state.piece + number
        if count == number and at < PATH and state.path.pieces[at if at < PATH else 0].way * direction > 0.0:
            count = count + 1
    pieces = tuple(_piece(state, state.piece + number) if number < count else MovePiece() for number in range(PIECES))
    return Move(state.begin, int(direction), pieces)


def _piece(state: ValetState, number: int) -> MovePiece:
    piece = state.path.pieces[number if number < PATH else 0]
    return MovePiece(abs(piece.way), piece.k0, piece.k1)
