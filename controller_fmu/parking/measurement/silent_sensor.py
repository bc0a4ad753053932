"""A silent sensor: one that returns no echo although one is expected, again and again.

Each expected echo that does not come multiplies the likelihood ratio silent : working by 1 / dropout; each echo of any
kind proves that the sensor works. With a dropout probability of 5 %, ``MISSED_ECHOES`` in a row leave 2e-8.
"""

from typing import NamedTuple

from controller_fmu.parking.measurement.sensor import FRONT_LEFT_SIDE, MAX_SENSORS, ReadingStatus

MISSED_ECHOES = 6
"""In a row, by a working sensor once in 6e7 times (5 % dropouts)."""


class MissedEchoes(NamedTuple):
    """How many expected echoes in a row each sensor has missed."""

    counts: tuple[int, ...] = (0,) * MAX_SENSORS


def count_missed_echo(before: MissedEchoes, sensor: int, status: int, is_expected: bool) -> MissedEchoes:
    """Return the counts after one reading: its ``ReadingStatus``, and whether an echo had to come."""
    at = min(max(sensor, 0), MAX_SENSORS - 1)
    count = before.counts[at]
    if status == ReadingStatus.ECHO or status == ReadingStatus.BLIND_ZONE:
        count = 0
    elif is_expected:
        count = min(count + 1, MISSED_ECHOES)
    return MissedEchoes(before.counts[:at] + (count,) + before.counts[at + 1 :])


def is_credible_miss(missed: MissedEchoes, sensor: int) -> bool:
    """Return whether a missing echo of a sensor (0 to 11) shows free space rather than a silent sensor."""
    return missed.counts[min(max(sensor, 0), MAX_SENSORS - 1)] < MISSED_ECHOES // 2


def is_silent(missed: MissedEchoes, sensor: int) -> bool:
    """Return whether a sensor (0 to 11) is silent."""
    return missed.counts[min(max(sensor, 0), MAX_SENSORS - 1)] >= MISSED_ECHOES


def has_blind_side(missed: MissedEchoes) -> bool:
    """Return whether two sensors in a row on a bumper (0 to 3, 4 to 7) or a flank (8, 9; 10, 11) are silent: a gap."""
    return any(
        (number % 4 < 3 if number < FRONT_LEFT_SIDE else number % 2 == 0)
        and is_silent(missed, number)
        and is_silent(missed, number + 1)
        for number in range(MAX_SENSORS - 1)
    )
