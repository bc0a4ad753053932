"""The way a car came, backwards: where no way leads on from beside something heard, one may from before it."""

from typing import NamedTuple

from controller_fmu.planning.plan import PATH, Path, Piece
from modelkit.maths import sign

FAR = 1.2
"""A car that has gone back so far [m] begins no other piece, and of one it drives no more."""
LEAST = 0.15
"""It goes back no less [m], or not at all."""
MOST = 4
"""Nor over more pieces than this."""
DRIVEN = 0.02
"""Less of a piece [m] is not driven back."""


class WayBack(NamedTuple):
    """The last pieces that were driven, as they are driven back; those past ``used`` are not."""

    used: int = 0
    pieces: tuple[Piece, ...] = (Piece(),) * MOST


def way_back(path: Path, piece: int, left: float) -> WayBack:
    """Return the way back over a path of which this piece was driven but for ``left`` [m], to the last change of gear.

    Without pieces if there is hardly any.
    """
    begun = _driven(path, piece, left) > DRIVEN
    last = piece if begun else piece - 1
    rest = left if begun else 0.0
    used = 0
    total = 0.0
    for number in range(MOST):
        driven = _driven(path, last - number, rest if number == 0 else 0.0)
        same = driven > 0.0 and _came(path, last - number).way * _came(path, last).way > 0.0
        if used == number and same and total < FAR:
            used = number + 1
            total = total + driven
    pieces = tuple(
        _back(path, last - number, rest if number == 0 else 0.0) if number < used else Piece() for number in range(MOST)
    )
    return WayBack(used, pieces) if total > LEAST else WayBack()


def path_back(back: WayBack) -> Path:
    """Return the way back as a path; it has no margin: where the car has driven nothing stands, whatever is heard."""
    pieces = tuple(back.pieces[number if number < MOST else 0] if number < MOST else Piece() for number in range(PATH))
    return Path(back.used, 0.0, 0.0, pieces)


def _came(path: Path, piece: int) -> Piece:
    """Return a piece of a path, one without a way where there is none."""
    at = piece if 0 <= piece < PATH else 0
    return path.pieces[at] if 0 <= piece < path.used else Piece()


def _driven(path: Path, piece: int, left: float) -> float:
    """Return how much [m] of a piece is driven back, of which ``left`` [m] were not driven."""
    return min(max(abs(_came(path, piece).way) - left, 0.0), FAR)


def _back(path: Path, piece: int, left: float) -> Piece:
    """Return a piece as it is driven back."""
    came = _came(path, piece)
    return Piece(-sign(came.way) * _driven(path, piece, left), came.k)
