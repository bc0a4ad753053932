"""The driver takes over and resumes; what left the slot is forgotten while the vehicle waits."""

import pytest

from controller_fmu.common.monitor import MonitorState
from controller_fmu.common.steering_monitor import SteeringMonitorState
from controller_fmu.parking.chart import Condition, ParkingState, Strategy, next_parking_state
from controller_fmu.parking.map.landmark import MAX_LANDMARKS, Landmark, LandmarkType
from controller_fmu.parking.map.local_map import LandmarkMap
from controller_fmu.parking.measurement.cycle import MeasurementCycle
from controller_fmu.parking.measurement.sensor import MAX_SENSORS
from controller_fmu.parking.monitor.collision_monitor import EchoObstacle
from controller_fmu.parking.monitor.fault_monitor import FaultClocks, is_taken_over
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.path_planning import continue_plan, forget_what_left, obstacle_count
from controller_fmu.parking.planning.work import PlanningWork
from controller_fmu.parking.signals import ParkingSystemInput
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType
from controller_fmu.parking.state import ParkingMemory, Perception, SearchProgress
from controller_fmu.parking.system import conditions_of, enter_state
from modelkit.store import new_store
from modelkit.vocabulary import Gear, Pose

PARAMS = ParkingParams()
SLOT = SlotCandidate(type=SlotType.PARALLEL)
ECHO = EchoObstacle(-2.0, 0.0, is_present=True, ux=-1.0, range=1.0)
SECOND = 1_000_000_000
PULLED = SteeringMonitorState(request=1.0, angle=0.5, away_ns=SECOND // 4)


@pytest.mark.parametrize(
    ("inputs", "clocks", "taken"),
    [
        (ParkingSystemInput(), FaultClocks(running=SECOND), False),
        (ParkingSystemInput(driver_takeover=True), FaultClocks(), True),
        (ParkingSystemInput(brake_pedal=0.5), FaultClocks(running=SECOND), True),
        (ParkingSystemInput(brake_pedal=0.5), FaultClocks(running=SECOND // 10), False),
        (ParkingSystemInput(brake_pedal=0.1), FaultClocks(running=SECOND), False),
        (ParkingSystemInput(gear=Gear.NEUTRAL, measured_speed=-0.5), FaultClocks(running=SECOND), True),
        (ParkingSystemInput(gear=Gear.NEUTRAL), FaultClocks(running=SECOND), False),
        (ParkingSystemInput(), FaultClocks(MonitorState(wheel=PULLED)), True),
        (ParkingSystemInput(), FaultClocks(MonitorState(wheel=PULLED._replace(request=0.6))), False),
        (ParkingSystemInput(), FaultClocks(MonitorState(wheel=PULLED._replace(away_ns=SECOND // 10))), False),
    ],
)
def test_pedal_gear_and_wheel_are_a_takeover(inputs: ParkingSystemInput, clocks: FaultClocks, taken: bool) -> None:
    assert is_taken_over(clocks, inputs, False) == taken


def test_a_driver_who_drives_as_prompted_brakes_without_taking_over() -> None:
    assert not is_taken_over(FaultClocks(running=SECOND), ParkingSystemInput(brake_pedal=0.5), True)


def switched_off_after(state: ParkingState, direction: float) -> ParkingMemory:
    """Return the memory in standby of a vehicle at the origin that drove (-1, 1) or not (0) before ``state``."""
    memory = ParkingMemory(state=state, search=SearchProgress(slot=SLOT, stand=Pose(20.0, 0.0, 0.0)), reason=3)
    memory = memory._replace(progress=memory.progress._replace(direction=direction))
    memory = memory._replace(perception=Perception(echoes=(ECHO,) * MAX_SENSORS))
    return enter_state(memory, ParkingState.STANDBY, ParkingSystemInput(), PARAMS)


@pytest.mark.parametrize(
    ("state", "direction", "pose", "speed", "resumed"),
    [
        (ParkingState.TAKEOVER, -1.0, Pose(), 0.0, True),
        (ParkingState.FAILED, 1.0, Pose(5.0, 0.0, 0.0), 0.0, True),
        (ParkingState.FAILED, 0.0, Pose(), 0.0, False),
        (ParkingState.PARKED, -1.0, Pose(), 0.0, False),
        (ParkingState.TAKEOVER, -1.0, Pose(13.0, 0.0, 0.0), 0.0, False),
        (ParkingState.TAKEOVER, -1.0, Pose(), 0.5, False),
    ],
)
def test_a_slot_driven_into_is_shown_again(
    state: ParkingState, direction: float, pose: Pose, speed: float, resumed: bool
) -> None:
    memory = switched_off_after(state, direction)
    inputs = ParkingSystemInput(apa_switch=True, odometry=pose, measured_speed=speed)
    after = next_parking_state(memory.state, conditions_of(memory, inputs, PARAMS))
    assert after == (ParkingState.CONFIRMING if resumed else ParkingState.SEARCHING)
    if resumed:
        memory = enter_state(memory, after, inputs, PARAMS)
        assert (memory.search.slot, memory.reason, memory.progress.direction) == (SLOT, 0, 0.0)
        assert not conditions_of(memory, inputs, PARAMS) >> Condition.DRIVEN_ON & 1
        assert not any(echo.is_present for echo in memory.perception.echoes), "measured when it was driving"


def test_what_left_is_forgotten_and_what_stands_is_not() -> None:
    """A surface 1 m behind the car, half of it beyond the cone of sensor 6."""
    mount = PARAMS.car.ultrasonic.mounts[5]
    x, y = mount.x - 1.0, mount.y
    surface = Landmark(LandmarkType.SEGMENT, x, y, 0.5 * 3.141592653589793, start=0.0, end=0.8, confirmations=9)
    local_map = LandmarkMap(landmarks=(surface, *(Landmark(),) * (MAX_LANDMARKS - 1)))
    for reading, left in ((1.0, 1), (3.0, 0), (5.0, 0)):
        readings = tuple(reading if number == 5 else 0.5 for number in range(12))
        cycle = MeasurementCycle(readings=readings, is_new=True)
        memory = ParkingMemory(perception=Perception(cycle=cycle, local_map=local_map))
        for repeated in range(PARAMS.mapping.contradictions):
            assert obstacle_count(memory) == 1, f"after {repeated} readings"
            memory = forget_what_left(memory, ParkingSystemInput(), PARAMS)
        assert obstacle_count(memory) == left


def test_what_holds_the_vehicle_is_in_the_next_plan_to_a_known_goal() -> None:
    """An echo 1 m behind the car that a landmark explained: the monitor keeps clear of it, and so must the path."""
    memory = ParkingMemory(strategy=Strategy.POSE, perception=Perception(echoes=(ECHO,) * MAX_SENSORS))
    planned = continue_plan(new_store(PlanningWork), memory, ParkingSystemInput(), PARAMS)
    assert any((vertex.x, vertex.y) == (ECHO.x, ECHO.y) for vertex in planned.plan.obstacles.vertices)
