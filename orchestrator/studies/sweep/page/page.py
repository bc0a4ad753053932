"""The result page of a study: one HTML file that loads nothing, made from the table alone."""

import html
import math
from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import yaml

from fmus.files import write_whole
from orchestrator.evaluation.verdict.confidence import wilson
from orchestrator.inputs.scenario.scenario import DONE
from orchestrator.inputs.text.quantities import RAD_PER_DEGREE
from orchestrator.presentation.report.page import still_page
from orchestrator.studies.sweep.page.explorer import explorer_data
from orchestrator.studies.sweep.page.figures import histogram, scale_bar, success_map
from orchestrator.studies.sweep.page.statistics import (
    deciding_limit,
    for_people,
    influences,
    maps,
    outcome_counts,
    outcome_kind,
    reasons,
    success_mask,
    value_text,
    varying_columns,
    word,
    worst,
)
from orchestrator.studies.sweep.table import Table
from orchestrator.studies.sweep.verdict import RESULTS

BODY = """<header class="top"><div class="headline"><h1>{title}</h1><p id="subtitle">{subtitle}</p></div>
<span class="verdict {kind}">{verdict}</span></header>
<main><dl class="facts">{facts}</dl>
<div class="study">
{cards}
</div></main>
<footer>{foot}</footer>
"""
WORST_ROWS = 12
HISTOGRAMS = (
    "final.lateral_error",
    "final.heading_error",
    "duration",
    "manoeuvres",
    "steering_travel",
    "min_clearance",
)
REPLAYS = "row-{}"
"""Where `apa replay` puts a row, beside the table."""
NO_OBSTACLE_DISTANCE = 1e8
"""A clearance beyond this [m]: there was nothing in the scene."""
escape = html.escape


def write_page(path: Path, live: str = "") -> Path:
    """Write the page beside the table at ``path``; return where it is."""
    table = Table(path)
    page = path.with_suffix(".html")
    write_whole(page, study_page(table, live))
    return page


def study_page(table: Table, live: str = "") -> str:
    """Return the page; ``live``: the page beside it that replays runs, empty if there is none."""
    study = table.about["study"]
    good = success_mask(table)
    share = 100.0 * good.mean()
    groups = _groups(table)
    cards = [_maps(table), _reasons(table), _histograms(table), _influences(table), _worst(table), _about(table)]
    title = study["title"] or study["name"]
    body = BODY.format(
        title=escape(title),
        subtitle=escape(study["description"]),
        kind="" if len(groups) > 1 else "good" if share >= 99.0 else "warn" if share >= 50.0 else "bad",
        verdict=escape(", ".join(groups) or f"{share:.1f} %") + f" {word(table)}",
        facts=_facts(table, int(good.sum())),
        cards="\n".join(card for card in cards if card),
        foot=escape(f"apa-cosim {table.about['versions'].get('apa-cosim', '')}, {table.path.name}"),
    )
    shown = maps(table)
    if not shown:
        return still_page(title, body, study_style())
    data = f'<script type="application/json" id="runs">{explorer_data(table, shown, live)}</script>'
    script = (Path(__file__).parent / "explorer.js").read_text(encoding="utf-8")
    return still_page(title, body + data, study_style(), script)


def study_style() -> str:
    """Return what the pages about studies add to the common style."""
    return (Path(__file__).parent / "page.css").read_text(encoding="utf-8")


def _groups(table: Table) -> list[str]:
    """Return the success of each part that the maps are split into: one number over unlike systems says nothing."""
    shown = [item for item in maps(table) if item.title]
    return [f"{item.title} {100.0 * item.done.sum() / max(1, item.runs.sum()):.1f} %" for item in shown]


def _facts(table: Table, good: int) -> str:
    low, high = wilson(good, table.count)
    ends, study = Counter(table.column(table.ends).tolist()), table.about["study"]
    facts = {
        "runs": f"{table.count:,}".replace(",", " "),
        word(table): f"{good:,}".replace(",", " "),
        **_valid_fact(table),
        "95 % interval": f"{100 * low:.2f} to {100 * high:.2f} %",
        **{name.replace("_", " "): f"{count}" for name, count in ends.most_common() if name not in DONE},
        "median time": f"{float(np.median(table.column('duration'))):.1f} s",
        **{key: Path(str(study[key])).stem for key in ("scenario", "seed") if key in study},
    }
    return "".join(f"<div><dt>{escape(name)}</dt><dd>{escape(value)}</dd></div>" for name, value in facts.items())


def _valid_fact(table: Table) -> dict[str, str]:
    """Return the success among the runs whose task the scene allows, where the study says which these are."""
    if "valid" not in table.names():
        return {}
    valid = table.column("valid") == 1.0
    return {f"{word(table)} of valid": f"{int(success_mask(table)[valid].sum())} of {int(valid.sum())}"}


def card(title: str, text: str, body: str = "") -> str:
    """Return one card of a page; all are HTML."""
    return f'<section class="card"><h2>{title}</h2><p>{text}</p>{body}</section>'


def _maps(table: Table) -> str:
    shown = maps(table)
    if not shown:
        return ""
    figures = "".join(
        f"<figure data-map><figcaption>{escape(item.title)} "
        f"{_rate(int(item.done.sum()), int(item.runs.sum()))}</figcaption>"
        f"{success_map(item, word(table))}</figure>"
        for item in shown
    )
    text = f"Share of runs that end {word(table)} within all required limits."
    text += " Point at a cell for its numbers, click it for its runs."
    return card("Success", text, f'<div class="maps">{figures}</div>{scale_bar(word(table))}')


