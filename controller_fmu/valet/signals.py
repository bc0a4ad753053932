"""What the valet puts out: what all controllers do, and how far its plan and its drive are."""

from enum import IntEnum
from typing import Annotated, NamedTuple

from controller_fmu.common.external_slot import ExternalSlot
from controller_fmu.interface import Odometry, PlannedPiece, Reason
from controller_fmu.sensing.gap import GapLayout
from controller_fmu.valet.chart import Step
from controller_fmu.valet.phases import ValetPhase
from modelkit.signal import Group, Role, Signal
from modelkit.vocabulary import (
    AdvisedSpeed,
    BrakeRequest,
    DriverConfirm,
    DriverTakeover,
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

PIECES = 12
"""Pieces of a move that are put out."""


class Planning(IntEnum):
    """What has become of the search for a path."""

    PLANNING = 0
    PLANNED = 1
    NO_WAY = 2
    START_BLOCKED = 3
    GOAL_BLOCKED = 4
    TOO_MANY_EDGES = 5


class Move(NamedTuple):
    """The way up to the next change of direction."""

    start: Annotated[Pose, Group("where the piece in hand starts")] = Pose()
    direction: Annotated[int, Signal("1", "1 forward, -1 in reverse, 0 none")] = 0
    pieces: tuple[PlannedPiece, ...] = (PlannedPiece(),) * PIECES


class FoundSlot(NamedTuple):
    """The slot that a search has found."""

    layout: Annotated[int, Signal("1", "how the car will stand in it", states=GapLayout)] = GapLayout.NONE
    side: Annotated[int, Signal("1", "0 right, 1 left of the way")] = 0
    ax: Annotated[float, Signal("m", "x of corner A, passed first")] = 0.0
    ay: Annotated[float, Signal("m", "y of corner A")] = 0.0
    bx: Annotated[float, Signal("m", "x of corner B")] = 0.0
    by: Annotated[float, Signal("m", "y of corner B")] = 0.0
    heading: Annotated[float, Signal("rad", "direction into the slot")] = 0.0
    depth: Annotated[float, Signal("m", "to what it ends at; 50: nothing was heard", 0.0)] = 0.0
    width: Annotated[float, Signal("m", "between the neighbours, across the direction into it", 0.0)] = 0.0


class ValetSignals(NamedTuple):
    """Search, plan and drive."""

    step: Annotated[int, Signal("1", "state of the chart", states=Step)] = 0
    search: Annotated[int, Signal("1", "what has become of the search", states=Planning)] = 0
    searched: Annotated[int, Signal("1", "steps of the search so far", 0)] = 0
    plans: Annotated[int, Signal("1", "plans begun so far", 0)] = 0
    margin: Annotated[float, Signal("m", "clearance that the path keeps", 0.0)] = 0.0
    pieces: Annotated[int, Signal("1", "pieces of the path", 0)] = 0
    piece: Annotated[int, Signal("1", "the one in hand, from 0", 0)] = 0
    blocked: Annotated[bool, Signal("1", "something that the map does not have is in the way")] = False
    seen: Annotated[int, Signal("1", "such things remembered so far", 0)] = 0
    target: Annotated[Pose, Group("pose to park at")] = Pose()
    slot: FoundSlot = FoundSlot()
    move: Move = Move()


class ValetOutput(NamedTuple):
    """To the vehicle, the driver, the log and the judge; those of all controllers are called as theirs."""

    steering_wheel_request: SteeringWheelRequest = 0.0
    steering_active: SteeringActive = False
    prompt: PromptShown = 0
    advised_speed: AdvisedSpeed = 0.0
    speed_control_active: SpeedControlActive = False
    speed_request: SpeedRequest = 0.0
    force_control_active: Annotated[bool, Signal("1", "force_request applies: never")] = False
    force_request: Annotated[float, Signal("N", "requested drive and brake force: none")] = 0.0
    brake_request: BrakeRequest = False
    phase: Annotated[int, Signal("1", "state of the manoeuvre chart", states=ValetPhase)] = 0
    reason: Annotated[int, Signal("1", "why the controller failed", states=Reason)] = 0
    manoeuvres: Annotated[
        int, Signal("1", "number of manoeuvres so far; the first reverse motion counts as one"), Role.LOCAL
    ] = 0
    reference: Annotated[Pose, Role.LOCAL, Group("reference point of the path beside the rear-axle midpoint")] = Pose()
    lateral_error: Annotated[float, Signal("m", "left of the path"), Role.LOCAL] = 0.0
    heading_error: Annotated[float, Signal("rad", "heading of the car minus heading of the reference"), Role.LOCAL] = (
        0.0
    )
    valet: Annotated[ValetSignals, Role.LOCAL] = ValetSignals()


class ValetInput(NamedTuple):
    """From the vehicle, as every controller has it, and a slot from outside."""

    odometry: Odometry = Pose()
    measured_speed: MeasuredSpeed = 0.0
    steering_wheel_angle: SteeringWheelAngle = 0.0
    driver_takeover: DriverTakeover = False
    vehicle_fault: VehicleFaultShown = 0
    ultrasonic: tuple[
        Annotated[float, Signal("m", "measured range: 1-4 front, 5-8 rear, 9-10 left, 11-12 right")], ...
    ] = (5.0,) * 12
    apa_switch: ParkingSwitch = False
    driver_confirm: DriverConfirm = False
    external_slot: Annotated[ExternalSlot, Group("a slot from outside: a camera, a map, a test bench")] = ExternalSlot()
