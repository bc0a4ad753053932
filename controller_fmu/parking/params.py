"""Parameters of the parking system, composed of those of its packages."""

from enum import IntEnum
from math import pi
from typing import Annotated, NamedTuple

from controller_fmu.common.params import HOUSE, LimitParams, Longitudinal, ThresholdParams
from controller_fmu.parking.following.params import FollowingParams
from controller_fmu.parking.geometry.polygons import MAP_VERTICES, Vertex
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.monitor.params import MonitorParams
from controller_fmu.parking.slots.params import SlotParams
from modelkit.car import Car
from modelkit.signal import Group, Role, Signal
from modelkit.vocabulary import ANYWHERE, Pose


class PlanningParams(NamedTuple):
    """How the path is planned."""

    margin: Annotated[float, Signal("m", "desired clearance of a path", 0.0, 2.0, HOUSE)] = 0.15
    min_margin: Annotated[float, Signal("m", "least clearance of a path that is driven", 0.0, 2.0, HOUSE)] = 0.03
    curvature_fraction: Annotated[float, Signal("1", "planned over largest possible curvature", 0.3, 1.0, HOUSE)] = 0.95
    steps_per_sample: Annotated[int, Signal("1", "steps of the path search in one sample", 1, 1000, HOUSE)] = 10
    max_steps: Annotated[int, Signal("1", "steps after which the path search fails", 1, 1_000_000, HOUSE)] = 60_000
    max_manoeuvres: Annotated[int, Signal("1", "largest number of manoeuvres, no slot searched", 1, 100, HOUSE)] = 30
    max_plans: Annotated[int, Signal("1", "largest number of plans in one drive", 1, 100, HOUSE)] = 8


class SlotSearchParams(NamedTuple):
    """Where the vehicle is to go."""

    active: Annotated[
        bool, Signal("1", "searches slots while the driver drives past; else drives to a known goal at once")
    ] = True


class FinalPoseParams(NamedTuple):
    """How near to the goal the vehicle counts as parked."""

    position: Annotated[float, Signal("m", "largest longitudinal and lateral error", 0.001, 1.0, HOUSE)] = 0.06
    heading: Annotated[float, Signal("rad", "heading error: 3 deg (GB/T) less 2 sigma of a row", 0.001, 0.5, HOUSE)] = (
        1.3 * pi / 180.0
    )
    accepted: Annotated[float, Signal("m", "position error where no path leads nearer", 0.001, 1.0, HOUSE)] = 0.15
    accepted_heading: Annotated[float, Signal("rad", "and heading error", 0.001, 0.5, "GB/T 41630")] = 3.0 * pi / 180.0


class ParkingSystem(IntEnum):
    """Its value of ``controller.system``."""

    APA = 5
    """Slots in a map of landmarks, a path into one, a collision monitor; a controller of its own."""
    APA_LARGE = 10
    """The same with a map of 2,048 vertices, of 360 otherwise; a controller of its own."""


class ParkingParams(NamedTuple):
    """All of them; those that other systems have too have the same names."""

    system: Annotated[int, Signal("1", "which system", states=ParkingSystem)] = ParkingSystem.APA
    sample_time: Annotated[float, Signal("s", "controller's sample time, whole nanoseconds", 1e-4, 1.0, HOUSE)] = 0.01
    car: Annotated[Car, Group("vehicle model used by the controller")] = Car()
    target: Annotated[Pose, Group("pose to park at where no slot is searched", ANYWHERE), Role.TUNABLE] = Pose()
    search: SlotSearchParams = SlotSearchParams()
    threshold: Annotated[ThresholdParams, Role.TUNABLE] = ThresholdParams()
    limit: Annotated[LimitParams, Role.TUNABLE] = LimitParams(duration=300.0)
    mapping: Annotated[MappingParams, Role.TUNABLE] = MappingParams()
    slot: Annotated[SlotParams, Role.TUNABLE] = SlotParams()
    plan: Annotated[PlanningParams, Role.TUNABLE] = PlanningParams()
    drive: Annotated[FollowingParams, Role.TUNABLE] = FollowingParams()
    monitor: Annotated[MonitorParams, Role.TUNABLE] = MonitorParams()
    final: Annotated[FinalPoseParams, Role.TUNABLE] = FinalPoseParams()
    map: Annotated[
        tuple[Vertex, ...],
        Role.TUNABLE,
        Group("vertices of known polygons where no slot is searched", (("m", 1e8), ("1", 1e6))),
    ] = (Vertex(),) * MAP_VERTICES


def is_driver_driving(params: ParkingParams) -> bool:
    """Return whether the driver drives as prompted, and the system only steers."""
    return params.drive.longitudinal == Longitudinal.DRIVER
