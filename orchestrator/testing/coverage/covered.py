"""From what charts have decided on to what is covered.

A row of a chart is decided on when its source is the state and no row above it was taken. Each row has one condition:
a guard seen true and false while it decides is modified condition/decision coverage (MC/DC) of the row.
"""

from collections.abc import Sequence
from typing import NamedTuple

from modelkit.model import Chart
from orchestrator.testing.coverage.tracer import Seen, name_of


class RowCoverage(NamedTuple):
    """One transition."""

    source: str
    guard: str
    target: str
    taken: int
    """Samples at which it was taken: its guard true while it decides."""
    refused: int
    """Samples at which it could have been: its guard false while it decides."""

    @property
    def words(self) -> str:
        """The transition as people read it."""
        when = f" when {self.guard}" if self.guard else ""
        return f"{self.source} to {self.target}{when}".lower().replace("_", " ")


class ChartCoverage(NamedTuple):
    """One chart and how far the tests have been through it."""

    name: str
    signal: str
    """The output that tells its state."""
    states: dict[str, int]
    """State -> samples in it."""
    rows: list[RowCoverage]
    has_guards: bool = True
    """False: only its state is known, not what it decides on."""
    is_listed: bool = True
    """False: the rows are those seen; how many there are nobody says."""
    beside: Sequence[RowCoverage] = ()
    """Transitions seen that are not listed."""

    @property
    def count_visited(self) -> int:
        """States that were visited."""
        return sum(count > 0 for count in self.states.values())

    @property
    def count_taken(self) -> int:
        """Transitions that were taken."""
        return sum(row.taken > 0 for row in self.rows)

    @property
    def outcomes(self) -> int:
        """Of the two outcomes of each guard while it decides, those seen."""
        return self.count_taken + sum(row.refused > 0 for row in self.rows)


ANY = "any state"


def chart_coverage(chart: Chart, seen: Seen) -> ChartCoverage:
    """Return what of a chart is covered by what it has decided on."""
    ends = _ends(chart)
    taken, refused = [0] * len(chart.rows), [0] * len(chart.rows)
    states = dict.fromkeys(chart.states, 0)
    for (state, guards), count in seen.items():
        states[chart.states(state)] += count
        for number, row in enumerate(chart.rows):
            if row[0] != state and (row[0] >= 0 or state in ends):
                continue
            if guards >> row[1] & 1:
                taken[number] += count
                states[chart.states(row[2])] += 1
                break
            refused[number] += count
    names = [(_name(chart, row[0]), chart.guards(row[1]).name, _name(chart, row[2])) for row in chart.rows]
    rows = [RowCoverage(*row, yes, no) for row, yes, no in zip(names, taken, refused, strict=True)]
    counts = {state.name: count for state, count in states.items()}
    return ChartCoverage(name_of(chart), chart.signal, counts, rows)


def _ends(chart: Chart) -> set[int]:
    """Return the states that no row leaves by name: rows for any state do not leave them."""
    return {int(state) for state in chart.states} - {row[0] for row in chart.rows}


def _name(chart: Chart, value: int) -> str:
    return chart.states(value).name if value >= 0 else ANY


def share(charts: list[ChartCoverage]) -> float:
    """Return the share of the transitions that were taken, of all charts that list theirs together; 1 without any."""
    listed = [chart for chart in charts if chart.is_listed]
    count = sum(len(chart.rows) for chart in listed)
    return sum(chart.count_taken for chart in listed) / count if count else 1.0
