"""What drive and brake ask of the wheels."""

from typing import NamedTuple


class Effort(NamedTuple):
    """Force of drive (signed) and largest force of the brake (>= 0) at the rims, of the whole car [N]."""

    drive: float = 0.0
    brake: float = 0.0
