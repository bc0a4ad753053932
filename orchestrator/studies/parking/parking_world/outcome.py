"""What became of a run, whatever system drove it: contact first, then a claim, judged by the scene.

Contact is any contact. Moving means above ``MOVING_SPEED``. ``valid`` follows from the scene alone: ISO 16787's
shortest slot for the car, less what stands out into it, and nothing in it.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orchestrator.evaluation.verdict.measures import Instants, Measure
from orchestrator.evaluation.verdict.numbers import Metric
from orchestrator.evaluation.verdict.outcome import BEYOND
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.parking_world.scene import has_bin, overhang_of
from orchestrator.studies.parking.parkings import GBT
from orchestrator.studies.sweep.columns import WITHIN
from orchestrator.studies.sweep.study.study import Columns, DerivedParameter

MOVING_SPEED = 0.05
"""A car no faster [m/s] stands."""
TOUCHING = Instants("vehicle.contact", (1,))
MEASURES = {
    **{f"touched.{axis}": Measure("first", f"vehicle.pose.{axis}", TOUCHING) for axis in ("x", "y", "heading")},
    "touched.speed": Measure("first", "vehicle.speed", TOUCHING),
    "touched.takeover": Measure("first", "vehicle.driver_takeover", TOUCHING),
    "touched.steering_active": Measure("first", "controller.steering_active", TOUCHING),
    "touched.time": Measure("time", "vehicle.speed", TOUCHING),
    "steered": Measure("greatest", "controller.steering_active"),
}
MOVING, STANDING, DRIVER = "contact, moving", "contact, standing", "contact, driver drives"
FALSE, PARKED, FAILED, ENDLESS = "false parked", "parked", "gave up", "endless"
ENDS = {
    MOVING: f"touched something while the system drives, above {MOVING_SPEED} m/s",
    STANDING: f"touched something, or was touched, at no more than {MOVING_SPEED} m/s",
    FALSE: "claims to be parked outside the slot, beyond GB/T 41630, or where there is no slot",
    ENDLESS: "neither parked nor given up at the stop time",
    PARKED: "parked within GB/T 41630, nothing touched",
    FAILED: "gave up, nothing touched",
    DRIVER: "touched something while the driver drives",
}
"""How a run ends, the worst first."""
COLUMNS = {"valid": Metric("1", "1: by the scene alone, the slot has ISO 16787's room for the car, and nothing in it")}


def _outcome_columns(columns: Columns) -> Mapping[str, Array]:
    valid = is_valid(columns)
    names = ("outcome", "reason", "kind", *MEASURES, *(WITHIN.format(name) for name in GBT.values()))
    rows = zip(*(np.asarray(columns[name]).tolist() for name in names), strict=True)
    ends = [end_of(dict(zip(names, row, strict=True)), bool(ok)) for row, ok in zip(rows, valid, strict=True)]
    return {"valid": valid.astype(float), "end": np.array(ends, dtype=object)}


def is_valid(columns: Columns) -> NDArray[np.bool_]:
    """Return whether each slot is one for its car."""
    f = {name: np.asarray(columns[name]) for name in ("kind", "extra", "overhang", "overhang_length", "bin")}
    return np.asarray((f["extra"] >= overhang_of(f)) & ~has_bin(f))


def end_of(row: Mapping[str, Any], valid: bool) -> str:
    """Return how a run ended, one of ``ENDS``."""
    if not math.isnan(row["touched.speed"]):
        if row["touched.takeover"] or not row["touched.steering_active"]:
            after = row["steered"] and not row["touched.takeover"] and abs(row["touched.speed"]) <= MOVING_SPEED
            return STANDING if after else DRIVER
        return MOVING if abs(row["touched.speed"]) > MOVING_SPEED else STANDING
    if row["outcome"] == "parked" or row["reason"].startswith(BEYOND):
        return PARKED if valid and row[WITHIN.format(GBT[int(row["kind"]) + 1])] else FALSE
    return FAILED if row["outcome"] == "failed" else ENDLESS


FOUND = DerivedParameter(COLUMNS, _outcome_columns, {"end": "how the run ended"})
