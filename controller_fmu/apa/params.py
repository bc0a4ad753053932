"""What can be set of the parking assist: sensors, margins, speeds, limits."""

from enum import IntEnum
from math import pi
from typing import Annotated, NamedTuple, Protocol

from controller_fmu.apa.slot import Slot
from controller_fmu.common.params import LimitParams, Longitudinal, ThresholdParams
from controller_fmu.interface import (
    AssumedCar,
    Limits,
    SampleTime,
    SensingCar,
    Thresholds,
)
from modelkit.car import Car
from modelkit.signal import Role, Signal, Subset

HOUSE = "project default; the source states none"
SOURCE = "APA function requirements"


class Wish(IntEnum):
    """Which slots the driver wants."""

    ANY = 0
    PARALLEL = 1
    PERPENDICULAR = 2


class SensorParams(NamedTuple):
    """When a distance sensor counts as lost."""

    blind_time: Annotated[float, Signal("s", "longest time a sensor may tell nothing usable", 0.01, 10.0, HOUSE)] = 0.3


class PlanParams(NamedTuple):
    """How the way into the slot is planned."""

    curvature_share: Annotated[float, Signal("1", "planned curvature over the car's largest", 0.5, 1.0, HOUSE)] = 0.95
    curvature_limit: Annotated[
        float, Signal("1/m", "largest curvature planned, however far the front wheels turn", 0.05, 5.0, HOUSE)
    ] = 0.3
    ramp: Annotated[float, Signal("m", "way over which the curvature rises to the planned", 0.05, 5.0, HOUSE)] = 0.8
    margin: Annotated[float, Signal("m", "distance kept to neighbours", 0.0, 1.0, HOUSE)] = 0.14
    kerb_margin: Annotated[float, Signal("m", "distance kept to kerb or wall beside", 0.0, 1.0, HOUSE)] = 0.13
    stand_out: Annotated[float, Signal("m", "how far the car may stand out if it must", 0.0, 0.15, "GB/T 41630")] = 0.1
    at_a_time: Annotated[int, Signal("1", "candidates looked at in one sample", 1, 1000, HOUSE)] = 40
    manoeuvres: Annotated[
        int, Signal("1", "maximum number of manoeuvres; the first reverse motion counts as one", 1, 30, "GB/T 41630")
    ] = 8


class ApaDriveParams(NamedTuple):
    """How the path is driven and tracked."""

    longitudinal: Annotated[int, Signal("1", "who drives", states=Longitudinal), Role.FIXED] = Longitudinal.OWN_SPEED
    k1: Annotated[float, Signal("1/m2", "path tracking, distance gain", 0.0, 100.0, HOUSE)] = 2.0
    k2: Annotated[float, Signal("1/m", "path tracking, heading gain", 0.0, 100.0, HOUSE)] = 2.4
    speed: Annotated[float, Signal("m/s", "largest speed while parking", 0.1, 1.38, HOUSE)] = 0.8
    creep: Annotated[float, Signal("m/s", "speed at the end of a move", 0.01, 0.5, HOUSE)] = 0.08
    deceleration: Annotated[float, Signal("m/s2", "planned towards the end of a move", 0.1, 5.0, HOUSE)] = 0.5
    brake: Annotated[float, Signal("m/s2", "deceleration when braking to standstill", 0.1, 10.0, HOUSE)] = 2.0
    delay: Annotated[float, Signal("s", "from a brake request to its effect", 0.0, 2.0, HOUSE)] = 0.03
    reaction: Annotated[float, Signal("s", "from a prompt to what the driver does", 0.0, 5.0, HOUSE)] = 0.3
    steering_reserve: Annotated[float, Signal("1", "share of the wheel's rate used by the path", 0.1, 1.0, HOUSE)] = 0.7


