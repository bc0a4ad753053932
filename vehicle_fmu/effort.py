"""What drive and brake ask of the wheels."""

from typing import NamedTuple


class Effort(NamedTuple):
    """Force of drive (signed) and largest force of the brake (>= 0) at the rims, of the whole car [N]."""

    drive: float = 0.0
    brake: float = 0.0


def mean_effort(first: Effort, second: Effort) -> Effort:
    """Return the mean of two efforts."""
    return Effort(0.5 * (first.drive + second.drive), 0.5 * (first.brake + second.brake))
