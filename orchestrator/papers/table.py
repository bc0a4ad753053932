"""A reproduction as a table for people."""

from pathlib import Path

from rich.markup import escape
from rich.table import Table

from orchestrator.papers.result import Reproduction, Row
from orchestrator.text.console import console


def print_reproduction(result: Reproduction, out: Path) -> None:
    """Print title, rows, notes and where the pictures are."""
    to = console()
    to.print(f"[bold]{result.paper}[/]  {escape(result.title)}")
    table = Table(box=None if not to.is_terminal else Table().box, pad_edge=to.is_terminal)
    for name in ("run", "quantity", "printed", "here", "difference", "allowed", ""):
        table.add_column(name, justify="left" if name in ("run", "quantity", "") else "right")
    last = None
    for row in result.rows:
        if last is not None and row.run != last:
            table.add_section()
        table.add_row(row.run if row.run != last else "", *_cells(row))
        last = row.run
    to.print(table)
    for note in result.notes:
        to.print(f"- {escape(note)}")
    verdict = (
        "[bold green]every stated check holds[/]" if result.passed else "[bold red]not every stated check holds[/]"
    )
    to.print(f"{verdict}; pictures and result.json in {out}")


def _cells(row: Row) -> list[str]:
    mark = {True: "[green]pass[/]", False: "[red]MISS[/]", None: ""}[row.passed]
    allowed = "" if row.limit is None or row.difference is None else f"± {_number(row.limit, row.unit)}"
    difference = "" if row.difference is None else f"{row.difference:+.4g}"
    item = escape(row.item + (f" ({row.note})" if row.note else ""))
    return [item, _number(row.paper, row.unit), _number(row.ours, row.unit), difference, allowed, mark]


def _number(value: float | str | None, unit: str) -> str:
    if value is None:
        return "-"
    if isinstance(value, str):
        return escape(value)
    return f"{value:.4g}" if unit in ("", "1") else f"{value:.4g} {unit}"
