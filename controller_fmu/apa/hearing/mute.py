"""Sensors that tell nothing usable: what the assist makes of such a reading, and what it does without the sensor.

A sensor that hears nothing tells its largest distance, and says that nothing is near. One that tells no number, or
less than any echo could be, says nothing at all: its reading is put beyond all distances, and what the other sensors
tell has to do. A car on its way in stops when a sensor falls silent, waits for it, and then goes on without it, slowly.
Not without two, and not on its way out; the search needs the two that find slots. Then the assist gives up.
"""

from controller_fmu.apa.params import SensorParams
from controller_fmu.common.sensors import LEFT_SENSOR, RIGHT_SENSOR
from modelkit.maths import is_finite

MUTE = 1e3
"""Reading [m] of a sensor that tells nothing."""
WAIT = 2.0
"""A car stands so long [s] for a sensor to come back."""
SLOWLY = 0.4
"""It goes no faster [m/s] without one."""


def usable(readings: tuple[float, ...], nearest: float) -> tuple[float, ...]:
    """Return the readings [m]; ``MUTE`` for each that is no distance: not finite, or under half of the ``nearest``."""
    for number in range(12):
        reading = readings[number]
        if not is_finite(reading) or reading < 0.5 * nearest:
            readings = readings[:number] + (MUTE,) + readings[number + 1 :]
    return readings


def is_mute(reading: float) -> bool:
    """Return whether a reading is of a sensor that tells nothing."""
    return reading >= MUTE


def count_mute(readings: tuple[float, ...]) -> int:
    """Return how many sensors tell nothing."""
    count = 0
    for reading in readings:
        count = count + 1 if is_mute(reading) else count
    return count


def spared(readings: tuple[float, ...], looking: bool) -> int:
    """Return how many sensors may tell nothing on the way in, or in the search while it is ``looking`` for a slot."""
    needed = is_mute(readings[LEFT_SENSOR]) or is_mute(readings[RIGHT_SENSOR])
    return 0 if looking and needed else 1


def is_waited_for(mute_ns: int, params: SensorParams) -> bool:
    """Return whether a car stands for a sensor that has told nothing for so long [ns]."""
    since = mute_ns * 1e-9
    return params.blind_time < since < params.blind_time + WAIT
