"""A recording as the data of a page: thinned signals, paths, surroundings, parameters, provenance."""

from typing import Any

import numpy as np

from modelkit.variables import Variable, variables
from orchestrator.inputs.scenario.models import models_for
from orchestrator.presentation.drawing.decimation import MAX_STEP_ROWS, deviation
from orchestrator.presentation.drawing.panels import MODES, REFERENCES
from orchestrator.presentation.log.line import Line
from orchestrator.presentation.report.payload import Arrays
from orchestrator.presentation.report.plans import MOST_PLANS, plans_of
from orchestrator.presentation.report.plots import changes
from orchestrator.presentation.report.still import Point, origin_of, still_of
from orchestrator.presentation.report.thinning import thin
from orchestrator.simulation.cosim.recording import Recording

CHART = "controller.phase"
MOST_RIBBONS = 7
ASKED = frozenset(name.partition(".")[2] for name in REFERENCES)
"""Names, without their instance, of requests: an output and the input it feeds are one curve."""

ROWS_PER_PLAN = 40
"""A page of fewer rows has fewer plans, too: one for so many rows."""


def run_data(
    recording: Recording,
    arrays: Arrays,
    words: list[Line],
    *,
    label: str,
    most: int,
    keep: list[float],
    origin: Point | None = None,
    whole: Recording | None = None,
) -> dict[str, Any]:
    """Return one run for the page; its arrays go to ``arrays``. Rows at the times ``keep`` [s] stay.

    ``whole``: the long recording of which ``recording`` has some instants only.
    """
    t = recording.t
    curves = [name for name in recording.signals if not _is_held(recording.variables[name])]
    lines = [recording.signals[name] for name in curves]
    steps = [values for name, values in recording.signals.items() if _is_held(recording.variables[name])]
    steps = [values for values in steps if whole is None or (values[1:] != values[:-1]).sum() <= MAX_STEP_ROWS // 2]
    rows = [int(np.clip(np.searchsorted(t, moment), 0, len(t) - 1)) for moment in keep]
    thinned = thin(t, lines, steps, rows, most)
    origin = origin or origin_of(recording)
    off = thinned.deviation if whole is None else deviation(whole, recording.rows(thinned.rows), curves)
    return {
        "label": label,
        "time": arrays.add(t[thinned.rows]),
        "rows": [len(thinned.rows), len(t) if whole is None else whole.count, off],
        "signals": {name: _signal(recording, name, thinned.rows, arrays) for name in recording.signals},
        "plans": plans_of(recording, arrays, origin, min(MOST_PLANS, max(2, most // ROWS_PER_PLAN))),
        "scene": still_of(recording, origin),
        "chart": CHART if CHART in recording.signals else None,
        "log": [line._asdict() for line in words],
        "parameters": _parameters(recording),
        "provenance": _provenance(recording),
    }


def ribbons_of(recordings: list[Recording], most: int = MOST_RIBBONS) -> list[str]:
    """Return the modes that make ribbons: the chart first, then all others that change, each once."""
    names = [name for item in recordings for name in item.signals if item.states(name)]
    chosen: dict[str, str] = {}
    for name in [*(name for name in MODES if name in names), *names]:
        short = name.partition(".")[2]
        if short not in chosen and (name == CHART or any(changes(item, name) for item in recordings)):
            chosen[short] = name
    return list(chosen.values())[:most]


def _is_held(variable: Variable) -> bool:
    return variable.kind is not float


def _signal(recording: Recording, name: str, rows: np.ndarray[Any, Any], arrays: Arrays) -> dict[str, Any]:
    variable, values = recording.variables[name], recording.signals[name]
    result: dict[str, Any] = {"unit": variable.signal.unit, "text": variable.signal.text}
    if _is_held(variable):
        result["held"] = True
    if variable.signal.unit == "rad" and name.endswith("heading"):
        result["turn"] = True
    if name.partition(".")[2] in ASKED:
        result["asked"] = True
    if recording.states(name):
        result["states"] = recording.states(name)
    if len(values) and np.isfinite(values[0]) and (values == values[0]).all():
        return {**result, "c": float(values[0])}
    finite = values[np.isfinite(values)]
    offset = (
        0.0 if not len(finite) or np.abs(finite).max() < 1e3 else float(np.round(0.5 * (finite.min() + finite.max())))
    )
    return {**result, "o": offset, "a": arrays.add(values[rows] - offset)}


def _parameters(recording: Recording) -> list[dict[str, Any]]:
    """Return every parameter with its value, and whether it differs from the default."""
    models = models_for(recording.info.get("scenario", {}).get("controller", {}))
    starts = {
        f"{owner}.{item.name}": float(item.start) for owner, model in models.items() for item in variables(model.params)
    }
    rows = []
    for name, value in recording.parameters.items():
        signal, states = recording.variables[name].signal, recording.states(name)
        changed = name in starts and value != starts[name]
        state = states.get(int(value)) if np.isfinite(value) else None
        rows.append(
            {"name": name, "value": value, "unit": signal.unit, "text": signal.text, "state": state, "changed": changed}
        )
    return rows


def _provenance(recording: Recording) -> list[list[str]]:
    """Return the run's provenance as lines of key and text."""
    lines: list[list[str]] = []
    for key, value in recording.info.items():
        _flatten(str(key), value, lines)
    return lines


def _flatten(key: str, value: Any, lines: list[list[str]]) -> None:
    if isinstance(value, dict) and value:
        for name, item in value.items():
            _flatten(f"{key}.{name}", item, lines)
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for number, item in enumerate(value, start=1):
            _flatten(f"{key}[{number}]", item, lines)
    elif value not in (None, "", [], {}):
        lines.append([key, str(value)])
