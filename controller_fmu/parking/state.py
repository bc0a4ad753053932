"""Everything the parking system remembers beside the planner's work arrays."""

from typing import NamedTuple

from controller_fmu.common.driver_selection import MAX_OFFERS
from controller_fmu.interface import Reason
from controller_fmu.parking.chart import ParkingState, Strategy
from controller_fmu.parking.following.path_tracking import PathProgress
from controller_fmu.parking.geometry.polygons import ObstacleMap
from controller_fmu.parking.map.landmark import Landmark
from controller_fmu.parking.map.local_map import LandmarkMap
from controller_fmu.parking.measurement.cycle import MeasurementCycle
from controller_fmu.parking.measurement.sensor import MAX_SENSORS
from controller_fmu.parking.monitor.collision_monitor import EchoObstacle, MonitorVerdict
from controller_fmu.parking.monitor.fault_monitor import FaultClocks
from controller_fmu.parking.objects.track import ObjectTrack
from controller_fmu.parking.planning.problem import PlanningRequest
from controller_fmu.parking.slots.candidate import SlotCandidate
from controller_fmu.parking.slots.slot_filter import SlotFilter
from modelkit.vocabulary import Pose


class SearchProgress(NamedTuple):
    """The slot search, and the slot shown."""

    slot: SlotCandidate = SlotCandidate()
    distance: float = 0.0
    """Driven since it began [m]."""
    waited: int = 0
    """For the driver [ns]."""
    rejected: int = Reason.NONE
    """Why the last candidate was not taken."""
    missing: float = 0.0
    """Length [m] that it lacked."""
    is_fast: bool = False
    """The driver drives faster than slots can be searched."""
    pose: Pose = Pose()
    """Where the slot was shown first."""
    stand: Pose = Pose()
    """Where it is shown now: elsewhere if the driver switched the system on again."""
    resumes: bool = False
    """The vehicle was driven into the slot before the system was switched off."""
    offered: tuple[SlotCandidate, ...] = (SlotCandidate(),) * MAX_OFFERS
    """Slots that the driver may choose, the newest first."""
    shown: int = 0
    """Number of the slot shown among those, from 1."""
    slot_filter: SlotFilter = SlotFilter()
    """What is measured of the slot while entering it."""
    refused: SlotCandidate = SlotCandidate()
    """The last slot without a path."""


class PlanProgress(NamedTuple):
    """The path search in hand."""

    request: PlanningRequest = PlanningRequest()
    obstacles: ObstacleMap = ObstacleMap()
    steps: int = 0
    """Done for the request; 0: none is in hand."""
    plans: int = 0
    is_found: bool = False
    failure: int = Reason.NONE
    """No path leads on from where the vehicle was on its way: it waits for a change of the map."""
    failed_at: int = 0
    """Since then [ns]."""
    way_out: Pose = Pose()
    """Where pulling out ends."""
    is_final: bool = False
    """No plan brings the vehicle nearer to its goal, and it stands in the slot."""


class Perception(NamedTuple):
    """Measurements, map, tracks, and what they do not explain."""

    cycle: MeasurementCycle = MeasurementCycle()
    time: int = 0
    """[ns]"""
    local_map: LandmarkMap = LandmarkMap()
    tracks: tuple[ObjectTrack, ...] = (ObjectTrack(),) * MAX_SENSORS
    echoes: tuple[EchoObstacle, ...] = (EchoObstacle(),) * MAX_SENSORS
    yields: int = 0
    """Measurement cycles for which the vehicle still stands for a moving object."""


class ParkingMemory(NamedTuple):
    """State of the parking system between two samples."""

    state: int = ParkingState.STANDBY
    strategy: int = Strategy.SLOT
    reason: int = Reason.NONE
    perception: Perception = Perception()
    search: SearchProgress = SearchProgress()
    plan: PlanProgress = PlanProgress()
    progress: PathProgress = PathProgress()
    verdict: MonitorVerdict = MonitorVerdict()
    clocks: FaultClocks = FaultClocks()
    steering_wheel_angle: float = 0.0
    """Requested [rad]."""
    speed: float = 0.0
    """Requested [m/s], reverse negative."""


def with_landmarks(memory: ParkingMemory, landmarks: tuple[Landmark, ...]) -> ParkingMemory:
    """Return the memory with other landmarks in its map."""
    perception = memory.perception
    return memory._replace(perception=perception._replace(local_map=perception.local_map._replace(landmarks=landmarks)))
