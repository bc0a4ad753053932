"""What became of a run in the world: a contact is its end, whatever the controller says after it."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from controller_fmu.apa.chart import Mode
from modelkit.geometry import Box, boxes_gap, line_box, outline
from modelkit.vocabulary import Pose
from orchestrator.cosim.slave import Array
from orchestrator.grid.parkings import GBT
from orchestrator.grid.world.scene import THINGS, WHEEL
from orchestrator.sweep.columns import WITHIN
from orchestrator.sweep.study.study import Columns, Derived
from orchestrator.verdict.measures import Measure, When

TOUCHING = When("vehicle.contact", (1,))
AXES = ("x", "y", "heading")
FIRST = {
    **{f"touched.{axis}": f"vehicle.pose.{axis}" for axis in AXES},
    "touched.speed": "vehicle.speed",
    "touched.mode": "controller.apa.mode",
    "touched.takeover": "vehicle.driver_takeover",
}
"""Column -> signal at the first instant at which something is touched."""
MEASURES = {
    "mode": Measure("last", "controller.apa.mode"),
    "parking_time": Measure("last", "controller.apa.parking_time"),
    **{name: Measure("first", signal, TOUCHING) for name, signal in FIRST.items()},
}
STANDING = 0.01
"""A car slower than this stands [m/s]."""
DRIVES = (Mode.AUTO_PARKING_ASSIST, Mode.POSITION_TUNING, Mode.PARKING_FINISH, Mode.FAIL)
"""In these the car is the assist's, unless the driver has taken over."""
CONTACT, DRIVER, WALKED_INTO = "contact", "contact, driver drives", "walked into"
PARKED, FALSE, FAILED, UNUSED, ENDLESS = "parked", "false parked", "gave up", "not in use", "endless"
ENDS = {
    CONTACT: "touched something while the assist drives, or while it holds the car",
    FALSE: "claims to be parked outside the slot or beyond GB/T 41630",
    ENDLESS: "neither parked nor given up at the stop time",
    PARKED: "parked within GB/T 41630, nothing touched",
    FAILED: "gave up, nothing touched",
    UNUSED: "the driver was too fast for the assist to begin",
    DRIVER: "touched something while the driver drives",
    WALKED_INTO: "somebody or something moved into the standing car",
}
"""How a run in the world ends, the worst first."""


def _ends(columns: Columns) -> Mapping[str, Array]:
    """Return the end of each run, and what was touched first."""
    rows = [
        dict(zip(columns, row, strict=True)) for row in zip(*(_plain(item) for item in columns.values()), strict=True)
    ]
    touched = ["" if math.isnan(row["touched.x"]) else touched_first(row) for row in rows]
    return {
        "end": np.array([end_of(row) for row in rows], dtype=object),
        "touched": np.array(touched, dtype=object),
    }


def _plain(values: Any) -> list[Any]:
    return list(np.asarray(values).tolist())


def end_of(row: Mapping[str, Any]) -> str:
    """Return how a run ended, one of ``ENDS``."""
    if not math.isnan(row["touched.x"]):
        driven = row["touched.mode"] in DRIVES and not row["touched.takeover"]
        return CONTACT if driven else DRIVER
    if row["mode"] == Mode.FAIL:
        return FAILED if row["reason"] != "none" else ENDLESS
    if row["mode"] != Mode.PARKING_FINISH:
        return UNUSED if row["mode"] == Mode.STANDBY else ENDLESS
    return PARKED if row[WITHIN.format(GBT[int(row["kind"]) + 1])] else FALSE


def touched_first(row: Mapping[str, Any]) -> str:
    """Return the name of what the car is nearest to when it touches something for the first time."""
    pose = Pose(*(row[f"touched.{axis}"] for axis in AXES))
    car = [row[f"vehicle.car.{name}"] for name in ("wheelbase", "front_overhang", "rear_overhang", "width")]
    body, low = outline(pose, *car), outline(pose, car[0], WHEEL, WHEEL, car[3])
    gaps = [boxes_gap(body, box) if box.length > 0.0 else math.inf for box in _boxes(row)]
    kerb = (row[f"vehicle.scene.kerbs[1].{end}"] for end in ("x1", "y1", "x2", "y2"))
    height = row["vehicle.scene.kerbs[1].height"]
    part = low if height < GROUND_CLEARANCE else body
    gaps.append(boxes_gap(part, line_box(*kerb)) if height > 0.0 else math.inf)
    return THINGS[int(np.argmin(gaps))]


GROUND_CLEARANCE = 0.15
"""Kerbs lower than this [m] pass under the bumpers."""


def _boxes(row: Mapping[str, Any]) -> list[Box]:
    names = ("x", "y", "heading", "length", "width")
    return [Box(*(row.get(f"vehicle.scene.boxes[{n}].{name}", 0.0) for name in names)) for n in (1, 2, 3)]


FOUND = Derived({}, _ends, {"end": "how the run ended in the world", "touched": "what was touched first"})
