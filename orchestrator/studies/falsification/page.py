"""Output of a falsification: lines on the screen, JSON, and one HTML file without scripts."""

import html
import json
from pathlib import Path
from typing import Any

from fmus.files import write_whole
from orchestrator.presentation.report.page import still_page
from orchestrator.studies.falsification.counterexamples import Counterexample, factors_of
from orchestrator.studies.falsification.falsify import FalsificationResult
from orchestrator.studies.falsification.sensitivity import Index
from orchestrator.studies.falsification.subject import Subject
from orchestrator.studies.sweep.page.page import card, html_table, study_style
from orchestrator.studies.sweep.study.space import Factor

BODY = """<header class="top"><div class="headline"><h1>{title}</h1><p id="subtitle">{subtitle}</p></div>
<span class="verdict {kind}">{verdict}</span></header>
<main class="study">{cards}</main>
<footer>Evidence about these models over the stated ranges, not about a car.</footer>
"""
SHOWN_FACTORS = 20
"""Factors in the table of influences."""
escape = html.escape


def as_json(subject: Subject, result: FalsificationResult) -> dict[str, Any]:
    """Return all that was found as plain data."""
    return {
        "study": subject.study.name,
        "requirement": subject.objective.name,
        "runs": result.runs,
        "broken": result.broken,
        "first_after": result.first_after,
        "independent": {"runs": result.sample[1], "broken": result.sample[0]},
        "probability": {"above": result.bound[0], "below": result.bound[1], "confidence": 0.95},
        "subset_simulation": None if result.rare is None else result.rare._asdict(),
        "influences": [
            {
                "factor": item.name,
                "first": None if item.first is None else item.first._asdict(),
                "total": None if item.total is None else item.total._asdict(),
            }
            for item in result.influences
        ],
        "counterexamples": [_counterexample(subject, counterexample) for counterexample in result.counterexamples],
    }


def _counterexample(subject: Subject, counterexample: Counterexample) -> dict[str, Any]:
    return {
        "name": counterexample.name,
        "file": f"counterexamples/{counterexample.name}.yaml",
        "words": counterexample.run.words,
        "margin": counterexample.run.margin,
        "seed": counterexample.run.seed,
        "other_seeds": counterexample.chance,
        "factors": factors_of(subject, counterexample),
    }


def counterexamples_text(subject: Subject, result: FalsificationResult) -> list[str]:
    """Return a line for each counterexample, with what it needs."""
    lines = [] if result.first_after is None else [f"first after {result.first_after} runs"]
    for counterexample in result.counterexamples:
        needs = "; ".join(f"{name} {_value(item)}" for name, item in factors_of(subject, counterexample).items())
        often = f"{100.0 * counterexample.chance:.0f} % of other seeds"
        lines.append(
            f"{counterexample.name}: {counterexample.run.words} ({often}). Needs {needs or 'nothing but its seed'}"
        )
    return lines


def bound_text(result: FalsificationResult) -> list[str]:
    """Return what the runs prove."""
    events, count = result.sample
    low, high = result.bound
    lines = [f"{events} of {count} independent runs break it: probability {_between(low, high)} (95 % each, exact)"]
    if result.rare is not None and result.rare.is_bound:
        lines.append(
            f"subset simulation, {result.rare.runs} runs: not reached, about {result.rare.probability:.2g} or less"
        )
    elif result.rare is not None:
        rare = result.rare
        interval = f"95 % {rare.low:.2g} to {rare.high:.2g}"
        lines.append(f"subset simulation, {rare.runs} runs: probability {rare.probability:.2g}, {interval}")
    return lines


def _between(low: float, high: float) -> str:
    return f"below {high:.2g}" if low == 0.0 else f"{low:.2g} to {high:.2g}"


def _value(item: dict[str, Any]) -> str:
    value, nominal = item["value"], item["nominal"]
    if isinstance(value, str):
        return f"{value} (not {nominal})"
    unit = "" if item["unit"] == "1" else f" {item['unit']}"
    return f"{value:.3g}{unit} ({nominal:.3g})"


def write_page(subject: Subject, result: FalsificationResult, out: Path) -> Path:
    """Write ``falsify.html`` and ``falsify.json`` into ``out``; return the page's path."""
    write_whole(out / "falsify.json", json.dumps(as_json(subject, result), indent=2) + "\n")
    page = out / "falsify.html"
    cards = [_counterexamples(subject, result), _bounds(result), _influences(result), _ranges(subject)]
    body = BODY.format(
        title=f"Falsification of {escape(subject.study.name)}",
        subtitle=escape(f"Requirement: {subject.objective.text}. {result.runs} runs."),
        kind="bad" if result.broken else "good",
        verdict=f"{result.broken} runs break it" if result.broken else "nothing found",
        cards="".join(cards),
    )
    write_whole(page, still_page(f"Falsification of {subject.study.name}", body, study_style()))
    return page


def _counterexamples(subject: Subject, result: FalsificationResult) -> str:
    rows = []
    for counterexample in result.counterexamples:
        needs = "<br>".join(
            f"<code>{escape(name)}</code> {escape(_value(item))} <span class='quiet'>{escape(str(item['text']))}</span>"
            for name, item in factors_of(subject, counterexample).items()
        )
        command = f'<a href="counterexamples/{escape(counterexample.name)}.yaml">{escape(counterexample.name)}.yaml</a>'
        rows.append(
            (
                command,
                escape(counterexample.run.words.replace("_", " ")),
                needs or "nothing",
                f"{100.0 * counterexample.chance:.0f} %",
            )
        )
    text = "Each with the fewest and smallest disturbances (in brackets: nominal). Run one: "
    text += "<code>apa run counterexamples/NAME.yaml</code>; the same bits as when it was found."
    heads = ("scenario", "what happens", "what it needs", "of other seeds")
    return card("Finds", text if rows else "None.", html_table(heads, rows) if rows else "")


def _bounds(result: FalsificationResult) -> str:
    text = "<br>".join(escape(line) for line in bound_text(result))
    return card("Probability of violation", text)


def _influences(result: FalsificationResult) -> str:
    rows = [
        (f"<code>{escape(item.name)}</code>", _index(item.first), _index(item.total))
        for item in result.influences[:SHOWN_FACTORS]
    ]
    rows += [
        (escape(item.name), _index(item.first), _index(item.total))
        for item in result.influences[SHOWN_FACTORS:]
        if item.first is None
    ]
    text = (
        "Sobol indices of the margin with 95 % intervals: the share of its variance that goes with a factor alone "
        "(first), and with all that it has a part in (total)."
    )
    return card("Sensitivity", text, html_table(("factor", "first", "total"), rows))


def _index(index: Index | None) -> str:
    return "" if index is None else f"{index.value:.2f} <span class='quiet'>{index.low:.2f} to {index.high:.2f}</span>"


def _ranges(subject: Subject) -> str:
    rows = [
        (
            f"<code>{escape(item.name)}</code>",
            (", ".join(dict.fromkeys(item.choices)) if item.choices else f"{item.low:.4g} to {item.high:.4g}")
            + _unit(item),
            (item.choices[int(item.nominal)] if item.choices else f"{item.nominal:.4g}") + _unit(item),
            escape(item.text),
        )
        for item in subject.space.factors
    ]
    return card("Ranges", "", html_table(("factor", "range", "nominal", ""), rows))


def _unit(factor: Factor) -> str:
    return "" if factor.unit in ("", "1") else f" {escape(factor.unit)}"
