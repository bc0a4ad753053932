"""What a hunt says: lines on the screen, JSON, and one HTML file without scripts."""

import html
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from fmus.files import write_whole
from orchestrator.hunt.finds import Find, factors_of
from orchestrator.hunt.hunt import Hunted
from orchestrator.hunt.influence import Index
from orchestrator.hunt.subject import Subject
from orchestrator.report.page import still_page
from orchestrator.sweep.page.page import study_style
from orchestrator.sweep.study.space import Factor

BODY = """<header class="top"><div class="headline"><h1>{title}</h1><p id="subtitle">{subtitle}</p></div>
<span class="verdict {kind}">{verdict}</span></header>
<main class="study">{cards}</main>
<footer>Evidence about these models over the stated ranges, not about a car.</footer>
"""
CARD = '<section class="card"><h2>{title}</h2><p>{text}</p>{inner}</section>'
SHOWN = 20
"""Factors in the table of influences."""
escape = html.escape


def as_json(subject: Subject, hunted: Hunted) -> dict[str, Any]:
    """Return all that was found as plain data."""
    return {
        "study": subject.study.name,
        "requirement": subject.goal.name,
        "runs": hunted.runs,
        "broken": hunted.broken,
        "first_after": hunted.first_after,
        "independent": {"runs": hunted.lot[1], "broken": hunted.lot[0]},
        "probability": {"above": hunted.bound[0], "below": hunted.bound[1], "confidence": 0.95},
        "subset_simulation": None if hunted.rare is None else hunted.rare._asdict(),
        "influences": [
            {
                "factor": item.name,
                "first": None if item.first is None else item.first._asdict(),
                "total": None if item.total is None else item.total._asdict(),
            }
            for item in hunted.influences
        ],
        "finds": [_find(subject, find) for find in hunted.finds],
    }


def _find(subject: Subject, find: Find) -> dict[str, Any]:
    return {
        "name": find.name,
        "file": f"finds/{find.name}.yaml",
        "words": find.run.words,
        "margin": find.run.margin,
        "seed": find.run.seed,
        "other_seeds": find.chance,
        "factors": factors_of(subject, find),
    }


def finds_text(subject: Subject, hunted: Hunted) -> list[str]:
    """Return a line for each find, with what it needs."""
    lines = [] if hunted.first_after is None else [f"first after {hunted.first_after} runs"]
    for find in hunted.finds:
        needs = "; ".join(f"{name} {_value(item)}" for name, item in factors_of(subject, find).items())
        often = f"{100.0 * find.chance:.0f} % of other seeds"
        lines.append(f"{find.name}: {find.run.words} ({often}). Needs {needs or 'nothing but its seed'}")
    return lines


def bound_text(hunted: Hunted) -> list[str]:
    """Return what the runs prove."""
    events, count = hunted.lot
    low, high = hunted.bound
    lines = [f"{events} of {count} independent runs break it: probability {_between(low, high)} (95 % each, exact)"]
    if hunted.rare is not None and hunted.rare.is_bound:
        lines.append(
            f"subset simulation, {hunted.rare.runs} runs: not reached, about {hunted.rare.probability:.2g} or less"
        )
    elif hunted.rare is not None:
        rare = hunted.rare
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


def write_page(subject: Subject, hunted: Hunted, out: Path) -> Path:
    """Write ``hunt.html`` and ``hunt.json`` into ``out``; return the page's path."""
    write_whole(out / "hunt.json", json.dumps(as_json(subject, hunted), indent=2) + "\n")
    page = out / "hunt.html"
    cards = [_finds(subject, hunted), _bounds(hunted), _influences(hunted), _ranges(subject)]
    body = BODY.format(
        title=f"Hunt in {escape(subject.study.name)}",
        subtitle=escape(f"Requirement: {subject.goal.text}. {hunted.runs} runs."),
        kind="bad" if hunted.broken else "good",
        verdict=f"{hunted.broken} runs break it" if hunted.broken else "nothing found",
        cards="".join(cards),
    )
    write_whole(page, still_page(f"Hunt in {subject.study.name}", body, study_style()))
    return page


def _finds(subject: Subject, hunted: Hunted) -> str:
    rows = []
    for find in hunted.finds:
        needs = "<br>".join(
            f"<code>{escape(name)}</code> {escape(_value(item))} <span class='quiet'>{escape(str(item['text']))}</span>"
            for name, item in factors_of(subject, find).items()
        )
        command = f'<a href="finds/{escape(find.name)}.yaml">{escape(find.name)}.yaml</a>'
        rows.append((command, escape(find.run.words), needs or "nothing", f"{100.0 * find.chance:.0f} %"))
    text = "Each with as few disturbances as may be, each as mild as may be (in brackets: nominal). Run one: "
    text += "<code>apa run finds/NAME.yaml</code>; the same bits as when it was found."
    heads = ("scenario", "what happens", "what it needs", "of other seeds")
    return CARD.format(title="Finds", text=text if rows else "None.", inner=_table(heads, rows) if rows else "")


def _bounds(hunted: Hunted) -> str:
    text = "<br>".join(escape(line) for line in bound_text(hunted))
    return CARD.format(title="Probability of violation", text=text, inner="")


def _influences(hunted: Hunted) -> str:
    rows = [
        (f"<code>{escape(item.name)}</code>", _index(item.first), _index(item.total))
        for item in hunted.influences[:SHOWN]
    ]
    rows += [
        (escape(item.name), _index(item.first), _index(item.total))
        for item in hunted.influences[SHOWN:]
        if item.first is None
    ]
    text = (
        "Sobol indices of the margin with 95 % intervals: the share of its variance that goes with a factor alone "
        "(first), and with all that it has a part in (total)."
    )
    return CARD.format(title="Sensitivity", text=text, inner=_table(("factor", "first", "total"), rows))


def _index(index: Index | None) -> str:
    return "" if index is None else f"{index.value:.2f} <span class='quiet'>{index.low:.2f} to {index.high:.2f}</span>"


def _ranges(subject: Subject) -> str:
    rows = [
        (
            f"<code>{escape(item.name)}</code>",
            (", ".join(dict.fromkeys(item.choices)) if item.choices else f"{item.low:g} to {item.high:g}")
            + _unit(item),
            (item.choices[int(item.nominal)] if item.choices else f"{item.nominal:g}") + _unit(item),
            escape(item.text),
        )
        for item in subject.space.factors
    ]
    return CARD.format(title="Ranges", text="", inner=_table(("factor", "range", "nominal", ""), rows))


def _unit(factor: Factor) -> str:
    return "" if factor.unit in ("", "1") else f" {escape(factor.unit)}"


def _table(heads: Iterable[str], rows: Iterable[tuple[str, ...]]) -> str:
    head = "".join(f"<th>{item}</th>" for item in heads)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    return f'<div class="scroll" tabindex="0"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'
