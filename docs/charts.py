"""Hook of mkdocs: state charts are drawn here, by ``chart_svg``, so that no page asks anyone for a library.

A page has a chart as Mermaid source, which the repository's own pages show, or as a mark
``<!-- chart: controller_fmu.guo2015.chart -->`` for the table of that module.
"""

import importlib
import re
import sys
from pathlib import Path
from typing import Any

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parent.parent)]

from generate import enums_of, label  # noqa: E402

from orchestrator.presentation.drawing.chart_svg import Arc, chart_svg  # noqa: E402

MERMAID = re.compile(r"^```mermaid\nstateDiagram-v2\n(.*?)^```\n", re.S | re.M)
ARC = re.compile(r"^\s*(\w+) --> (\w+): (\w+)\s*$", re.M)
MARK = re.compile(r"^<!-- chart: ([\w.]+) -->$", re.M)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Return the page with its charts drawn."""
    drawn = MERMAID.sub(lambda match: _drawn([_arc(*found) for found in ARC.findall(match[1])], []), markdown)
    return MARK.sub(lambda match: chart_of(match[1]), drawn)


def chart_of(name: str) -> str:
    """Return the chart of a module that holds a transition table."""
    module = importlib.import_module(name)
    states, guards = enums_of(module)
    rows = [_arc(label(states, row[0]), label(states, row[2]), guards(row[1]).name) for row in module.TRANSITIONS]
    return _drawn(rows, [item.name for item in states])


def _arc(source: str, target: str, guard: str) -> Arc:
    return source, target, guard.lower().replace("_", " ")


def _drawn(arcs: list[Arc], order: list[str]) -> str:
    return f"{chart_svg(arcs, order)}\n"