class SearchParams(NamedTuple):
    """Slot search while driving past."""

    wish: Annotated[int, Signal("1", "which slots are wanted", states=Wish)] = Wish.ANY
    speed: Annotated[float, Signal("m/s", "largest speed of the search", 0.1, 10.0, "20 km/h")] = 20.0 / 3.6
    way: Annotated[float, Signal("m", "longest way searched", 1.0, 1000.0, HOUSE)] = 60.0
    beside: Annotated[float, Signal("m", "farthest neighbour looked at", 0.1, 10.0, HOUSE)] = 4.0
    step: Annotated[float, Signal("m", "least jump of distance at an edge", 0.05, 5.0, HOUSE)] = 0.4
    wall: Annotated[float, Signal("m", "least length of a neighbour seen", 0.1, 5.0, HOUSE)] = 0.6
    perpendicular_room: Annotated[
        float, Signal("m", "narrowest perpendicular slot over the car's width", 0.4, 5.0, HOUSE)
    ] = 0.95
    unsure: Annotated[
        float, Signal("s", "a corner is unsure by this times the speed of the search", 0.0, 0.1, HOUSE)
    ] = 0.005
    slip: Annotated[float, Signal("s2/m", "slip of braked wheels over the deceleration", 0.0, 0.1, HOUSE)] = 0.002
    depth_room: Annotated[float, Signal("m", "depth that may be missing", 0.0, 2.0, HOUSE)] = 0.1
    told_unsure: Annotated[
        float, Signal("m", "each corner of a slot from outside may lie this much further in", 0.0, 1.0, HOUSE)
    ] = 0.03
    given: Annotated[bool, Signal("1", "no search: the slot is given")] = False
    slot: Slot = Slot()


class MapParams(NamedTuple):
    """The local map: how sure the assist is of what stands around, and how readings change it."""

    corner: Annotated[float, Signal("m", "a corner just found is unsure by this", 0.0, 1.0, HOUSE)] = 0.04
    turned: Annotated[float, Signal("rad", "its neighbour's heading is unsure by this", 0.0, 0.5, HOUSE)] = 0.03
    askew: Annotated[float, Signal("rad", "neighbours stand askew by this", 0.001, 0.5, HOUSE)] = 0.05
    usual: Annotated[float, Signal("m", "margins are made for things that are unsure by this", 0.0, 1.0, HOUSE)] = 0.08
    drift: Annotated[float, Signal("1", "odometry may be wrong by this share of the way", 0.0, 0.2, HOUSE)] = 0.006
    turn_drift: Annotated[float, Signal("rad/m", "and turn by this over it", 0.0, 0.1, HOUSE)] = 0.0012
    heard: Annotated[float, Signal("m", "farthest reading that the map learns from", 0.1, 10.0, HOUSE)] = 2.0
    noise: Annotated[float, Signal("m", "standard deviation of a measurement", 0.001, 1.0, HOUSE)] = 0.03
    floor: Annotated[float, Signal("m", "nothing is surer than this: mounting of the sensors", 0.0, 1.0, HOUSE)] = 0.015
    certain: Annotated[
        float, Signal("m", "parked is told between neighbours that are sure to this", 0.01, 1.0, HOUSE)
    ] = 0.12
    gate: Annotated[
        float, Signal("1", "further off than this many standard deviations, a reading is of something else", 1.0, 10.0)
    ] = 3.5


class EndParams(NamedTuple):
    """When the car is parked well enough."""

    lateral: Annotated[float, Signal("m", "parked without tuning", 0.001, 0.5, HOUSE)] = 0.03
    heading: Annotated[float, Signal("rad", "parked without tuning", 0.001, 0.5, HOUSE)] = 0.7 * pi / 180.0
    out: Annotated[float, Signal("m", "farthest a parked car stands out of the slot", 0.0, 0.15, "GB/T 41630")] = 0.14
    few: Annotated[int, Signal("1", "manoeuvres after which tuning needs a gain of more than two", 0, 30, HOUSE)] = 3
    near_lateral: Annotated[float, Signal("m", "parked after so many manoeuvres", 0.001, 0.5, HOUSE)] = 0.04
    near_heading: Annotated[float, Signal("rad", "parked after that many", 0.001, 0.5, HOUSE)] = 0.9 * pi / 180.0
    final_lateral_error: Annotated[float, Signal("m", "parked if nothing better is left", 0.0, 1.0, "GB/T 41630")] = (
        0.07
    )
    final_heading_error: Annotated[float, Signal("rad", "parked if nothing better is left", 0.0, 1.0, "GB/T 41630")] = (
        1.5 * pi / 180.0
    )


