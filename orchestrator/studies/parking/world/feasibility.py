"""Whether a run asks for what can be had: a slot that is valid for the car, and a task that is possible.

Both are said of the drawn factors alone, before anything is driven, and know nothing of what became of a run.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from orchestrator.evaluation.verdict.numbers import Metric
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.world.factors import NO_SENSOR, NOBODY
from orchestrator.studies.parking.world.scene import WHEEL, WITH_KERB, crosses_slot
from orchestrator.studies.sweep.study.study import Columns
from vehicle_fmu.ultrasonic import UltrasonicParams

COLUMNS = {
    "valid": Metric(
        "1", "1: the slot is valid for the vehicle, as far as sensors without height information can determine"
    ),
    "asked": Metric("1", "1: the task is feasible: driver, sensors and moving obstacles leave the slot to the vehicle"),
}
DETECTED_HEIGHT = UltrasonicParams().kerb_height
"""Kerbs lower than this [m] are not detected."""
MAX_SEARCH_SPEED = 20.0
"""A system has to detect slots up to this speed of the driver [km/h]: the fastest driver of the grid."""


def feasibility_columns(columns: Columns) -> Mapping[str, Array]:
    """Return the two columns of ``COLUMNS``, 1 or 0 of each run."""
    found = (ends_beyond_tail(columns), is_possible(columns))
    return {name: column.astype(float) for name, column in zip(COLUMNS, found, strict=True)}


def ends_beyond_tail(columns: Columns) -> NDArray[np.bool_]:
    """Return whether nothing that is detected lies under the tail of a car that stands flush in its slot.

    No slot is shorter or shallower than ISO 16787 asks for the car, however neighbours stand. But a wheel stop that
    is detected lies before the slot's end by the rear overhang less what the tyre reaches beyond the axle, and is a
    wall to sensors that do not tell height: where it lies under the tail of a car that stands flush, the car would
    stand out by the 15 cm that GB/T 41630 allows and still be nearer to it than the 15 cm from which sensors tell a
    distance.
    """
    values = {name: np.asarray(columns[name]) for name in ("kind", "behind", "kerb_height", "depth")}
    detected = (values["behind"] == WITH_KERB) & (values["kerb_height"] >= DETECTED_HEIGHT)
    under_tail = values["depth"] < np.asarray(columns["vehicle.car.rear_overhang"]) - WHEEL
    return np.asarray(~((values["kind"] == PERPENDICULAR_KIND) & detected & under_tail))


PERPENDICULAR_KIND = 1
"""Choice of the factor ``kind``."""


def is_possible(columns: Columns) -> Array:
    """Return whether a perfect assist could do what each run asks.

    Not so if the driver searches faster than the assist is made for, if a sensor fails (it may refuse), if a
    neighbour drives so far into a parallel slot that it becomes shorter than ISO 16787's, or if a pedestrian walks
    through the slot itself, who looks at nothing.
    """
    f = {name: np.asarray(columns[name]) for name in NEEDED}
    narrowed = (f["mover"] >= NOBODY) & (f["kind"] != PERPENDICULAR_KIND) & (f["mover_travel"] > f["extra"])
    walked = (f["person"] >= NOBODY) & crosses_slot(f["person_place"])
    return np.asarray((f["speed"] <= MAX_SEARCH_SPEED) & (f["lost"] < NO_SENSOR) & ~narrowed & ~walked)


NEEDED = ("speed", "lost", "mover", "mover_travel", "kind", "extra", "person", "person_place")
