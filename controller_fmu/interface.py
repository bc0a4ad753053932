"""What goes into the controller, what comes out, and what can be set: every signal and its unit."""

from enum import IntEnum
from typing import Annotated, NamedTuple

from controller_fmu.adaptive.params import AdaptiveParams
from controller_fmu.adaptive.phases import AdaptivePhase
from controller_fmu.apa.choice import Choice
from controller_fmu.apa.params import ApaParams
from controller_fmu.apa.phases import ApaPhase
from controller_fmu.apa.signals import ApaSignals
from controller_fmu.common.params import LimitParams, ThresholdParams
from controller_fmu.common.phases import CommonPhase
from controller_fmu.common.told import ToldSlot
from controller_fmu.guo2015.params import GuoParams
from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.hsic.params import HsicParams
from controller_fmu.hsic.phases import HsicPhase
from controller_fmu.hsic.signals import HsicSignals
from controller_fmu.preview.params import PreviewParams
from controller_fmu.preview.phases import PreviewPhase
from controller_fmu.preview.signals import PreviewSignals
from controller_fmu.zhang2022.params import ZhangParams
from controller_fmu.zhang2022.phases import ZhangPhase
from controller_fmu.zhang2022.signals import ZhangSignals
from modelkit.car import Car
from modelkit.signal import Group, Role, Signal
from modelkit.states import union
from modelkit.vocabulary import (
    ANYWHERE,
    AdvisedSpeed,
    BrakeRequest,
    ForceControlActive,
    ForceRequest,
    Gear,
    Pose,
    PromptShown,
    SpeedControlActive,
    SpeedRequest,
    SteeringActive,
    SteeringWheelRequest,
)

HOUSE = "chosen; the source states none"


class System(IntEnum):
    """Which paper's system parks the car."""

    NTBPTCWPT = 0
    """Path tracking combined with point tracking (Guo 2015, section 4)."""
    NTBPT = 1
    """Path tracking only (Guo 2015, section 3)."""
    ZHANG2022 = 2
    """Quintic path, MPC steering, PID speed (Zhang 2022)."""
    HSIC = 3
    """Human-simulated intelligent control."""
    PREVIEW = 4
    """Dual-point preview with fuzzy steering and speed on a road (does not park)."""
    APA = 5
    """The whole parking assist: slot search, planner, tracking, position tuning."""
    ADAPTIVE = 6
    """Clothoid paths sized by the driver's speed, predicted stops, planned anew from every standstill."""
    VALET = 7
    """To any pose among the polygons of a map; a controller of its own (``controller_fmu.VALET``)."""


Phase = union(
    "Phase",
    __name__,
    "What a controller is at: the phases that every system has, and those of each.",
    CommonPhase,
    GuoPhase,
    ZhangPhase,
    HsicPhase,
    PreviewPhase,
    ApaPhase,
    AdaptivePhase,
)


class Reason(IntEnum):
    """Why the controller failed."""

    NONE = 0
    BAD_INPUT = 1
    """An input is NaN or infinite."""
    BAD_PARAMETER = 2
    """A parameter has no meaning (not finite, not positive)."""
    NO_PATH = 3
    """No path of this kind leads from the start pose to the target."""
    TOO_MANY_SHIFTS = 4
    TIMEOUT = 5
    NOT_MOVING = 6
    """The driver was asked to move and did not."""
    NOT_STOPPING = 7
    """The driver was asked to stop and did not."""
    WRONG_DIRECTION = 8
    POSE_FROZEN = 9
    """The pose does not change although the car moves."""
    STEERING_FAULT = 10
    """The steering wheel does not follow its request."""
    MISSED_TARGET = 11
    """The end of the path was reached too far from the target pose."""
    LEFT_PATH = 12
    """The car is so far off that the path no longer helps."""
    VEHICLE_FAULT = 13
    """The vehicle reports that it brakes by itself."""
    OVER_SPEED = 20
    """The driver drives faster than the assist may be driven."""
    SENSOR_LOSS = 21
    """A distance sensor tells nothing usable."""
    BLOCKED = 22
    """Something stands in the way and stays."""
    NO_SLOT = 23
    """The search came to its end without a slot."""
    SLOT_TOO_SHORT = 24
    """The search came to its end with slots that the car does not fit into."""
    SLOT_TOO_SHALLOW = 25
    """The search came to its end with slots that end before the car does."""
    SLOT_CONTRADICTED = 26
    """Something was heard where a slot from outside is said to be."""
    SLOT_NOT_SUPPORTED = 27
    """A slot from outside of a kind that this system does not park in: at an angle, or nose first."""


