"""Reproductions as files for an article: CSV, LaTeX with booktabs, BibTeX, and one summary over all papers."""

import csv
import io
import re

from orchestrator.inputs.scenario.files import LIBRARY
from orchestrator.studies.papers.result import Reproduction, Row

COLUMNS = ("paper", "run", "quantity", "unit", "printed", "here", "difference", "allowed", "verdict", "basis", "why")
LATEX_SPECIAL = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"} | {
    character: f"\\{character}" for character in "&%$#_{}"
}
BIBTEX = LIBRARY / "papers.bib"
"""Entries of the five papers, from what their texts print."""
ENTRY = re.compile(r"@\w+\{(\w+),\n.*?^\}\n", re.DOTALL | re.MULTILINE)


def bibtex_entries() -> dict[str, str]:
    """Return paper -> its BibTeX entry."""
    return {found[1]: found[0] for found in ENTRY.finditer(BIBTEX.read_text(encoding="utf-8"))}


def verdict_of(row: Row) -> str:
    """Return agrees, differs, not testable, or nothing for a number that is only reported."""
    if row.untestable:
        return "not testable"
    return {True: "agrees", False: "differs", None: ""}[row.passed]


def cells_of(paper: str, row: Row) -> tuple[str, ...]:
    """Return one row in the order of ``COLUMNS``; numbers in full."""
    item = row.item + (f" ({row.note})" if row.note else "")
    numbers = ("" if value is None else str(value) for value in (row.paper, row.ours, row.difference, row.limit))
    return (paper, row.run, item, row.unit, *numbers, verdict_of(row), row.basis, row.differs or row.untestable)


def csv_text(results: list[Reproduction]) -> str:
    """Return every row of every reproduction as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(cells_of(result.paper, row) for result in results for row in result.rows)
    return text.getvalue()


def latex_text(results: list[Reproduction]) -> str:
    """Return a booktabs table per reproduction (rows with a verdict only) and one of the totals."""
    tables = [_latex_table(result) for result in results]
    lines = [f"{result.paper} & {' & '.join(map(str, result.tally[:3]))} \\\\" for result in results]
    totals = total(results)
    head = ["\\begin{tabular}{lrrr}", "\\toprule", "paper & agrees & differs & not testable \\\\", "\\midrule"]
    foot = ["\\midrule", f"total & {' & '.join(map(str, totals))} \\\\", "\\bottomrule", "\\end{tabular}", ""]
    return "% needs \\usepackage{booktabs}\n" + "\n".join([*tables, *head, *lines, *foot])


def total(results: list[Reproduction]) -> tuple[int, int, int]:
    """Return how many rows of all papers agree, differ and cannot be tested."""
    tallies = [result.tally for result in results]
    return (
        sum(tally.agrees for tally in tallies),
        sum(tally.differs for tally in tallies),
        sum(tally.untestable for tally in tallies),
    )


def summary_lines(results: list[Reproduction]) -> list[str]:
    """Return the tally of each paper and of all, as aligned text."""
    rows = [(result.paper, *result.tally[:3]) for result in results] + [("total", *total(results))]
    head = f"{'paper':<12}{'agrees':>8}{'differs':>9}{'not testable':>14}"
    return [head, *(f"{name:<12}{agrees:>8}{differs:>9}{unknown:>14}" for name, agrees, differs, unknown in rows)]


def _latex_table(result: Reproduction) -> str:
    lines = [f"% {result.title}", "\\begin{tabular}{llrrl}", "\\toprule"]
    lines += ["run & quantity & printed & here & verdict \\\\", "\\midrule"]
    for row in result.rows:
        if verdict_of(row):
            cells = (row.run, row.item, _number(row.paper, row.unit), _number(row.ours, row.unit), verdict_of(row))
            lines.append(" & ".join(map(escape_latex, cells)) + " \\\\")
    return "\n".join([*lines, "\\bottomrule", "\\end{tabular}", ""])


def escape_latex(text: str) -> str:
    """Return ``text`` with LaTeX's special characters escaped."""
    return "".join(LATEX_SPECIAL.get(character, character) for character in text)


def _number(value: float | str | None, unit: str) -> str:
    if value is None:
        return "--"
    text = value if isinstance(value, str) else f"{value:.4g}"
    return text if isinstance(value, str) or unit in ("", "1") else f"{text} {unit}"
