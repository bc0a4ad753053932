"""A silent sensor: one that returns no echo although one is expected, again and again.

Each expected echo that does not come multiplies the likelihood ratio silent : working by 1 / dropout; each echo of any
kind proves that the sensor works. With a dropout probability of 5 %, ``MISSED_ECHOES`` in a row leave 2e-8.
"""

from typing import NamedTuple

from controller_fmu.parking.measurement.sensor import SENSORS, ReadingStatus

MISSED_ECHOES = 6
"""In a row, by a working sensor once in 6e7 times (5 % dropouts)."""


class MissedEchoes(NamedTuple):
    """How many expected echoes in a row each sensor has missed."""

    counts: tuple[int, ...] = (0,) * SENSORS


def count_missed_echoes(before: MissedEchoes, statuses: tuple[int, ...], expected: tuple[bool, ...]) -> MissedEchoes:
    """Return the counts after one cycle: ``statuses`` of the readings, ``expected`` whether an echo had to come."""
    counts = tuple(_count(before.counts[number], statuses[number], expected[number]) for number in range(SENSORS))
    return MissedEchoes(counts)


def _count(before: int, status: int, expected: bool) -> int:
    if status in (ReadingStatus.ECHO, ReadingStatus.BLIND_ZONE):
        return 0
    return min(before + 1, MISSED_ECHOES) if expected else before


def is_silent(missed: MissedEchoes, sensor: int) -> bool:
    """Return whether a sensor (0 to 11) is silent."""
    return missed.counts[sensor] >= MISSED_ECHOES
