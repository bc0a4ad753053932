"""A steering that really sticks while parking: every one with a request is found, none falsely."""

import math

import pytest

from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from tests.controller.stuck_drives import BASES, NEVER_TIME, drive, scenario_of

compiled = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")


@compiled
@pytest.mark.parametrize("system", BASES)
def test_stuck_wheels_are_found(system: str) -> None:
    files = fmu_files("native", lambda text: None)
    found = [drive(system, number, True, files, "native") for number in range(8)]
    asked = [item for item in found if item.is_asked]
    assert len(asked) >= 6
    for item in asked:
        assert math.isfinite(item.found), item
        assert item.stuck - 0.01 <= item.seen <= item.found
        assert item.delay < 0.55
        assert not item.touched


@compiled
@pytest.mark.parametrize("system", BASES)
def test_a_real_actuator_is_no_fault(system: str) -> None:
    files = fmu_files("native", lambda text: None)
    for number in range(4):
        item = drive(system, number, False, files, "native")
        assert item.is_real
        assert math.isnan(item.found)


def test_drives_follow_from_their_number() -> None:
    assert scenario_of("adaptive", 3, True).vehicle == scenario_of("adaptive", 3, True).vehicle
    assert scenario_of("adaptive", 3, True).vehicle != scenario_of("adaptive", 4, True).vehicle
    assert scenario_of("apa", 4, False).vehicle["steering.fault_time"] == NEVER_TIME
    assert "steering.lag" in scenario_of("apa", 5, True).vehicle
    assert "steering.lag" not in scenario_of("apa", 4, True).vehicle
