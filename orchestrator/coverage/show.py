"""Coverage for people and machines: a table, a page with the charts drawn, JSON."""

import html
import json
from pathlib import Path
from typing import Any

from rich.table import Table

from orchestrator.coverage.covered import ChartCovered, RowCovered, share
from orchestrator.drawing.chart_svg import chart_svg
from orchestrator.report.page import still_page

STYLE = """
.sheet { padding: 1rem; margin: 1rem 0; overflow-x: auto; } .sheet svg { max-width: 100%; height: auto; }
.rows { border-collapse: collapse; } .rows td, .rows th { padding: .2rem .8rem .2rem 0; text-align: left; }
.missed td { color: var(--bad); } .half td { color: var(--warn); }
"""
HEAD = """<header class="top"><div class="headline"><h1>Coverage of the charts</h1></div>
<span class="verdict {kind}">{share:.0f} % of the transitions</span></header>
<p class="quiet">Red: never taken, or never visited. Orange: its guard was never false while it decided.</p>
"""


def coverage_table(charts: list[ChartCovered]) -> Table:
    """Return a table with a row for each chart."""
    table = Table(box=None)
    for name in ("chart", "states", "transitions", "guard outcomes"):
        table.add_column(name, justify="left" if name == "chart" else "right")
    for chart in charts:
        counts = (
            f"{chart.visited} of {len(chart.states)}",
            f"{chart.taken} of {len(chart.rows)}",
            f"{chart.outcomes} of {2 * len(chart.rows)}",
        )
        table.add_row(f"{chart.name} ({chart.signal})", *counts)
    return table


def as_json(charts: list[ChartCovered]) -> dict[str, Any]:
    """Return the coverage as plain data."""
    found = [{**chart._asdict(), "rows": [row._asdict() for row in chart.rows]} for chart in charts]
    return {"transition_coverage": share(charts), "charts": found}


def write_coverage(folder: Path, charts: list[ChartCovered]) -> Path:
    """Write coverage.html and coverage.json; return the page."""
    (folder / "coverage.json").write_text(json.dumps(as_json(charts), indent=2) + "\n", encoding="utf-8")
    part = share(charts)
    head = HEAD.format(kind="good" if part == 1.0 else "warn", share=100.0 * part)
    page = folder / "coverage.html"
    page.write_text(still_page("Coverage of the charts", head + "".join(map(_chart, charts)), STYLE), encoding="utf-8")
    return page


def _chart(chart: ChartCovered) -> str:
    arcs = [(row.source, row.target, row.guard.lower().replace("_", " ")) for row in chart.rows]
    missed = {(row.source, row.target) for row in chart.rows if not row.taken}
    unvisited = {name for name, count in chart.states.items() if not count}
    svg = chart_svg(arcs, list(chart.states), missed, unvisited)
    counts = f"{chart.visited} of {len(chart.states)} states, {chart.taken} of {len(chart.rows)} transitions"
    rows = "".join(_row(row) for row in chart.rows)
    head = "<tr><th>transition</th><th>taken</th><th>decided against</th></tr>"
    return (
        f'<article class="card sheet"><h2>{html.escape(chart.name)}</h2><p>{counts}</p>{svg}'
        f'<table class="rows">{head}{rows}</table></article>'
    )


def _row(row: RowCovered) -> str:
    kind = "missed" if not row.taken else "half" if not row.refused else ""
    return f'<tr class="{kind}"><td>{html.escape(row.words)}</td><td>{row.taken}</td><td>{row.refused}</td></tr>'
