"""Pieces of a path that are driven in one gear, without a change of direction."""

from typing import NamedTuple

from controller_fmu.planning.plan import Path
from modelkit.maths import sign

SHORTEST = 0.01
"""A last piece that is shorter [m] is left out."""


class OneGear(NamedTuple):
    """The pieces that are driven in one gear, from ``first`` to ``last``, and their length [m]."""

    first: int
    last: int
    length: float


def stretch_of(path: Path, piece: int) -> OneGear:
    """Return the stretch that ``piece`` is of."""
    direction = sign(path.pieces[piece].way)
    first = piece
    while first > 0 and path.pieces[first - 1].way * direction > 0.0:
        first -= 1
    last = first
    length = abs(path.pieces[first].way)
    while last + 1 < path.used and path.pieces[last + 1].way * direction > 0.0:
        last += 1
        length += abs(path.pieces[last].way)
    return OneGear(first, last, length)


def way_before(path: Path, whole: OneGear, piece: int) -> float:
    """Return the way [m] from the begin of a stretch to that of a piece."""
    way = 0.0
    for number in range(whole.first, piece):
        way += abs(path.pieces[number].way)
    return way


def trimmed(path: Path) -> Path:
    """Return the path without last pieces that are not worth turning the wheel for."""
    used = path.used
    while used > 1 and abs(path.pieces[used - 1].way) < SHORTEST and path.pieces[used - 1].speed == 0.0:
        used -= 1
    return path._replace(used=used)
