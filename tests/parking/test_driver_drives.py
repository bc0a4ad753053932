"""The driver controls the speed as prompted, the system steers: prompts, requests, over-speed."""

import pytest

from controller_fmu.common.monitor import MonitorState
from controller_fmu.common.params import Longitudinal
from controller_fmu.interface import Reason
from controller_fmu.parking.chart import ParkingState
from controller_fmu.parking.map.local_map import LandmarkMap
from controller_fmu.parking.measurement.silent_sensor import MISSED_ECHOES, MissedEchoes
from controller_fmu.parking.monitor.collision_monitor import MonitorVerdict
from controller_fmu.parking.monitor.fault_monitor import FaultClocks
from controller_fmu.parking.outputs import parking_outputs
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.planning.work import PlanningWork
from controller_fmu.parking.signals import ParkingAlarm, ParkingSystemInput
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType
from controller_fmu.parking.state import ParkingMemory, Perception, SearchProgress
from controller_fmu.parking.system import parking_sample
from modelkit.store import new_store
from modelkit.vocabulary import Prompt

OWN = ParkingParams()
BY_DRIVER = OWN._replace(drive=OWN.drive._replace(longitudinal=Longitudinal.DRIVER))
SAMPLE = 10_000_000
REVERSING = ParkingMemory(state=ParkingState.DRIVING, speed=-0.5)
REVERSING = REVERSING._replace(progress=REVERSING.progress._replace(direction=-1.0))
AT_REST = REVERSING._replace(clocks=FaultClocks(MonitorState(waiting=SAMPLE)))
BLOCKED = REVERSING._replace(state=ParkingState.STOPPING, verdict=MonitorVerdict(is_blocked=True))


@pytest.mark.parametrize(
    ("memory", "prompt", "brakes"),
    [
        (AT_REST, Prompt.REVERSE, False),
        (AT_REST._replace(progress=AT_REST.progress._replace(direction=1.0)), Prompt.FORWARD, False),
        (REVERSING, Prompt.SLOW_DOWN, False),
        (REVERSING._replace(state=ParkingState.STEERING), Prompt.STOP, False),
        (REVERSING._replace(state=ParkingState.STOPPING), Prompt.STOP, False),
        (BLOCKED, Prompt.STOP, True),
        (REVERSING._replace(state=ParkingState.TAKEOVER), Prompt.NONE, False),
        (REVERSING._replace(state=ParkingState.PARKED), Prompt.STOP, True),
    ],
)
def test_the_driver_is_prompted_and_braked_only_before_obstacles(
    memory: ParkingMemory, prompt: Prompt, brakes: bool
) -> None:
    outputs = parking_outputs(memory, BY_DRIVER)
    assert (outputs.prompt, outputs.brake_request) == (prompt, brakes)
    assert not outputs.speed_control_active
    assert outputs.speed_request == 0.0
    assert outputs.advised_speed == 0.5


def test_the_system_drives_by_itself_otherwise() -> None:
    outputs = parking_outputs(REVERSING, OWN)
    assert outputs.speed_control_active
    assert (outputs.prompt, outputs.speed_request) == (Prompt.NONE, -0.5)
    assert parking_outputs(BLOCKED, OWN).brake_request


@pytest.mark.parametrize("params", [OWN, BY_DRIVER])
@pytest.mark.parametrize(("speed", "reason"), [(1.3, Reason.NONE), (-1.5, Reason.OVER_SPEED)])
def test_too_fast_for_too_long_is_a_fault(params: ParkingParams, speed: float, reason: Reason) -> None:
    memory, work = REVERSING, new_store(PlanningWork)
    inputs = ParkingSystemInput(apa_switch=True, measured_speed=speed)
    for sample in range(35):
        memory = parking_sample(work, memory, inputs, params, SAMPLE)
        if sample < 25:
            assert memory.reason == Reason.NONE
    assert memory.reason == reason


SILENT = LandmarkMap(missed=MissedEchoes((0,) * 6 + (MISSED_ECHOES,) + (0,) * 5))
SEARCHING = ParkingMemory(state=ParkingState.SEARCHING)


@pytest.mark.parametrize(
    ("memory", "alarm"),
    [
        (REVERSING, ParkingAlarm.NONE),
        (BLOCKED, ParkingAlarm.OBSTACLE),
        (REVERSING._replace(state=ParkingState.FAILED), ParkingAlarm.FAILED),
        (REVERSING._replace(state=ParkingState.TAKEOVER), ParkingAlarm.TAKEN_OVER),
        (REVERSING._replace(perception=Perception(local_map=SILENT)), ParkingAlarm.SENSOR_LOST),
        (SEARCHING, ParkingAlarm.NONE),
        (SEARCHING._replace(search=SearchProgress(is_fast=True)), ParkingAlarm.SLOW_DOWN),
        (SEARCHING._replace(search=SearchProgress(rejected=Reason.SLOT_TOO_SHORT)), ParkingAlarm.SLOT_TOO_SHORT),
        (SEARCHING._replace(search=SearchProgress(rejected=Reason.SLOT_TOO_SHALLOW)), ParkingAlarm.SLOT_TOO_SHALLOW),
        (
            SEARCHING._replace(search=SearchProgress(SlotCandidate(SlotType.PARALLEL), rejected=Reason.SLOT_TOO_SHORT)),
            ParkingAlarm.NONE,
        ),
    ],
)
def test_the_display_warns(memory: ParkingMemory, alarm: ParkingAlarm) -> None:
    assert parking_outputs(memory, OWN).apa.alarm == alarm
