"""A reproduction as a table for people."""

from pathlib import Path

from rich.markup import escape

from orchestrator.inputs.text.console import console, result_table
from orchestrator.studies.papers.result import OWN, Reproduction, Row


def print_reproduction(result: Reproduction, out: Path) -> None:
    """Print title, rows, notes and where the pictures are."""
    to = console()
    to.print(f"[bold]{result.paper}[/]  {escape(result.title)}")
    texts = ("run", "quantity", "", "check of")
    table = result_table(to, ("run", "quantity", "printed", "here", "difference", "allowed", "", "check of"), texts)
    last = None
    for row in result.rows:
        if last is not None and row.run != last:
            table.add_section()
        table.add_row(row.run if row.run != last else "", *_cells(row))
        last = row.run
    to.print(table)
    for note in result.notes:
        to.print(f"- {escape(note)}")
    for why in dict.fromkeys(row.differs for row in result.rows if row.differs):
        items = ", ".join(dict.fromkeys(f"{row.run} {row.item}" for row in result.rows if row.differs == why))
        to.print(f"- differs: {escape(items)}: {escape(why)}")
    for why in dict.fromkeys(row.untestable for row in result.rows if row.untestable):
        items = ", ".join(f"{row.run} {row.item}".strip() for row in result.rows if row.untestable == why)
        to.print(f"- cannot be tested: {escape(items)}: {escape(why)}")
    to.print(f"{_verdict(result)}; pictures and result.json in {out}")


def _verdict(result: Reproduction) -> str:
    held = "[bold green]every stated check holds[/]" if result.passed else "[bold red]not every stated check holds[/]"
    if not any(row.basis for row in result.rows):
        return held
    tally = result.tally
    unknown = sum(row.basis != OWN and row.as_expected is False for row in result.rows)
    text = f"agrees {tally.agrees}, differs {tally.differs}, cannot be tested {tally.untestable}"
    surprise = f" [bold red]({unknown} not as known)[/]" if unknown else ""
    return f"[bold]{text}[/]{surprise}; own checks {tally.own_held} of {tally.own}"


def _cells(row: Row) -> list[str]:
    mark = {True: "[green]pass[/]", False: "[red]FAIL[/]", None: ""}[row.passed]
    if row.differs:
        mark = "[yellow]differs[/]" if row.as_expected else "[red]AGREES[/]"
    if row.untestable:
        mark = "not tested"
    allowed = "" if row.limit is None or isinstance(row.ours, str) else f"± {_number(row.limit, row.unit)}"
    difference = "" if row.difference is None else f"{row.difference:+.4g}"
    item = escape(row.item + (f" ({row.note})" if row.note else ""))
    return [item, _number(row.paper, row.unit), _number(row.ours, row.unit), difference, allowed, mark, row.basis]


def _number(value: float | str | None, unit: str) -> str:
    if value is None:
        return "-"
    if isinstance(value, str):
        return escape(value)
    return f"{value:.4g}" if unit in ("", "1") else f"{value:.4g} {unit}"