def _rate(good: int, count: int) -> str:
    low, high = wilson(good, count)
    share = 100.0 * good / max(count, 1)
    return f'<span class="quiet">{share:.1f} % of {count} runs (95 %: {100 * low:.1f} to {100 * high:.1f} %)</span>'


def _reasons(table: Table) -> str:
    rows = [
        (
            _pill(item.outcome),
            escape(item.reason),
            f"{item.runs}",
            f"{100 * item.share:.2f} %",
            f"{100 * item.low:.2f} to {100 * item.high:.2f} %",
            _meter(item.share, "good" if item.outcome in DONE else "bad"),
        )
        for item in outcome_counts(table)
    ]
    return card("Outcomes", "", html_table(("outcome", "reason", "runs", "share", "95 % interval", ""), rows))


def _histograms(table: Table) -> str:
    good = success_mask(table)
    figures = []
    for name in HISTOGRAMS:
        if name in table.names():
            factor, unit = for_people(RESULTS[name].unit)
            values = np.asarray(table.column(name), dtype=np.float64) * factor
            if not np.isfinite(values).any() or (
                name == "min_clearance" and float(values.min()) >= NO_OBSTACLE_DISTANCE
            ):
                continue
            shown = "" if unit == "1" else f" <span class='quiet'>[{unit}]</span>"
            caption = f"<figcaption>{escape(name)}{shown}</figcaption>"
            figures.append(f"<figure>{caption}{histogram(values, good, name, unit, word(table))}</figure>")
    return card(
        "Results",
        f"Runs that are {word(table)} in green, the others in red; the end bars hold the 0.5 % beyond.",
        f'<div class="side">{"".join(figures)}</div>',
    )


def _influences(table: Table) -> str:
    found = influences(table)
    if not found:
        return ""
    results = list(found[0].share)
    rows = []
    for item in found:
        cells = [f"<code>{escape(item.name)}</code>", _meter(np.nan_to_num(item.share[word(table)]))]
        for name in results:
            cells.append(_finite("{:.1f} %", 100 * item.share[name]) or "too few runs")
            cells.append(f"{item.rank[name]:+.2f}")
        rows.append(tuple(cells))
    heads = ["parameter", ""] + [text for name in results for text in (f"of {name}", "rank")]
    text = (
        "Share of the variance of a result that goes with one parameter alone (first order; what is missing to 100 % "
        "is joint effects and chance), and Spearman's rank correlation."
    )
    return card("Sensitivity: first-order index, rank correlation", text, html_table(heads, rows))


def _worst(table: Table) -> str:
    rows = []
    keys, why = varying_columns(table), reasons(table)
    for number in worst(table, WORST_ROWS):
        row = table.row(number)
        replay = table.path.parent / REPLAYS.format(number) / "report.html"
        command = f"<code>apa replay {escape(table.path.name)} --row {number}</code>"
        link = f'<a href="{escape(REPLAYS.format(number))}/report.html">replay</a> ' if replay.is_file() else ""
        rows.append(
            (
                str(number),
                f"{_pill(row[table.ends])} {escape(why[number])}",
                escape(deciding_limit(table, number)),
                _finite("{:+.1f} cm", 100.0 * row["final.lateral_error"]),
                _finite("{:+.2f} deg", row["final.heading_error"] / RAD_PER_DEGREE),
                f"{row['duration']:.1f} s",
                link + command,
                *(escape(value_text(table, key, row[key])) for key in keys),
            )
        )
    heads = ("row", "outcome", "deciding limit", "lateral", "heading", "time", "replay", *(escape(key) for key in keys))
    text = "The command repeats a row to the same bits, with log and replay."
    return card("Largest violations", text, html_table(heads, rows))


def _finite(form: str, value: float) -> str:
    return form.format(value) if math.isfinite(value) else ""


def _about(table: Table) -> str:
    about = table.about
    content = {key: value for key, value in about["study"].items() if value not in (None, "", {}, [])}
    text = yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=100)
    rows: list[tuple[str, ...]] = [(escape(name), escape(str(value))) for name, value in about["versions"].items()]
    rows.append(("sources", f"<code>{escape(about['sources'][:16])}</code>"))
    return (
        '<section class="card"><details><summary>Study and versions</summary>'
        f'<pre class="scroll" tabindex="0">{escape(text)}</pre>'
        f"{html_table(('what', 'version'), rows)}</details></section>"
    )


def _pill(outcome: str) -> str:
    return f'<span class="pill {outcome_kind(outcome)}">{escape(outcome.replace("_", " "))}</span>'


def _meter(share: float, kind: str = "") -> str:
    return f'<div class="meter {kind}"><i style="width:{100.0 * share:.2f}%"></i></div>'


def html_table(heads: Iterable[str], rows: Iterable[tuple[str, ...]]) -> str:
    """Return a table whose cells are HTML; cells that begin like a number are aligned to the right."""
    number: Callable[[str], str] = lambda text: ' class="number"' if text[:1] in "+-0123456789" else ""  # noqa: E731
    body = "".join("<tr>" + "".join(f"<td{number(cell)}>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    head = "".join(f"<th>{text}</th>" for text in heads)
    return f'<div class="scroll" tabindex="0"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'
