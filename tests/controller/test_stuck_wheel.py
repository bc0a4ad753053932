"""A steering that really sticks while parking: every one with a request is found, none falsely."""

import math

import pytest

from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from orchestrator.studies.parking.stuck_wheel import BASES, HEADS, NEVER_TIME, StuckDrive, drive, line_of, scenario_of

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


def test_the_table_counts_what_was_found_and_what_was_not() -> None:
    def one(seen: float, found: float, took: float, stuck: float = 1.0) -> StuckDrive:
        return StuckDrive("apa", True, stuck, seen, found, False, took)

    stuck = [one(2.0, 2.3, 2.3), one(2.0, 2.5, 2.5), one(2.0, math.nan, 9.0), one(math.nan, math.nan, 9.0)]
    healthy = [one(math.nan, math.nan, 9.0, NEVER_TIME), one(math.nan, 4.0, 4.0, NEVER_TIME)]
    line = dict(zip(HEADS, line_of("apa", stuck, healthy), strict=True))
    assert line == {
        **{"": "apa", "drives": "4", "asked of": "3", "found": "2", "within 0.3 s": "1", "median": "0.50 s"},
        **{"most": "0.50 s", "touched": "0", "not stuck": "2", "false faults": "1"},
    }
