"""What the parking assist tells beside the controller's common outputs."""

from enum import IntEnum
from typing import Annotated, NamedTuple

from controller_fmu.apa.chart import Mode
from controller_fmu.apa.phases import ApaPhase
from controller_fmu.apa.slot import Kind, Side, Slot
from controller_fmu.common.driver_selection import MAX_OFFERS, DriverSelection
from controller_fmu.common.external_slot import ExternalSlot
from controller_fmu.interface import (
    STATE_OF_THE_CHART,
    HeadingError,
    LateralError,
    Odometry,
    PlannedPiece,
    ReasonTold,
    ReferencePose,
    Shifts,
)
from modelkit.signal import Group, Role, Signal
from modelkit.vocabulary import (
    AdvisedSpeed,
    BrakePedal,
    BrakeRequest,
    DriverConfirm,
    DriverTakeover,
    ForceControlActive,
    ForceRequest,
    Gear,
    GearShown,
    MeasuredSpeed,
    ParkingSwitch,
    Pose,
    PromptShown,
    SpeedControlActive,
    SpeedRequest,
    SteeringActive,
    SteeringWheelAngle,
    SteeringWheelRequest,
    VehicleFaultShown,
)


class Alarm(IntEnum):
    """What the display warns of."""

    NONE = 0
    SLOW_DOWN = 1
    """Too fast to search."""
    SLOT_TOO_SHORT = 2
    OBSTACLE = 3
    """The car stands before something in the way."""
    FAILED = 4
    TAKEN_OVER = 5
    SLOT_TOO_SHALLOW = 6
    SENSOR_LOST = 7
    """A sensor tells nothing; the assist goes on without it."""


class Family(IntEnum):
    """Which of its planners the assist has its move from: each a family of ways in closed form."""

    NONE = 0
    ENTRY = 1
    """One reverse into a parallel slot: line, arc, line, arc."""
    TURN = 2
    """Into a perpendicular slot: forward and reverse turns."""
    SHORT_MOVES = 3
    """Short moves in the slot."""
    PULL_OUT = 4
    """Out of a parallel slot."""


class OfferedSlot(NamedTuple):
    """A slot that the driver may choose."""

    kind: Annotated[int, Signal("1", "how the car will stand; none: nothing is offered", states=Kind)] = Kind.NONE
    side: Annotated[int, Signal("1", "side of the road", states=Side)] = Side.RIGHT
    a: Annotated[Pose, Group("corner A in the world, heading along the road")] = Pose()
    length: Annotated[float, Signal("m", "corner A to corner B along the road", 0.0)] = 0.0


class PlannedMove(NamedTuple):
    """The move being driven."""

    start: Annotated[Pose, Group("where the move starts")] = Pose()
    direction: Annotated[int, Signal("1", "1 forward, -1 in reverse, 0 none")] = 0
    pieces: tuple[PlannedPiece, ...] = (PlannedPiece(),) * 7


class ApaSignals(NamedTuple):
    """State, slot and plan of the parking assist."""

    mode: Annotated[int, Signal("1", "state of the outer chart", states=Mode)] = 0
    alarm: Annotated[int, Signal("1", "warning on the display", states=Alarm)] = 0
    confirm: Annotated[bool, Signal("1", "the display asks to confirm the slot")] = False
    offered: tuple[OfferedSlot, ...] = (OfferedSlot(),) * MAX_OFFERS
    shown: Annotated[int, Signal("1", "number of the slot shown among those offered; 0: of none", 0, MAX_OFFERS)] = 0
    family: Annotated[int, Signal("1", "planner that the move being driven is from", states=Family)] = Family.NONE
    slots: Annotated[int, Signal("1", "valid slots remembered"), Role.LOCAL] = 0
    missing: Annotated[float, Signal("m", "length that the last refused slot lacks", 0.0), Role.LOCAL] = 0.0
    slot: Annotated[Slot, Role.LOCAL] = Slot()
    corner_b: Annotated[Pose, Role.LOCAL, Group("corner B in the world")] = Pose()
    target: Annotated[Pose, Role.LOCAL, Group("pose to park at, in the world")] = Pose()
    moves: Annotated[int, Signal("1", "moves of the plan still to drive"), Role.LOCAL] = 0
    parking_time: Annotated[float, Signal("s", "since the driver confirmed", 0.0), Role.LOCAL] = 0.0
    iso_spare: Annotated[
        float, Signal("m", "length (width) of the slot over the shortest of ISO 16787"), Role.LOCAL
    ] = 0.0
    move: Annotated[PlannedMove, Role.LOCAL] = PlannedMove()


class ApaInput(NamedTuple):
    """From the vehicle, the driver, and whoever else knows of a slot."""

    odometry: Odometry = Pose()
    measured_speed: MeasuredSpeed = 0.0
    steering_wheel_angle: SteeringWheelAngle = 0.0
    gear: GearShown = Gear.PARK
    brake_pedal: BrakePedal = 0.0
    driver_takeover: DriverTakeover = False
    vehicle_fault: VehicleFaultShown = 0
    ultrasonic: tuple[
        Annotated[float, Signal("m", "measured range: 1-4 front, 5-8 rear, 9-10 left, 11-12 right")], ...
    ] = (5.0,) * 12
    apa_switch: ParkingSwitch = False
    driver_confirm: DriverConfirm = False
    external_slot: Annotated[ExternalSlot, Group("a slot from outside: a camera, a map, a test bench")] = ExternalSlot()
    driver_selection: Annotated[DriverSelection, Group("selection by the driver on the display")] = DriverSelection()


class ApaOutput(NamedTuple):
    """To the vehicle, the driver, the log and the judge."""

    steering_wheel_request: SteeringWheelRequest = 0.0
    steering_active: SteeringActive = False
    prompt: PromptShown = 0
    advised_speed: AdvisedSpeed = 0.0
    speed_control_active: SpeedControlActive = False
    speed_request: SpeedRequest = 0.0
    force_control_active: ForceControlActive = False
    force_request: ForceRequest = 0.0
    brake_request: BrakeRequest = False
    phase: Annotated[int, Signal("1", STATE_OF_THE_CHART, states=ApaPhase)] = 0
    reason: ReasonTold = 0
    manoeuvres: Shifts = 0
    reference: ReferencePose = Pose()
    lateral_error: LateralError = 0.0
    heading_error: HeadingError = 0.0
    apa: ApaSignals = ApaSignals()
