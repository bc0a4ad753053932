"""What is printed: tables and a progress bar on a terminal, plain text elsewhere. NO_COLOR is respected."""

import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, SpinnerColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from orchestrator.cosim.master import End
from orchestrator.text.quantities import DEGREE
from orchestrator.verdict.compare import Difference
from orchestrator.verdict.judge import Check
from orchestrator.verdict.summary import Summary

PARKED, NOT_PARKED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
"""Exit codes."""
COLOURS = {"parked": "bold green", "not_parked": "bold yellow", "failed": "bold red", "aborted": "bold red"}
SIGNS = {"max": "\u2264", "min": "\u2265", "max_abs": "\u00b1", "equals": "="}
PIPED_WIDTH = 200
"""Characters in a line that goes to a file or another program."""
PROGRESS_PERIOD_NS = 500_000_000


def console(stream: TextIO | None = None) -> Console:
    """Return a console that writes colours only to a terminal that wants them."""
    stream = stream or sys.stdout
    return Console(file=stream, highlight=False, width=None if stream.isatty() else PIPED_WIDTH)


@contextmanager
def working(text: str) -> Iterator[None]:
    """Show on standard error, if that is a terminal, that something of unknown length goes on, and for how long."""
    columns = (SpinnerColumn(), TextColumn(text), TimeElapsedColumn())
    with Progress(*columns, console=console(sys.stderr), transient=True, disable=not sys.stderr.isatty()) as progress:
        progress.add_task(text, total=None)
        yield


class ProgressBar:
    """Observer that shows simulated time on standard error, if that is a terminal."""

    def __init__(self, title: str, stop_ns: int) -> None:
        columns = (TextColumn(title), BarColumn(), TaskProgressColumn(), TextColumn("{task.completed:.0f} s"))
        self._progress = Progress(*columns, TimeElapsedColumn(), console=console(sys.stderr), transient=True)
        self._task = self._progress.add_task(title, total=stop_ns / 1e9)
        self._next_ns = 0
        self._progress.start()

    def exchanged(self, t_ns: int) -> None:
        """Move the bar twice per simulated second."""
        if t_ns >= self._next_ns:
            self._next_ns = t_ns + PROGRESS_PERIOD_NS
            self._progress.update(self._task, completed=t_ns / 1e9)

    def closed(self, end: End) -> None:
        """Remove the bar."""
        self._progress.stop()


def print_summary(summary: Summary, title: str, expected: str) -> None:
    """Print outcome, numbers and checks of a run."""
    out = console()
    style = COLOURS[summary.outcome]
    wanted = "" if summary.outcome == expected else f"  (expected: {expected})"
    out.print(f"[bold]{summary.scenario}[/]  {escape(title)}".rstrip())
    out.print(f"[{style}]{summary.outcome}[/]: {escape(summary.reason)}{wanted}")
    final = summary.final
    out.print(
        f"{summary.duration:.2f} s, {summary.shifts} shifts, up to {summary.max_speed:.2f} m/s; at the end "
        f"{final.lateral_error * 100:+.1f} cm lateral, {final.longitudinal_error * 100:+.1f} cm longitudinal, "
        f"{final.heading_error / DEGREE:+.2f} deg, wheel {final.steering_wheel_angle / DEGREE:+.1f} deg"
    )
    if summary.checks:
        out.print(checks_table(summary.checks, out))
    out.print(f"{summary.wall_time:.2f} s of computing, {summary.real_time_factor:.0f} times real time")


def checks_table(checks: list[Check], out: Console) -> Table:
    """Return the checks as a table."""
    table = Table(box=None if not out.is_terminal else Table().box, pad_edge=out.is_terminal)
    for name, justify in (("check", "left"), ("value", "right"), ("limit", "right"), ("margin", "right"), ("", "left")):
        table.add_column(name, justify=justify)  # type: ignore[arg-type]
    table.add_column("source")
    for check in checks:
        verdict = "[green]pass[/]" if check.passed else "[red]MISS[/]" if check.required else "[yellow]miss[/]"
        value = check.note or readable(check.value, check.unit)
        table.add_row(
            escape(check.id),
            value,
            limit_text(check),
            readable(check.margin, check.unit),
            verdict,
            escape(check.source),
        )
    return table


def limit_text(check: Check) -> str:
    """Return what is asked for, as people read it."""
    return f"{SIGNS[check.condition]} {check.limit_name or readable(check.limit, check.unit)}"


def differences_table(rows: list[Difference], out: Console) -> Table:
    """Return signals that differ between two runs as a table."""
    table = Table(box=None if not out.is_terminal else Table().box, pad_edge=out.is_terminal)
    for name in ("signal", "largest", "tolerance", "at", "first beyond", ""):
        table.add_column(name, justify="left" if name in ("signal", "") else "right")
    for row in rows:
        largest = "" if row.largest is None else precise(row.largest, row.unit)
        times = ["" if t is None else f"{t:.3f} s" for t in (row.t_largest, row.first)]
        table.add_row(row.signal, largest, precise(row.allowed, row.unit), *times, row.note)
    return table


def precise(value: float, unit: str) -> str:
    """Return a number that may be tiny, in SI."""
    return f"{value:.3g} {unit}" if unit != "1" else f"{value:.3g}"


def readable(value: float, unit: str) -> str:
    """Return a number for people: angles in degrees, the rest in SI."""
    if not math.isfinite(value):
        return str(value)
    if unit.startswith("rad"):
        return f"{value / DEGREE:.2f} {unit.replace('rad', 'deg')}"
    return f"{value:.3f} {unit}" if unit != "1" else f"{value:g}"
