"""Frama-C Eva on the generated C of the collision monitor: no value within the bounds below makes it fail.

Eva (Blazy, Bühler, Yakobowski: Structuring abstract interpreters through state and value abstractions, VMCAI 2017)
computes intervals of all values. An alarm is an operation that it cannot prove to be defined and finite.
"""

import math
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from controller_fmu.common.monitor import MAX_PLAUSIBLE_VALUE
from controller_fmu.parking.map.landmark import MAX_LANDMARKS
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.measurement.sensor import MAX_SENSORS
from controller_fmu.parking.monitor.params import MonitorParams
from controller_fmu.parking.standalone import MODEL
from fmus.native.sources import translate_model
from modelkit.car import Car
from modelkit.variables import variables

FAR = MAX_PLAUSIBLE_VALUE
"""Positions [m], headings [rad] and speeds [m/s] beyond it never reach the monitor: the fault monitor refuses them."""
CAR = {item.name: item.signal for item in variables(Car)}
LONGEST = sum(CAR[name].high for name in ("wheelbase", "front_overhang", "rear_overhang"))
POSE = {"x": (-FAR, FAR), "y": (-FAR, FAR), "heading": (-FAR, FAR)}
MOTION = {f"pose.{name}": bounds for name, bounds in POSE.items()} | {
    "direction": (-1.0, 1.0),
    "speed": (0.0, FAR),
    "curvature": (-10.0, 10.0),
    "remaining": (0.0, FAR),
    "delay": (0.0, 2.0),
    "deceleration": (0.1, 10.0),
}
OUTLINE = {
    "centre_ahead": (-LONGEST, LONGEST),
    "half_length": (0.0, 0.5 * LONGEST),
    "half_width": (0.0, 0.5 * CAR["width"].high),
}
LANDMARK = POSE | {"type": (0, 2), "start": (-FAR, FAR), "end": (-FAR, FAR), "confirmations": (0, 2**31 - 1)}
ECHO = {"x": (-FAR, FAR), "y": (-FAR, FAR), "ux": (-1.0, 1.0), "uy": (-1.0, 1.0)} | {
    "closing_speed": (0.0, FAR),
    "is_present": (0, 1),
    "is_unexplained": (0, 1),
    "surface.along_x": (-1.0, 1.0),
    "surface.along_y": (-1.0, 1.0),
    "surface.low": (-1.0, 0.0),
    "surface.high": (0.0, 1.0),
}
HARNESS = """#include "monitor.c"
#include "__fc_builtin.h"

static Landmark landmarks[{landmarks}];
static EchoObstacle echoes[{sensors}];

int main(void)
{{
    VehicleMotion motion;
    VehicleOutline outline;
    MonitorParams params;
    MappingParams mapping;
{values}
    const MonitorVerdict verdict = monitor_collision(&motion, &outline, landmarks, echoes, &params, &mapping);
    /*@ assert verdict.speed_limit >= 0.0 && verdict.free_distance >= 0.0; */
    return 0;
}}
"""
EVA = ("frama-c", "-eva", "-eva-precision", "2", "-warn-special-float", "non-finite")
UNROLL = ("-eva-plevel", str(4 * MAX_LANDMARKS))
"""Arrays of landmarks are kept item by item."""


def within(place: str, bounds: dict[str, tuple[Any, Any]]) -> str:
    """Return C that sets each field of ``place`` to any value within its bounds."""
    lines = []
    for name, (low, high) in bounds.items():
        kind = "double_" if isinstance(low, float) else ""
        lines.append(f"{place}.{name} = Frama_C_{kind}interval({low!r}, {high!r});")
    return "\n".join(lines)


def declared(cls: type) -> dict[str, tuple[Any, Any]]:
    """Return the minimum and maximum that the parameters of ``cls`` declare."""
    kinds = {item.name: (item.kind(item.signal.low), item.kind(item.signal.high)) for item in variables(cls)}
    assert all(math.isfinite(low) and math.isfinite(high) for low, high in kinds.values())
    return kinds


def alarms(folder: Path, motion: dict[str, tuple[Any, Any]]) -> str:
    """Return what Eva reports of the monitor for vehicles that move within ``motion``."""
    code = translate_model(MODEL)
    (folder / f"{code.name}.h").write_text(code.header, encoding="utf-8")
    (folder / "monitor.c").write_text(code.source, encoding="utf-8")
    values = [
        within("motion", motion),
        within("outline", OUTLINE),
        within("params", declared(MonitorParams)),
        within("mapping", declared(MappingParams)),
        *(within(f"landmarks[{number}]", LANDMARK) for number in range(MAX_LANDMARKS)),
        *(within(f"echoes[{number}]", ECHO) for number in range(MAX_SENSORS)),
    ]
    text = HARNESS.format(landmarks=MAX_LANDMARKS, sensors=MAX_SENSORS, values="\n".join(values))
    (folder / "harness.c").write_text(text, encoding="utf-8")
    ran = subprocess.run(
        [*EVA, *UNROLL, f"-cpp-extra-args=-I{folder}", folder / "harness.c"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


@pytest.mark.release
@pytest.mark.skipif(shutil.which("frama-c") is None, reason="no Frama-C here: apt-get install frama-c-base")
def test_the_monitor_raises_no_alarm(tmp_path: Path) -> None:
    report = alarms(tmp_path, MOTION)
    assert "0 alarms generated" in report, re.findall(r"\[eva:alarm\][^[]*", report)
    assert re.search(r"Assertions +1 valid +0 unknown +0 invalid", report), report[-2000:]
    braked_by_nothing = alarms(tmp_path, MOTION | {"deceleration": (0.0, 10.0)})
    assert "0 alarms generated" not in braked_by_nothing, "a division by zero is an alarm"
