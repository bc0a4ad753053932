"""State machines as pages show them beside a run: a drawing, and what is known of each state."""

import inspect
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import controller_fmu
from modelkit.model import Chart, Model
from orchestrator.inputs.scenario.catalogue import texts_of
from orchestrator.inputs.scenario.models import APART, MODELS
from orchestrator.presentation.drawing.chart_svg import chart_svg
from orchestrator.simulation.cosim.recording import Recording

ROOT = Path(__file__).parents[3]
ANY = "any state"
CHOICE = "system"
"""The parameter of the controller that chooses its system."""


ChartData = tuple[Chart, dict[str, Any]]
"""A chart, with what a page is given of it and the values that choose its system."""


def charts_of_models(models: Sequence[Model]) -> list[ChartData]:
    """Return the charts of these models alone; other controllers are not imported."""
    own = [chart for model in models for chart in model.all_charts() if chart.signal]
    known = _system_charts()
    if any(chart not in [item for _, item in known] for chart in own):
        known = [*known, *_standalone_charts()]
    return [_data(values, chart) for values, chart in known if chart in own]


def charts_of(recording: Recording) -> list[dict[str, Any]]:
    """Return the charts of the system that a recorded run was made with; none for a third-party controller."""
    system = recording.parameters.get(f"controller.{CHOICE}")
    known = _standalone_charts() if system in [int(choice) for choice in APART.values()] else _system_charts()
    return [
        _data(values, chart)[1]
        for values, chart in known
        if system in values and f"controller.{chart.signal}" in recording.signals
    ]


def _system_charts() -> list[tuple[list[int], Chart]]:
    """Return the charts of the systems that share a model, with the values that choose them."""
    return [
        (list(system.values), chart)
        for model in MODELS.values()
        if model.systems is not None
        for system in model.systems.systems
        for chart in system.charts
        if chart.signal
    ]


@cache
def _standalone_charts() -> list[tuple[list[int], Chart]]:
    """Return the charts of the controllers that are models of their own; imports all of them."""
    found: dict[int, tuple[list[int], Chart]] = {}
    for choice in APART.values():
        for chart in controller_fmu.APART[choice].charts:
            found.setdefault(id(chart.rows), ([], chart))[0].append(int(choice))
    return [item for item in found.values() if item[1].signal]


def _data(values: list[int], chart: Chart) -> ChartData:
    return chart, {"values": list(values), **_chart(chart)}


@cache
def _chart(chart: Chart) -> dict[str, Any]:
    names = [state.name for state in chart.states]
    arcs = [(_name(chart, row[0]), _words(chart, row[1]), _name(chart, row[2])) for row in chart.rows]
    states, guards = texts_of(chart.states), texts_of(chart.guards)
    return {
        "signal": chart.signal,
        "file": _where(chart.guards),
        "svg": chart_svg([(source, target, guard) for source, guard, target in arcs], names),
        "states": {name: _sentence(states.get(name, "")) for name in (*names, ANY)},
        "guards": {
            guard.value: [_words(chart, guard), guards.get(guard.name, "").rstrip(".").lower()]
            for guard in chart.guards
        },
        "rows": [[_name(chart, row[0]), row[1], _name(chart, row[2])] for row in chart.rows],
    }


def _name(chart: Chart, value: int) -> str:
    return chart.states(value).name if value >= 0 else ANY


def _words(chart: Chart, guard: int) -> str:
    return chart.guards(guard).name.lower().replace("_", " ")


def _sentence(text: str) -> str:
    return text if not text or text.endswith(".") else f"{text}."


def _where(cls: type[Any]) -> str:
    """Return the file in which the chart of these guards is written, and the line of its table."""
    file = Path(inspect.getsourcefile(cls) or "")
    lines = file.read_text(encoding="utf-8").splitlines()
    line = next((number for number, text in enumerate(lines, start=1) if text.startswith("TRANSITIONS")), 1)
    return f"{file.relative_to(ROOT).as_posix()}:{line}"
