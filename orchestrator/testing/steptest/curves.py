"""The page of a step test: expectations with their verdicts, and the curves they are about, the miss marked."""

import html
import math
from pathlib import Path

import numpy as np

from fmus.files import write_whole
from orchestrator.evaluation.verdict.judge import Check
from orchestrator.evaluation.verdict.limit_text import sentence
from orchestrator.presentation.report.page import still_page
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.testing.steptest.step_test import StepTest

WIDTH, HEIGHT, LEFT, BOTTOM, TOP = 960.0, 170.0, 76.0, 24.0, 12.0
MOST_POINTS = 1500
STYLE = """
.sheet { padding: 1rem; margin: 1rem 0; }
.curve { display: block; margin: 0 0 1rem; } .curve svg { display: block; width: 100%; height: auto; }
.curve figcaption { font-weight: 600; }
.curve text { fill: currentColor; font-size: 12px; } .curve .frame { stroke: currentColor; opacity: .3; }
.curve .line { fill: none; stroke: var(--accent); stroke-width: 1.6; }
.curve .limit { stroke: var(--warn); stroke-dasharray: 5 4; }
.curve .miss { fill: var(--bad); } .curve .ok { fill: var(--good); }
.expected { width: 100%; border-collapse: collapse; }
.expected td { padding: .3rem .6rem .3rem 0; vertical-align: top; }
"""
BODY = """<header class="top"><div class="headline"><h1>{title}</h1></div>
<span class="verdict {kind}">{verdict}</span></header>
<main><article class="card sheet"><table class="expected">{rows}</table></article>
<article class="card sheet">{curves}</article></main>
"""


def write_curves(path: Path, test: StepTest, recording: Recording, checks: list[Check]) -> None:
    """Write the page of one test."""
    missed = sum(not check.passed for check in checks)
    title = test.title or test.name
    rows = "".join(_row(check) for check in sorted(checks, key=lambda item: item.passed))
    judged = [check.signal for check in checks if check.signal in recording.signals]
    asked = dict.fromkeys([*judged, *_stimuli(recording)])
    curves = "".join(_curve(name, recording, [check for check in checks if check.signal == name]) for name in asked)
    body = BODY.format(
        title=html.escape(title),
        kind="bad" if missed else "good",
        verdict=f"{len(checks) - missed} of {len(checks)} met",
        rows=rows,
        curves=curves,
    )
    write_whole(path, still_page(title, body, STYLE))


def _row(check: Check) -> str:
    word, kind = ("met", "good") if check.passed else ("missed", "bad")
    return (
        f'<tr><td><span class="pill {kind}">{word}</span></td><td>{html.escape(check.id)}</td>'
        f"<td>{html.escape(sentence(check))}</td></tr>"
    )


def _stimuli(recording: Recording) -> list[str]:
    """Return the inputs that change: they come after what is judged."""
    return [name for name, values in recording.signals.items() if np.nanmin(values) != np.nanmax(values)][:12]


def _curve(name: str, recording: Recording, checks: list[Check]) -> str:
    t, values = recording.t, recording.signals[name]
    limits = [check.limit for check in checks if check.condition != "max_abs" and _is_of(check, recording)]
    limits += [sign * check.limit for check in checks if check.condition == "max_abs" for sign in (-1.0, 1.0)]
    shown = np.concatenate([values[np.isfinite(values)], [limit for limit in limits if math.isfinite(limit)]])
    low, high = (float(shown.min()), float(shown.max())) if len(shown) else (0.0, 1.0)
    if low == high:
        low, high = low - 0.5, high + 0.5
    axis = _Axis(float(t[0]), float(max(t[-1], t[0] + 1e-9)), low, high)
    unit = recording.variables[name].signal.unit
    marks = "".join(_mark(check, axis) for check in checks if math.isfinite(check.value) and _is_of(check, recording))
    lines = "".join(f'<path class="limit" d="M{LEFT},{axis.y(v):.1f} H{WIDTH}"/>' for v in limits if math.isfinite(v))
    words = [
        (LEFT - 6, axis.y(high) + 4, "end", f"{high:.4g}"),
        (LEFT - 6, axis.y(low) + 4, "end", f"{low:.4g}"),
        (LEFT, HEIGHT - 6, "start", f"{t[0]:g} s"),
        (WIDTH, HEIGHT - 6, "end", f"{t[-1]:g} s"),
    ]
    texts = "".join(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{at}">{word}</text>' for x, y, at, word in words)
    label = f"{name} [{unit}]"
    return (
        f'<figure class="curve"><figcaption>{html.escape(label)}</figcaption>'
        f'<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" aria-label="{html.escape(label)}">'
        f'<path class="frame" fill="none" d="M{LEFT},{TOP} V{HEIGHT - BOTTOM} H{WIDTH}"/>{lines}'
        f'<path class="line" d="{_path(t, values, axis)}"/>{marks}{texts}</svg></figure>'
    )


class _Axis:
    """From seconds and values to the picture."""

    def __init__(self, first: float, last: float, low: float, high: float) -> None:
        self._first, self._last, self._low, self._high = first, last, low, high

    def x(self, t: float) -> float:
        return LEFT + (WIDTH - LEFT) * (t - self._first) / (self._last - self._first)

    def y(self, value: float) -> float:
        return TOP + (HEIGHT - BOTTOM - TOP) * (self._high - value) / (self._high - self._low)


def _is_of(check: Check, recording: Recording) -> bool:
    """Return whether a check's value is one of its signal, not a time or a share."""
    return check.unit == recording.variables[check.signal].signal.unit and check.source != "reference"


def _mark(check: Check, axis: _Axis) -> str:
    kind = "ok" if check.passed else "miss"
    text = html.escape(f"{check.id}: {sentence(check)}")
    place = f'cx="{axis.x(check.t):.1f}" cy="{axis.y(check.value):.1f}"'
    return f'<circle class="{kind}" {place} r="4"><title>{text}</title></circle>'


def _path(t: Array, values: Array, axis: _Axis) -> str:
    """Return the curve, thinned where it does not change."""
    changes = np.diff(values) != 0.0
    keep = np.concatenate(([True], changes)) | np.concatenate((changes, [True]))
    rows = np.flatnonzero(keep & np.isfinite(values))
    rows = rows[:: max(1, len(rows) // MOST_POINTS)]
    points = [f"{axis.x(float(t[row])):.1f},{axis.y(float(values[row])):.1f}" for row in rows]
    return "M" + " L".join(points) if points else ""
