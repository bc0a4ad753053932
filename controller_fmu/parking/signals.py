"""Outputs of the parking system: those that every controller has, and its search, plan and drive."""

from enum import IntEnum
from typing import Annotated, NamedTuple

from controller_fmu.common.driver_selection import MAX_OFFERS, DriverSelection
from controller_fmu.common.external_slot import ExternalSlot
from controller_fmu.interface import Odometry, PlannedPiece, Reason
from controller_fmu.parking.chart import ParkingPhase, ParkingState
from controller_fmu.parking.slots.candidate import SlotType
from modelkit.signal import Group, Role, Signal
from modelkit.vocabulary import (
    AdvisedSpeed,
    BrakePedal,
    BrakeRequest,
    DriverConfirm,
    DriverTakeover,
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

MOVE_SEGMENTS = 12
"""Segments of the path that the outputs show."""


class ParkingSystemInput(NamedTuple):
    """From the vehicle and its driver."""

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
    gear: GearShown = Gear.DRIVE
    brake_pedal: BrakePedal = 0.0
    external_slot: Annotated[ExternalSlot, Group("a slot from outside: a camera, a map, a test bench")] = ExternalSlot()
    driver_selection: Annotated[DriverSelection, Group("selection by the driver on the display")] = DriverSelection()


class ParkingAlarm(IntEnum):
    """Warnings on the display."""

    NONE = 0
    SLOW_DOWN = 1
    """Too fast to search."""
    SLOT_TOO_SHORT = 2
    OBSTACLE = 3
    """The vehicle stands before an obstacle."""
    FAILED = 4
    TAKEN_OVER = 5
    SLOT_TOO_SHALLOW = 6
    SENSOR_LOST = 7
    """A sensor is silent; the system goes on without it."""


class SlotSignals(NamedTuple):
    """The slot found."""

    type: Annotated[int, Signal("1", "slot type", states=SlotType)] = SlotType.NONE
    side: Annotated[int, Signal("1", "side of the road: -1 right, 1 left")] = 0
    ax: Annotated[float, Signal("m", "x of corner A, passed first")] = 0.0
    ay: Annotated[float, Signal("m", "y of corner A")] = 0.0
    bx: Annotated[float, Signal("m", "x of corner B")] = 0.0
    by: Annotated[float, Signal("m", "y of corner B")] = 0.0
    depth: Annotated[float, Signal("m", "depth behind the neighbours' fronts; 50: unknown", 0.0)] = 0.0


class DrivenMove(NamedTuple):
    """The path up to the next change of direction."""

    start: Annotated[Pose, Group("start of the current segment")] = Pose()
    direction: Annotated[int, Signal("1", "direction: 1 forward, -1 in reverse, 0 none")] = 0
    pieces: tuple[PlannedPiece, ...] = (PlannedPiece(),) * MOVE_SEGMENTS


class ParkingSignals(NamedTuple):
    """Search, plan and drive."""

    state: Annotated[int, Signal("1", "state of the chart", states=ParkingState)] = ParkingState.STANDBY
    landmarks: Annotated[int, Role.LOCAL, Signal("1", "confirmed landmarks of the map", 0)] = 0
    steps: Annotated[int, Role.LOCAL, Signal("1", "steps of the path search so far", 0)] = 0
    plans: Annotated[int, Role.LOCAL, Signal("1", "plans begun so far", 0)] = 0
    margin: Annotated[float, Role.LOCAL, Signal("m", "clearance that the path keeps", 0.0)] = 0.0
    segments: Annotated[int, Role.LOCAL, Signal("1", "segments of the path", 0)] = 0
    segment: Annotated[int, Role.LOCAL, Signal("1", "number of the current segment, from 0", 0)] = 0
    is_blocked: Annotated[bool, Role.LOCAL, Signal("1", "the collision monitor keeps the vehicle standing")] = False
    free_distance: Annotated[
        float, Role.LOCAL, Signal("m", "free distance along the present motion; 100: not limited")
    ] = 100.0
    parking_time: Annotated[float, Role.LOCAL, Signal("s", "time since the driver confirmed", 0.0)] = 0.0
    goal: Annotated[Pose, Role.LOCAL, Group("pose to park at")] = Pose()
    slot: Annotated[SlotSignals, Role.LOCAL] = SlotSignals()
    offered: tuple[SlotSignals, ...] = (SlotSignals(),) * MAX_OFFERS
    alarm: Annotated[int, Signal("1", "warning on the display", states=ParkingAlarm)] = ParkingAlarm.NONE
    missing: Annotated[float, Role.LOCAL, Signal("m", "length that the last rejected slot lacks", 0.0)] = 0.0
    shown: Annotated[int, Signal("1", "number of the slot shown among those offered; 0: none", 0, MAX_OFFERS)] = 0
    move: Annotated[DrivenMove, Role.LOCAL] = DrivenMove()


class ParkingOutput(NamedTuple):
    """To the vehicle, the driver, the log and the evaluation."""

    steering_wheel_request: SteeringWheelRequest = 0.0
    steering_active: SteeringActive = False
    prompt: PromptShown = 0
    advised_speed: AdvisedSpeed = 0.0
    speed_control_active: SpeedControlActive = False
    speed_request: SpeedRequest = 0.0
    force_control_active: Annotated[bool, Signal("1", "force_request applies: never")] = False
    force_request: Annotated[float, Signal("N", "requested drive and brake force: none")] = 0.0
    brake_request: BrakeRequest = False
    phase: Annotated[int, Signal("1", "state of the manoeuvre chart", states=ParkingPhase)] = 0
    reason: Annotated[int, Signal("1", "why the controller failed", states=Reason)] = 0
    manoeuvres: Annotated[
        int, Signal("1", "number of manoeuvres so far; the first reverse motion counts as one"), Role.LOCAL
    ] = 0
    reference: Annotated[Pose, Role.LOCAL, Group("reference point of the path beside the rear-axle midpoint")] = Pose()
    lateral_error: Annotated[float, Signal("m", "lateral error, left of the path positive"), Role.LOCAL] = 0.0
    heading_error: Annotated[float, Signal("rad", "heading of the car minus heading of the reference"), Role.LOCAL] = (
        0.0
    )
    apa: ParkingSignals = ParkingSignals()
