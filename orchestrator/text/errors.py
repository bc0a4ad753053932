"""The errors a user can cause or meet, each one sentence that says what would be right."""

from collections.abc import Callable, Iterable

PARKED, NOT_PARKED, BAD_INPUT, INTERNAL_ERROR, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit codes. What was not judged never ends with the first two."""


LINES: dict[str, Callable[[], dict[str, int]]] = {}
"""File that was read -> the lines of its keys."""


class BadInput(ValueError):  # noqa: N818 - said as it is
    """Something the user wrote is wrong: file, line, key, value, what would be right. Exit code 2.

    ``at`` is the key whose line is meant, where that is not ``key``.
    """

    def __init__(self, text: str, *, file: object = None, key: str | None = None, at: str | None = None) -> None:
        line = line_of(file, at or key)
        where = None if file is None else f"{file}:{line}" if line else str(file)
        place = ": ".join(part for part in (where, key) if part is not None)
        super().__init__(f"{place}: {text}" if place else text)


def line_of(file: object, key: str | None) -> int:
    """Return the line of a key, or of what it is in, in a file that was read; 0 if it is not known."""
    known = LINES.get(str(file))
    if known is None or not key:
        return 0
    lines = known()
    while key and key not in lines:
        key = key[: max(key.rfind("."), key.rfind("["), 0)]
    return lines.get(key, 0)


class RunError(Exception):
    """A slave refused to go on; the run is aborted and says so."""


def suggestion(word: str, known: Iterable[str], prefix: str = "") -> str:
    """Return ``; did you mean X?`` with the closest of ``known``, ``prefix`` before each, or an empty string."""
    import difflib

    names = list(known)
    close = difflib.get_close_matches(word[:MOST_LETTERS], names, n=2, cutoff=0.6)
    if not close:
        close = [name for name in names if name.rsplit(".", 1)[-1] == word.rsplit(".", 1)[-1]][:2]
    return f"; did you mean {' or '.join(prefix + name for name in close)}?" if close else ""


MOST_LETTERS = 100
"""A word longer than this is like no other."""


def shown(value: object) -> str:
    """Return a value for a message: as Python writes it, cut where it is long."""
    text = repr(value)
    return text if len(text) <= MOST_LETTERS else f"{text[:60]}... ({len(text)} letters)"
