"""Talking to people: colours only on a terminal that wants them, progress on standard error, silence if asked for."""

import shlex
import sys
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any, Self, TextIO

from orchestrator.inputs.text.printable import printable

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress, ProgressColumn
    from rich.table import Table

QUIET: ContextVar[bool] = ContextVar("quiet", default=False)
"""Whether only errors are wanted."""
COMMAND: ContextVar[str] = ContextVar("command", default="")
"""The command line of ``apa`` that is carried out; empty in a program that imports this package."""
PIPED_WIDTH = 200
"""Characters in a line that goes to a file or another program."""
PERIOD, LONGEST = 5.0, 60.0
"""Until the first line of progress where there is no terminal, and between two at most [s]; each time twice as long."""


def resuming_command() -> str:
    """Return the command line that goes on with what the present one has left unfinished."""
    words = [word for word in shlex.split(COMMAND.get()) if word not in ("--resume", "--restart")]
    return shlex.join([*words, "--resume"])


def console(stream: TextIO | None = None) -> "Console":
    """Return a console that writes colours only to a terminal that wants them, and no control characters of others."""
    from rich.console import Console
    from rich.segment import Segment

    class SafeConsole(Console):
        """Takes control characters out of all texts, when they are whole and the colours are not in them yet."""

        def _render_buffer(self, buffer: Iterable[Segment]) -> str:
            safe = [item if item.control else Segment(printable(item.text), item.style) for item in buffer]
            return super()._render_buffer(safe)

    given: Any = stream or sys.stdout
    whole = given.unfiltered if isinstance(given, PrintableStream) else given
    return SafeConsole(file=whole, highlight=False, width=None if whole.isatty() else PIPED_WIDTH)


def result_table(screen: "Console", titles: Sequence[str], texts: Sequence[str] = ()) -> "Table":
    """Return an empty table with a frame on a terminal only; columns to the right, but ``texts`` to the left."""
    from rich.table import Table

    table = Table(box=Table().box if screen.is_terminal else None, pad_edge=screen.is_terminal)
    for title in titles:
        table.add_column(title, justify="left" if title in texts else "right")
    return table


class PrintableStream:
    """A standard stream that shows control characters as numbers: texts of third parties go to a terminal."""

    def __init__(self, stream: Any) -> None:
        self.unfiltered = stream

    def write(self, text: str) -> int:
        """Write a text; return how many letters of it."""
        self.unfiltered.write(printable(text))
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.unfiltered, name)


@contextmanager
def printable_streams() -> Iterator[None]:
    """Let no control character of a third party's text reach standard output or standard error."""
    before = sys.stdout, sys.stderr
    streams: list[Any] = [item if isinstance(item, PrintableStream) else PrintableStream(item) for item in before]
    sys.stdout, sys.stderr = streams
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


def say(text: str) -> None:
    """Write a line for people to standard error."""
    if not QUIET.get():
        print(text, file=sys.stderr, flush=True)


class Warnings:
    """Warns on standard error, of each thing once."""

    def __init__(self) -> None:
        self._said: set[str] = set()

    def __call__(self, text: str) -> None:
        """Write the warning, unless it was written before."""
        if text not in self._said:
            self._said.add(text)
            say(f"apa: {text}" if text.startswith("note: ") else f"apa: warning: {text}")


@contextmanager
def working(text: str) -> Iterator[None]:
    """Show that something of unknown length goes on, and for how long: a spinner, or a line now and then."""
    if sys.stderr.isatty() and not QUIET.get():
        from rich.progress import SpinnerColumn, TextColumn, TimeElapsedColumn

        columns = (SpinnerColumn(), TextColumn(text), TimeElapsedColumn())
        with _bar(*columns) as progress:
            progress.add_task(text, total=None)
            yield
        return
    over = threading.Event()
    teller = None if QUIET.get() else threading.Thread(target=_tell, args=(text, over), daemon=True)
    if teller is not None:
        teller.start()
    try:
        yield
    finally:
        over.set()
        if teller is not None:
            teller.join()


def _bar(*columns: "ProgressColumn") -> "Progress":
    """Return a bar that lets a file have what is printed meanwhile."""
    from rich.progress import Progress

    return Progress(*columns, console=console(sys.stderr), transient=True, redirect_stdout=sys.stdout.isatty())


def _tell(text: str, over: threading.Event) -> None:
    begun, period = time.monotonic(), PERIOD
    while not over.wait(period):
        say(f"{text}: {time.monotonic() - begun:.0f} s")
        period = min(2.0 * period, LONGEST)


def progress_text(done: float, total: float, unit: str) -> str:
    """Return how much of ``total`` is done; what is less than one has two digits."""
    return f"{done:.0f} of {total:.0f} {unit}" if done >= 1.0 else f"{done:.2g} of {total:g} {unit}"


class Meter:
    """How far something is: a bar on a terminal, elsewhere a line now and then."""

    def __init__(self, title: str, total: float, unit: str) -> None:
        self._title, self._total, self._unit = title, total, unit
        self._done = 0.0
        self._period = PERIOD
        self._next = time.monotonic() + PERIOD
        self._bar: Progress | None = None
        if sys.stderr.isatty() and not QUIET.get():
            from rich.progress import BarColumn, TextColumn, TimeRemainingColumn

            columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[at]}, left"))
            self._bar = _bar(*columns, TimeRemainingColumn())
            self._task = self._bar.add_task(title, total=total, at="")

    def __enter__(self) -> Self:
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def at(self, done: float, more: str = "") -> None:
        """Show that ``done`` of the total is done; ``more`` is said beside it."""
        self._done = done
        text = f"{progress_text(done, self._total, self._unit)}{', ' + more if more else ''}"
        if self._bar is not None:
            self._bar.update(self._task, completed=done, at=text)
        elif time.monotonic() >= self._next:
            self._period = min(2.0 * self._period, LONGEST)
            self._next = time.monotonic() + self._period
            say(f"{self._title}: {text}")

    def note(self, more: str) -> None:
        """Show ``more`` beside what was done last."""
        self.at(self._done, more)
