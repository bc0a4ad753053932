"""The errors a user can cause or meet, each one sentence that says what would be right."""

import errno
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from orchestrator.inputs.text.renamed_names import VALUES, is_removed, moved_name, new_name

PARKED, NOT_PARKED, BAD_INPUT, INTERNAL_ERROR, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit codes. What was not judged never ends with the first two."""
SCARCE_RESOURCES = "this takes more memory, files or threads than there are (ulimit -a shows the limits)"


MIGRATE = " (apa migrate rewrites files)"
LINES: dict[str, Callable[[], dict[str, int]]] = {}
"""File that was read -> the lines of its keys."""


class BadInput(ValueError):  # noqa: N818 - said as it is
    """Something the user wrote is wrong: file, line, key, value, what would be right. Exit code 2.

    ``at`` is the key whose line is meant, where that is not ``key``.
    """

    def __init__(self, text: str, *, file: object = None, key: str | None = None, at: str | None = None) -> None:
        line = line_of(file, at or key)
        where = None if file is None else f"{file}:{line}" if line else str(file)
        place = ": ".join(part for part in (where, key) if part)
        super().__init__(as_line(f"{place}: {text}" if place else text))


@contextmanager
def locate_errors(file: object, key: str) -> Iterator[None]:
    """Name the file, and the line of ``key``, in an error that names neither."""
    try:
        yield
    except BadInput as error:
        raise BadInput(str(error), file=file, at=key) from None


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
    """An instance refused to go on; the run is aborted with that reason."""


class NotRunError(Exception):
    """Runs that could not take place: no memory, no file, no process, or an FMU that cannot be loaded. Exit code 2.

    Such a run is no row, margin, clause or verdict; what a model refuses in a run is ``RunError``. The arguments are
    the reasons, one for each run.
    """

    def __str__(self) -> str:
        counts = Counter(str(item) for item in self.args)
        if len(self.args) == 1:
            return f"could not take place: {self.args[0]}"
        first = "; ".join(f"{text} ({count})" for text, count in counts.most_common(SHOWN_REASONS))
        return f"{len(self.args)} runs could not take place: {first}{'; ...' if len(counts) > SHOWN_REASONS else ''}"


SHOWN_REASONS = 3
RESOURCES = (OSError, MemoryError)
"""What keeps a run from taking place, beside an FMU that cannot be loaded."""
SCARCE_ERRNOS = frozenset({errno.ENOMEM, errno.EMFILE, errno.ENFILE, errno.EAGAIN})


def lacks_resources(error: BaseException) -> bool:
    """Return whether an error is for want of memory, files or threads: the file that was read is not to blame."""
    return isinstance(error, MemoryError) or (isinstance(error, OSError) and error.errno in SCARCE_ERRNOS)


def suggestion(word: str, known: Iterable[str], prefix: str = "") -> str:
    """Return ``; did you mean X?`` with at most three of ``known``, ``prefix`` before each; empty if none is like it.

    A name of an earlier version is answered with ``; it is called X now``.

    Names with the same last part come first, then names that contain the word, then similar spellings.
    """
    import difflib

    for name in (prefix + word, word):
        if moved_name(name):
            return f"; it is called {moved_name(name)} now"
        if is_removed(name):
            return "; this version has no such variable"
    now = new_name(word, prefix)
    if now:
        return f"; it is called {now} now{'' if word.startswith('-') else MIGRATE}"
    names = list(known)
    key = word[:MOST_LETTERS].lower()
    last = key.rsplit(".", 1)[-1]
    partial = [name for name in names if len(key) >= MIN_PARTIAL_LETTERS and key in name.lower()]
    ranked = [
        *sorted((name for name in names if last and name.lower().rsplit(".", 1)[-1] == last), key=len),
        *sorted(partial, key=lambda name: (not name.lower().endswith(key), len(name))),
        *difflib.get_close_matches(word[:MOST_LETTERS], names[:MAX_COMPARED], n=2, cutoff=MIN_SIMILARITY),
    ]
    chosen = list(dict.fromkeys(ranked))[:MAX_SUGGESTIONS]
    return f"; did you mean {' or '.join(prefix + name for name in chosen)}?" if chosen else ""


def suggestion_or_choices(word: str, known: Iterable[str], prefix: str = "", listing: str = "") -> str:
    """Return the :func:`suggestion`, or else the names that are valid: at most eight, then the command ``listing``."""
    names = list(known)
    return suggestion(word, names, prefix) or choices(names, listing)


def choices(known: Iterable[str], listing: str = "") -> str:
    """Return ``; expected one of: a, b, c``, the first eight names and how many more there are."""
    names = list(known)
    if not names:
        return "; there are none"
    more = len(names) - MAX_CHOICES
    rest = f" and {more} more" if more > 0 else ""
    return f"; expected one of: {', '.join(names[:MAX_CHOICES])}{rest}{f' ({listing})' if listing else ''}"


MAX_SUGGESTIONS, MIN_PARTIAL_LETTERS, MIN_SIMILARITY = 3, 2, 0.6
"""At most so many names are suggested; a word of so many letters may be part of a name; ratio of ``difflib``."""
MAX_COMPARED = 2000
"""Names that are compared letter by letter; the others may be suggested for their last part or for a part of them."""
MAX_CHOICES = 8
"""Names that a message lists before it says how many more there are."""
MOST_EXCERPT = 500
"""Letters of another library's message."""
MAX_MESSAGE, MAX_ENDING = 2_000, 300
"""Letters of a message of ours, and of its end where it is cut."""
MOST_LETTERS = 100
"""A word longer than this is like no other."""


def why_no_file(path: Path) -> str:
    """Return why a path is no file that can be read."""
    if path.is_dir():
        return "is a folder, expected a file"
    return "is no regular file" if path.exists() else "no such file"


def rename_hint(key: str, value: object) -> str:
    """Return ``; it is called X now`` for a value of ``faults[1].kind`` or the like that was in use before."""
    now = VALUES.get(key.rpartition(".")[2], {}).get(str(value), "")
    return f"; it is called {now} now{MIGRATE}" if now else ""


def format_value(value: object) -> str:
    """Return a value for a message: as Python writes it, cut where it is long."""
    text = repr(value)
    return text if len(text) <= MOST_LETTERS else f"{text[:60]}... ({len(text)} letters)"


def as_line(text: str) -> str:
    """Return a message without line breaks; a long one keeps its beginning and its end."""
    text = " ".join(text.splitlines())
    middle = f"... ({len(text)} letters) ..."
    return text if len(text) <= MAX_MESSAGE else text[: MAX_MESSAGE - MAX_ENDING] + middle + text[-MAX_ENDING:]


def excerpt(error: object) -> str:
    """Return in one line what another library says of a file, with the file's long words cut."""
    lines = [line for line in str(error).splitlines() if line.strip()]
    text = lines[0] if lines else type(error).__name__
    cut = re.sub(f"\\S{{{MOST_LETTERS + 1},}}", lambda word: f"{word[0][:60]}... ({len(word[0])} letters)", text)
    return cut if len(cut) <= MOST_EXCERPT else f"{cut[:MOST_EXCERPT]}... ({len(cut)} letters)"