class GuardParams(NamedTuple):
    """Supervision: each limit ends in Fail with its reason, or stops the car."""

    stop_gap: Annotated[float, Signal("m", "anything ahead: stop at this distance", 0.0, 1.0, HOUSE)] = 0.15
    gap: Annotated[float, Signal("m", "the outline comes no nearer to what is known", 0.0, 1.0, HOUSE)] = 0.03
    echo_gap: Annotated[float, Signal("m", "nor to where an echo comes from", 0.0, 1.0, HOUSE)] = 0.02
    surprise: Annotated[float, Signal("m", "nearer than expected by this: unknown obstacle", 0.05, 2.0, HOUSE)] = 0.12
    surprise_gap: Annotated[float, Signal("m", "distance kept to an unknown obstacle", 0.1, 2.0, HOUSE)] = 0.3
    brake_delay: Annotated[
        float, Signal("s", "from a brake request to its effect, at least, until a longer one is seen", 0.0, 2.0, HOUSE)
    ] = 0.15
    blocked: Annotated[float, Signal("s", "longest wait before an obstacle", 0.1, 600.0, HOUSE)] = 10.0
    over_speed: Annotated[float, Signal("m/s", "driver's speed while parking", 0.1, 10.0, SOURCE + ", 5 km/h")] = (
        5.0 / 3.6
    )
    over_speed_time: Annotated[float, Signal("s", "for longer than this", 0.0, 10.0, HOUSE)] = 0.3
    pedal: Annotated[float, Signal("1", "brake pedal counts as pressed", 0.01, 1.0, HOUSE)] = 0.2
    driver_response_timeout: Annotated[
        float, Signal("s", "longest wait for the driver, wheel or car", 0.1, 600.0, HOUSE)
    ] = 15.0
    confirm: Annotated[float, Signal("s", "longest wait for confirmation", 0.1, 3600.0, HOUSE)] = 60.0
    duration: Annotated[float, Signal("s", "longest time from confirmation to parked", 1.0, 3600.0, HOUSE)] = 120.0


class ApaParams(NamedTuple):
    """The whole parking assist."""

    sensors: SensorParams = SensorParams()
    plan: PlanParams = PlanParams()
    drive: Annotated[ApaDriveParams, Role.TUNABLE] = ApaDriveParams()
    search: SearchParams = SearchParams()
    map: MapParams = MapParams()
    end: Annotated[EndParams, Role.TUNABLE] = EndParams()
    guard: Annotated[GuardParams, Role.TUNABLE] = GuardParams()


class ApaSystem(IntEnum):
    """Its value of ``controller.system``."""

    APA = 5
    """The whole parking assist: slot search, planner, tracking, position tuning."""


class ApaThresholds(Protocol):
    """What it has of the thresholds."""

    steering_angle_reached: float


class ApaLimits(Protocol):
    """What it has of the limits."""

    stopping: float
    pose_frozen: float
    steering_tracking_error: float
    steering_fault_debounce: float


class ApaSystemParams(NamedTuple):
    """All that can be set of it."""

    sample_time: SampleTime = 0.01
    car: Annotated[AssumedCar, Subset(SensingCar)] = Car()
    threshold: Annotated[Thresholds, Subset(ApaThresholds)] = ThresholdParams()
    limit: Annotated[Limits, Subset(ApaLimits)] = LimitParams()
    apa: ApaParams = ApaParams()
