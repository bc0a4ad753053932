"""The verdicts on the catalogue for people: a table on the terminal, a page, a table of documentation."""

import html
from collections.abc import Mapping
from itertools import groupby
from pathlib import Path

from rich.markup import escape
from rich.table import Table

from fmus.files import write_whole
from orchestrator.evaluation.verdict.limit_text import sentence
from orchestrator.presentation.report.page import still_page
from orchestrator.testing.catalogue.verdicts import MET, MISSED, ClauseRun, ClauseVerdict, counts

BODY = """<header class="top"><div class="headline"><h1>Catalogue of parking requirements</h1></div>
<span class="verdict {kind}">{verdict}</span></header>
<main><dl class="card about">{facts}</dl>
{parts}
</main>
"""
STYLE = """
.clauses { border-collapse: collapse; width: 100%; margin: .5rem 0 1.5rem; }
.clauses th, .clauses td { text-align: left; vertical-align: top; padding: .35rem .6rem; }
.clauses td { border-bottom: 1px solid #8884; }
.clauses td:first-child { white-space: nowrap; }
.clauses ul { margin: .2rem 0; padding-left: 1.2rem; }
"""
HEADS = ("clause", "required", "confidence", "verdict", "why")


def count_text(verdicts: list[ClauseVerdict]) -> str:
    """Return the counts in words."""
    return ", ".join(f"{count} {word}" for word, count in counts(verdicts).items())


def verdict_tables(verdicts: list[ClauseVerdict]) -> list[Table]:
    """Return a table for each standard."""
    tables = []
    for name, items in groupby(verdicts, key=lambda item: item.standard.standard):
        table = Table(title=name, title_justify="left", title_style="bold", box=None, pad_edge=False)
        for head, width in zip(("clause", "required", "confidence", "", "why"), (12, 30, 10, 10, None), strict=True):
            table.add_column(head, width=width, overflow="fold")
        for item in items:
            colour = {MET: "green", MISSED: "red"}.get(item.word, "yellow")
            why = "" if item.word == MET else item.why
            table.add_row(item.entry.clause, item.entry.id, item.entry.sure, f"[{colour}]{item.word}[/]", escape(why))
        tables.append(table)
    return tables


def write_catalogue(path: Path, verdicts: list[ClauseVerdict], about: Mapping[str, str]) -> None:
    """Write the page; ``about`` says what was tested, when and how."""
    parts = []
    for standard, items in groupby(verdicts, key=lambda item: item.standard):
        head = f"<h2>{html.escape(standard.standard)}</h2><p>{html.escape(standard.title)}.</p>"
        parts.append(f'{head}<p class="soft">{html.escape(standard.source)}.</p>{_table(list(items))}')
    facts = "".join(f"<dt>{html.escape(key)}</dt><dd>{html.escape(text)}</dd>" for key, text in about.items())
    kind = "bad" if counts(verdicts)[MISSED] else "good"
    body = BODY.format(kind=kind, verdict=count_text(verdicts), facts=facts, parts="\n".join(parts))
    write_whole(path, still_page("Catalogue of parking requirements", body, STYLE))


def markdown(verdicts: list[ClauseVerdict]) -> str:
    """Return the tables as documentation has them: without numbers of the runs, which go with every change."""
    parts = []
    for standard, items in groupby(verdicts, key=lambda item: item.standard):
        lines = [f"### {standard.standard}\n", f"{standard.title}. Facts from: {standard.source}.\n"]
        lines += ["| clause | required | confidence | | by |", "|---|---|---|---|---|"]
        for item in items:
            by = ", ".join(f"`{name}`" for name in (*item.entry.scenarios, *item.entry.step_tests))
            missed = ", ".join(f"`{tried.name}`" for tried in item.tried if tried.missed or tried.error)
            word = f"**missed** ({missed})" if item.word == MISSED else item.word
            cells = (item.entry.clause, item.entry.text, item.entry.sure, word, by or item.entry.not_tested)
            lines.append("| " + " | ".join(cells) + " |")
        parts.append("\n".join(lines))
    return "\n\n".join(parts)


def _table(verdicts: list[ClauseVerdict]) -> str:
    rows = "\n".join(_row(item) for item in verdicts)
    heads = "".join(f"<th>{head}</th>" for head in HEADS)
    return f'<table class="clauses"><thead><tr>{heads}</tr></thead><tbody>\n{rows}\n</tbody></table>'


def _row(item: ClauseVerdict) -> str:
    kind = {MET: "good", MISSED: "bad"}.get(item.word, "warn")
    asked = f"<b>{html.escape(item.entry.id)}</b><br>{html.escape(item.entry.text)}"
    pill = f'<span class="pill {kind}">{item.word}</span>'
    why = "".join(_run_item(tried) for tried in item.tried) or f"<li>{html.escape(item.why)}</li>"
    cells = (html.escape(item.entry.clause or "not known"), asked, item.entry.sure, pill, f"<ul>{why}</ul>")
    return "<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


def _run_item(tried: ClauseRun) -> str:
    name = html.escape(tried.name)
    texts = [tried.error, *tried.missed, *(f"not measured: {name}" for name in tried.unmeasured)]
    texts += [f"{check.id}: {sentence(check)}" for check in tried.checks if check.evaluated and check.passed]
    found = "".join(f"<li>{html.escape(text)}</li>" for text in texts if text)
    outcome = html.escape(tried.outcome.replace("_", " "))
    return f'<li><a href="{name}/report.html">{name}</a> {outcome}<ul>{found}</ul></li>'
