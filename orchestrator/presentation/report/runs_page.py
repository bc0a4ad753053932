"""index.html over a folder of runs: a table with pictures, filtered by a word or an outcome."""

import os
from html import escape
from pathlib import Path
from string import Template
from typing import Any

from fmus.files import write_whole
from orchestrator.presentation.report.results import LOG, PAGE, PICTURE

PAGE_TEMPLATE = Path(__file__).parent / "template" / "runs.html"


def write_runs_page(folder: Path, rows: list[dict[str, Any]]) -> Path:
    """Write ``folder/index.html`` over ``rows`` of :func:`run_index.find_runs`; return its path."""
    page = folder / "index.html"
    outcomes = sorted({row["outcome"] for row in rows})
    text = Template(PAGE_TEMPLATE.read_text(encoding="utf-8")).substitute(
        folder=escape(str(folder)),
        count=len(rows),
        outcomes="".join(
            f'<option value="{escape(name)}">{escape(name.replace("_", " "))}</option>' for name in outcomes
        ),
        rows="\n".join(_row(folder, row) for row in rows),
    )
    write_whole(page, text)
    return page


def _row(folder: Path, row: dict[str, Any]) -> str:
    run = Path(row["path"])
    here = Path(os.path.relpath(run, folder)).as_posix()
    said = escape(f"{row['scenario']}: {row['outcome'].replace('_', ' ')}")
    picture = f'<img loading="lazy" alt="{said}" src="{escape(here)}/{PICTURE}">' if (run / PICTURE).is_file() else ""
    target = f"{here}/{PAGE}" if (run / PAGE).is_file() else f"{here}/"
    log = f'<a href="{escape(here)}/{LOG}">log</a>' if (run / LOG).is_file() else ""
    words = " ".join(str(row[key]) for key in ("scenario", "overrides", "outcome", "path"))
    outcome = escape(row["outcome"].replace("_", " "))
    cells = (
        f'<a href="{escape(target)}">{picture or escape(here)}</a>',
        escape(row["time"]),
        f'<a href="{escape(target)}">{escape(row["scenario"])}</a><br><code>{escape(row["overrides"])}</code>',
        f'<b class="{escape(row["outcome"])}">{outcome}</b><br>{escape(row["reason"].replace("_", " "))}',
        f"<code>{escape(row['command'])}</code><br>{escape(here)} {log}",
    )
    body = "".join(f"<td>{cell}</td>" for cell in cells)
    return f'<tr data-text="{escape(words.lower())}" data-outcome="{escape(row["outcome"])}">{body}</tr>'
