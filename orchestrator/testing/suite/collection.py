"""One page over many runs: a small picture, the verdict and a link to the replay of each."""

import html
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fmus.files import write_whole
from orchestrator.evaluation.verdict.geometry import CarOutline, place, slot_box, vehicle_parameters
from orchestrator.inputs.scenario.scenario import SUCCESS, Scenario
from orchestrator.inputs.text.readable import changes_text, manoeuvres_text
from orchestrator.presentation.report.page import still_page
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.testing.suite.suite import SuiteResult

BODY = """<header class="top"><div class="headline"><h1>{title}</h1></div>
<span class="verdict {kind}">{verdict}</span></header>
<main><dl class="card about">{facts}</dl>
<div class="runs">
{cards}
</div></main>
"""
CARD = """<article class="card run {kind}">
<a href="{link}" class="picture" aria-label="Replay of {name}">{picture}</a>
<div class="words"><h2><a href="{link}">{name}</a> <span class="pill {kind}">{verdict}</span></h2>
<p>{title}</p><p class="soft">{outcome}</p>{missed}</div>
</article>"""
WIDTH, HEIGHT = 300.0, 150.0


def write_collection(path: Path, tested: list[SuiteResult], about: Mapping[str, str]) -> None:
    """Write the page; failures come first. ``about`` says what was tested, when and how."""
    passed = sum(item.passed for item in tested)
    kind = "good" if passed == len(tested) else "bad"
    cards = "\n".join(_card(item) for item in sorted(tested, key=lambda item: item.passed))
    title = "Scenarios tested"
    facts = "".join(f"<dt>{html.escape(key)}</dt><dd>{html.escape(text)}</dd>" for key, text in about.items())
    body = BODY.format(title=title, facts=facts, verdict=f"{passed} of {len(tested)} passed", kind=kind, cards=cards)
    write_whole(path, still_page(title, body))


def _card(item: SuiteResult) -> str:
    name = item.scenario.name
    missed = [f"{case.name}: {case.text}" for case in item.cases if not case.passed and not case.skipped]
    missed += [item.error] if item.error else []
    summary, changes = item.summary, changes_text(item.scenario.overrides)
    outcome = ""
    if summary:
        outcome = f"{summary.outcome.replace('_', ' ')}{_expectation_text(item, summary.outcome)}"
        outcome += f", {summary.duration:.1f} s, {manoeuvres_text(summary.manoeuvres)}"
    return CARD.format(
        kind="good" if item.passed else "bad",
        verdict="not run" if item.could_not_run else "pass" if item.passed else "fail",
        link=html.escape(f"{name}/report.html"),
        name=html.escape(name),
        title=html.escape(item.scenario.title + (f" - with {changes}" if changes else "")),
        outcome=html.escape(outcome),
        picture=picture(item.recording, item.scenario) if item.recording is not None else "",
        missed="".join(f'<p class="missed">{html.escape(text)}</p>' for text in missed),
    )


def _expectation_text(item: SuiteResult, outcome: str) -> str:
    """Return what the scenario expects, where the outcome alone does not say why the test passed or failed."""
    scenario = item.scenario
    wanted = scenario.expected_outcome or SUCCESS[scenario.task]
    if outcome == wanted:
        return "" if outcome == SUCCESS[scenario.task] else " as expected"
    return "" if item.passed else f" (expected: {wanted.replace('_', ' ')})"


def picture(recording: Recording, scenario: Scenario) -> str:
    """Return a small SVG: slot, driven path, car at start and end, turned so that the target points right."""
    x, y, heading = (recording.signals.get(f"vehicle.pose.{axis}", np.zeros(1)) for axis in ("x", "y", "heading"))
    good = np.isfinite(x) & np.isfinite(y) & np.isfinite(heading)
    if not good.any():
        return ""
    x, y, heading = x[good], y[good], heading[good]
    target = scenario.target.pose if scenario.target is not None else (0.0, 0.0, 0.0)
    car = CarOutline.of(vehicle_parameters(scenario, recording.parameters_of("vehicle"))).outline()
    rows = np.unique(np.linspace(0, len(x) - 1, 160).astype(int))
    shapes: list[tuple[str, Array]] = []
    if scenario.slot is not None:
        shapes.append(("slot", slot_box(scenario.slot).outline()))
    shapes += [("start", place(car, x[0], y[0], heading[0])), ("way", np.column_stack([x, y])[rows])]
    shapes.append(("end", place(car, x[-1], y[-1], heading[-1])))
    return _svg([(kind, place(points - points_origin(target), 0.0, 0.0, -target[2])) for kind, points in shapes])


def points_origin(target: tuple[float, float, float]) -> Array:
    """Return the target's position, (2,) [m]."""
    return np.array(target[:2])


def _svg(shapes: list[tuple[str, Array]]) -> str:
    everything = np.vstack([points for _, points in shapes])
    low, high = everything.min(axis=0), everything.max(axis=0)
    scale = min((WIDTH - 16.0) / max(high[0] - low[0], 1e-3), (HEIGHT - 16.0) / max(high[1] - low[1], 1e-3))
    middle = 0.5 * (low + high)
    lines = []
    for kind, points in shapes:
        px = WIDTH / 2 + (points[:, 0] - middle[0]) * scale
        py = HEIGHT / 2 - (points[:, 1] - middle[1]) * scale
        text = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(px, py, strict=True) if math.isfinite(a + b))
        lines.append(f'<polyline class="{kind}" points="{text}"/>')
    return f'<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" aria-hidden="true">{"".join(lines)}</svg>'
