"""When the sensors deliver new readings: once per measurement cycle, up to one exchange late."""

import math
from typing import NamedTuple

from controller_fmu.parking.measurement.sensor import MAX_SENSORS

MAX_TRANSPORT_DELAY = 0.01
"""Readings arrive at most this long [s] after their cycle ended: one communication step of the co-simulation."""


class MeasurementCycle(NamedTuple):
    """The last readings [m], for how long the next have been due [ns] (0: not due), and whether they are new."""

    readings: tuple[float, ...] = (0.0,) * MAX_SENSORS
    due_ns: int = 0
    is_new: bool = False


def next_cycle(
    before: MeasurementCycle, readings: tuple[float, ...], time_ns: int, dt_ns: int, period: float
) -> MeasurementCycle:
    """Return the cycle at ``time_ns``, a sample of ``dt_ns`` later; sensors measure every ``period`` [s].

    Readings that differ from the last ones are new. Equal ones are new once ``MAX_TRANSPORT_DELAY`` has passed.
    """
    is_due = time_ns % math.floor(period * 1e9 + 0.5) < dt_ns
    if not is_due and before.due_ns == 0:
        return before._replace(is_new=False)
    waited_ns = before.due_ns + dt_ns
    changed = is_due and before.due_ns > 0
    for number in range(MAX_SENSORS):
        changed = changed or readings[number] != before.readings[number]
    if not changed and seconds(waited_ns) <= MAX_TRANSPORT_DELAY:
        return before._replace(due_ns=waited_ns, is_new=False)
    return MeasurementCycle(readings, 0, True)


def seconds(time_ns: int) -> float:
    """Return ``time_ns`` [ns] in seconds."""
    return time_ns * 1e-9
