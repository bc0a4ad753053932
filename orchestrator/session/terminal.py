"""What is printed of a run: outcome, numbers, checks, differences, as tables."""

import math
from collections.abc import Iterator

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from orchestrator.evaluation.comparison.compare import Difference
from orchestrator.evaluation.verdict.judge import Check
from orchestrator.evaluation.verdict.limit_text import limit_text
from orchestrator.evaluation.verdict.summary import Final, Summary
from orchestrator.inputs.text.console import console, result_table
from orchestrator.inputs.text.quantities import RAD_PER_DEGREE
from orchestrator.inputs.text.readable import changes_text, manoeuvres_text, precise, readable

GOOD, SHORT, BAD = "bold green", "bold yellow", "bold red"
COLOURS = {"parked": GOOD, "finished": GOOD, "not_parked": SHORT, "not_finished": SHORT, "failed": BAD, "aborted": BAD}


def print_summary(summary: Summary, title: str, expected: str) -> None:
    """Print outcome, numbers and checks of a run."""
    out = console()
    style = COLOURS[summary.outcome]
    wanted = "" if summary.outcome == expected else f"  (expected: {expected})"
    out.print(f"[bold]{summary.scenario}[/]  {escape(title)}".rstrip())
    if changes_text(summary.overrides):
        out.print(f"overrides: {escape(changes_text(summary.overrides))}")
    out.print(f"[{style}]{summary.outcome}[/]: {escape(summary.headline)}{wanted}")
    out.print(
        f"{summary.duration:.2f} s, {manoeuvres_text(summary.manoeuvres)}, up to {summary.max_speed:.2f} m/s; "
        + "at the end "
        + ", ".join(_at_the_end(summary.final))
    )
    for note in summary.notes:
        out.print(f"note: {note}", markup=False)
    if summary.checks:
        out.print(checks_table(summary.checks, out))
    if summary.realtime is None:
        out.print(f"{summary.wall_time:.2f} s of computing, {summary.real_time_factor:.0f} times real time")
        return
    late = summary.realtime
    out.print(
        f"real time: median {1e3 * late.median:.2f} ms late, 99 % within {1e3 * late.percentile_99:.2f} ms, "
        f"at most {1e3 * late.largest:.1f} ms; {late.late} of {late.exchanges} exchanges over 1 ms"
    )
    for change in late.tuned:
        out.print(f"changed at {change.t:.2f} s: {change.name} = {change.value:g}", markup=False)


def _at_the_end(final: Final) -> Iterator[str]:
    """Yield how the car stands, as far as the scenario says where it should."""
    if math.isfinite(final.lateral_error):
        yield f"{final.lateral_error * 100:+.1f} cm lateral"
        yield f"{final.longitudinal_error * 100:+.1f} cm longitudinal"
        yield f"{final.heading_error / RAD_PER_DEGREE:+.2f} deg"
    if math.isfinite(final.outline_margin):
        side = "inside" if final.outline_margin >= 0.0 else "beyond"
        yield f"outline {abs(final.outline_margin) * 100:.1f} cm {side} the slot boundary"
    yield f"wheel {final.steering_wheel_angle / RAD_PER_DEGREE:+.1f} deg"


ALLOWED = "allowed: "
"""Begins the source of a requirement that the scenario has taken back."""


def checks_table(checks: list[Check], out: Console) -> Table:
    """Return the checks as a table."""
    table = result_table(out, ("check", "value", "limit", "margin", "", "source"), ("check", "", "source"))
    for check in checks:
        verdict = "[green]pass[/]" if check.passed else "[red]FAIL[/]" if check.required else "[yellow]fail[/]"
        if check.source.startswith(ALLOWED) and not check.passed:
            verdict = "[yellow]allowed[/]"
        verdict = verdict if check.evaluated else "[yellow]not evaluated[/]"
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


def differences_table(rows: list[Difference], out: Console) -> Table:
    """Return signals that differ between two runs as a table."""
    table = result_table(out, ("signal", "largest", "tolerance", "at", "first exceedance", ""), ("signal", ""))
    for row in rows:
        largest = "" if row.largest is None else precise(row.largest, row.unit)
        times = ["" if t is None else f"{t:.3f} s" for t in (row.t_largest, row.first)]
        table.add_row(row.signal, largest, precise(row.allowed, row.unit), *times, row.note)
    return table