class ControllerInput(NamedTuple):
    """From the vehicle."""

    odometry: Annotated[Pose, Group("rear-axle midpoint as the car believes it")] = Pose()
    measured_speed: Annotated[float, Signal("m/s", "speed, reverse negative")] = 0.0
    steering_wheel_angle: Annotated[float, Signal("rad", "steering-wheel angle, left positive")] = 0.0
    gear: Annotated[int, Signal("1", "selector position", states=Gear)] = Gear.PARK
    brake_pedal: Annotated[float, Signal("1", "brake pedal, 0 released to 1 full", 0.0, 1.0)] = 0.0
    driver_takeover: Annotated[bool, Signal("1", "the driver has taken over")] = False
    vehicle_fault: Annotated[int, Signal("1", "why the vehicle brakes by itself; 0: it does not")] = 0
    ultrasonic: tuple[
        Annotated[float, Signal("m", "distance heard: 1-4 front, 5-8 rear, 9-10 left, 11-12 right")], ...
    ] = (5.0,) * 12
    apa_switch: Annotated[bool, Signal("1", "the driver has switched the parking assist on")] = False
    driver_confirm: Annotated[bool, Signal("1", "the driver presses the confirm button")] = False
    told: Annotated[ToldSlot, Group("a slot from outside: a camera, a map, a test bench")] = ToldSlot()
    choice: Annotated[Choice, Group("what the driver chooses on the display")] = Choice()


class Segment(NamedTuple):
    """A piece of path of constant curvature."""

    length: Annotated[float, Signal("m", "length along the path, >= 0; 0: unused")] = 0.0
    curvature: Annotated[float, Signal("1/m", "curvature of the path seen with x along the heading, left positive")] = (
        0.0
    )


class Path(NamedTuple):
    """The planned path: a start pose and pieces driven in reverse from it."""

    start: Annotated[Pose, Group("where the path starts")] = Pose()
    segments: tuple[Segment, ...] = (Segment(),) * 3


class ControllerOutput(NamedTuple):
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
    phase: Annotated[int, Signal("1", "state of the manoeuvre chart", states=Phase)] = 0
    reason: Annotated[int, Signal("1", "why the controller failed", states=Reason)] = 0
    shifts: Annotated[int, Signal("1", "manoeuvres so far, the first reverse counts one"), Role.LOCAL] = 0
    reference: Annotated[Pose, Role.LOCAL, Group("point of the path beside the rear-axle midpoint")] = Pose()
    lateral_error: Annotated[
        float, Signal("m", "y of the car minus y of the reference, in the slot's frame"), Role.LOCAL
    ] = 0.0
    heading_error: Annotated[float, Signal("rad", "heading of the car minus heading of the reference"), Role.LOCAL] = (
        0.0
    )
    path: Annotated[Path, Role.LOCAL] = Path()
    zhang2022: Annotated[ZhangSignals, Role.LOCAL] = ZhangSignals()
    hsic: Annotated[HsicSignals, Role.LOCAL] = HsicSignals()
    preview: Annotated[PreviewSignals, Role.LOCAL] = PreviewSignals()
    apa: ApaSignals = ApaSignals()


class ControllerParams(NamedTuple):
    """The system chosen, the car it thinks it drives, the target and every limit."""

    system: Annotated[int, Signal("1", "which paper's system", states=System)] = System.NTBPTCWPT
    sample_time: Annotated[float, Signal("s", "controller's sample time, whole nanoseconds", 1e-4, 1.0, HOUSE)] = 0.01
    car: Annotated[Car, Group("the car it thinks it drives")] = Car()
    target: Annotated[Pose, Group("pose of the rear-axle midpoint to park at", ANYWHERE)] = Pose(-7.608, -3.056, 0.0)
    threshold: Annotated[ThresholdParams, Role.TUNABLE] = ThresholdParams()
    limit: Annotated[LimitParams, Role.TUNABLE] = LimitParams()
    guo2015: Annotated[GuoParams, Role.TUNABLE] = GuoParams()
    zhang2022: ZhangParams = ZhangParams()
    hsic: HsicParams = HsicParams()
    preview: Annotated[PreviewParams, Role.TUNABLE] = PreviewParams()
    apa: ApaParams = ApaParams()
    adaptive: AdaptiveParams = AdaptiveParams()
