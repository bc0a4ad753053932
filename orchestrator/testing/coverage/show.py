"""Coverage for people and machines: tables, a page with the charts drawn and the branches not seen, JSON."""

import html
import json
from pathlib import Path
from typing import Any

from rich.table import Table

from fmus.files import write_whole
from orchestrator.presentation.drawing.chart_svg import chart_svg
from orchestrator.presentation.report.page import still_page
from orchestrator.testing.coverage.branches import Branch, branch_share
from orchestrator.testing.coverage.coverage import Coverage
from orchestrator.testing.coverage.covered import ChartCoverage, RowCoverage, share

ROOT = Path(__file__).parents[3]
STYLE = """
.sheet { padding: 1rem; margin: 1rem 0; overflow-x: auto; } .sheet svg { max-width: 100%; height: auto; }
.rows { border-collapse: collapse; } .rows td, .rows th { padding: .2rem .8rem .2rem 0; text-align: left; }
.missed td { color: var(--bad); } .half td { color: var(--warn); }
"""
HEAD = """<header class="top"><div class="headline"><h1>Coverage of charts and code</h1></div>
<span class="verdict {kind}">{share:.0f} % of the transitions</span>
<span class="verdict {branch_kind}">{branch_share:.0f} % of the branches</span></header>
<p class="quiet">Red: never taken, or never visited. Orange: its guard was never false while it decided,
or it is in no list. Of a third-party FMU only a mode is seen.</p>
"""


def coverage_tables(found: Coverage) -> list[Table]:
    """Return a table with a row for each chart, and one with a row for each folder of model code that ran."""
    charts = _table("chart", "states", "transitions", "guard outcomes")
    for chart in found.charts:
        counts = (
            f"{chart.count_visited} of {len(chart.states)}",
            f"{chart.count_taken} of {len(chart.rows)}"
            if chart.is_listed
            else f"{chart.count_taken} seen, none listed",
            f"{chart.outcomes} of {2 * len(chart.rows)}" if chart.has_guards else "not known",
        )
        charts.add_row(f"{chart.name} ({chart.signal})" if chart.signal else chart.name, *counts)
        for row in chart.beside:
            charts.add_row(f"  not listed: {row.words}", "", str(row.taken), "")
    folders = _table("model code", "branches", "outcomes")
    for folder, branches in _by_folder(found.branches).items():
        seen = sum(branch.outcomes for branch in branches)
        folders.add_row(folder, f"{len(branches)}", f"{seen} of {2 * len(branches)}")
    return [charts, folders]


def as_json(found: Coverage) -> dict[str, Any]:
    """Return the coverage as plain data."""
    charts = [
        {**chart._asdict(), **{key: [row._asdict() for row in getattr(chart, key)] for key in ("rows", "beside")}}
        for chart in found.charts
    ]
    branches = [{**branch._asdict(), "file": _short(branch.file)} for branch in found.branches]
    return {
        "transition_coverage": share(found.charts),
        "branch_coverage": branch_share(found.branches),
        "charts": charts,
        "branches": branches,
    }


def write_coverage(folder: Path, found: Coverage) -> Path:
    """Write coverage.html and coverage.json; return the page."""
    write_whole(folder / "coverage.json", json.dumps(as_json(found), indent=2) + "\n")
    parts = found.transitions_percent, found.branches_percent
    kinds = ["good" if part == 100.0 else "warn" for part in parts]
    head = HEAD.format(kind=kinds[0], share=parts[0], branch_kind=kinds[1], branch_share=parts[1])
    sheets = "".join(map(_chart, found.charts)) + "".join(_sheet(*item) for item in _by_folder(found.branches).items())
    page = folder / "coverage.html"
    write_whole(page, still_page("Coverage of charts and code", head + sheets, STYLE))
    return page


def _table(*names: str) -> Table:
    table = Table(box=None)
    for number, name in enumerate(names):
        table.add_column(name, justify="right" if number else "left")
    return table


def _by_folder(branches: list[Branch]) -> dict[str, list[Branch]]:
    """Return folder -> its branches."""
    folders: dict[str, list[Branch]] = {}
    for branch in branches:
        folders.setdefault(_short(branch.file.parent), []).append(branch)
    return folders


def _short(path: Path) -> str:
    """Return a path as seen from the folder that the checkout, or the user, is in."""
    for folder in (ROOT, Path.cwd()):
        if path.is_relative_to(folder):
            return path.relative_to(folder).as_posix()
    return path.as_posix()


def _sheet(folder: str, branches: list[Branch]) -> str:
    """Return what of a folder's branches was not seen, as a table."""
    seen = sum(branch.outcomes for branch in branches)
    counts = f"{seen} of {2 * len(branches)} outcomes of {len(branches)} decisions and conditions"
    rows = "".join(_missing(branch) for branch in branches if branch.missing)
    head = "<tr><th>where</th><th>decides on</th><th></th></tr>" if rows else ""
    return (
        f'<article class="card sheet"><h2>{html.escape(folder)}</h2><p>{counts}</p>'
        f'<table class="rows">{head}{rows}</table></article>'
    )


def _missing(branch: Branch) -> str:
    kind = "half" if branch.outcomes else "missed"
    return (
        f'<tr class="{kind}"><td>{html.escape(branch.file.name)}:{branch.line}</td>'
        f"<td><code>{html.escape(branch.text)}</code></td><td>{branch.missing}</td></tr>"
    )


def _chart(chart: ChartCoverage) -> str:
    arcs = [(row.source, row.target, row.guard.lower().replace("_", " ")) for row in chart.rows]
    arcs += [(row.source, row.target, "not listed") for row in chart.beside]
    missed = {(row.source, row.target) for row in chart.rows if not row.taken}
    unvisited = {name for name, count in chart.states.items() if not count}
    svg = chart_svg(arcs, list(chart.states), missed, unvisited)
    transitions = (
        f"{chart.count_taken} of {len(chart.rows)} transitions"
        if chart.is_listed
        else f"{chart.count_taken} transitions"
    )
    counts = f"{chart.count_visited} of {len(chart.states)} states, {transitions}"
    rows = "".join(_row(row, chart.has_guards) for row in chart.rows)
    rows += "".join(_row(row, False, "not listed") for row in chart.beside)
    against = "<th>decided against</th>" if chart.has_guards else ""
    head = f"<tr><th>transition</th><th>taken</th>{against}</tr>"
    name = chart.name if chart.has_guards else f"{chart.name}: {chart.signal}"
    return (
        f'<article class="card sheet"><h2>{html.escape(name)}</h2><p>{counts}</p>{svg}'
        f'<table class="rows">{head}{rows}</table></article>'
    )


def _row(row: RowCoverage, has_guard: bool, note: str = "") -> str:
    kind = "missed" if not row.taken else "half" if note or (has_guard and not row.refused) else ""
    refused = f"<td>{row.refused}</td>" if has_guard else f"<td>{note}</td>"
    return f'<tr class="{kind}"><td>{html.escape(row.words)}</td><td>{row.taken}</td>{refused}</tr>'
