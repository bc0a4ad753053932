"""The figures of the papers: as pictures, or as PNG, SVG, PDF, CSV with the command; or why there is none."""

import csv
import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from fmus.files import write_whole
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.drawing.run_figure import save_figure, style_context
from orchestrator.studies.papers.paper_figures import FIGURES, PaperFigure
from orchestrator.studies.papers.result import Drive

FORMATS = (".png", ".svg", ".pdf")
PICTURE_DPI = 110


def write_figures(paper: str, drive: Drive, folder: Path, dpi: int = 150) -> list[PaperFigure]:
    """Write every figure of ``paper`` to ``folder`` and PAPER.md; return them in order."""
    if not 10 <= dpi <= 2400:
        raise BadInput(f"--dpi {dpi}: expected 10 to 2400")
    folder.mkdir(parents=True, exist_ok=True)
    for name, figure in draw_figures(paper, drive):
        for suffix in FORMATS:
            save_figure(figure, folder / f"{name}{suffix}", dpi)
        write_whole(folder / f"{name}.csv", data_of(figure))
    figures = [item for item in FIGURES if item.paper == paper]
    entries = [entry_of(item) for item in figures]
    write_whole(folder / f"{paper}-figures.json", json.dumps(entries, indent=2) + "\n")
    write_whole(folder / f"{paper}.md", gallery_text(figures))
    return figures


def write_pictures(paper: str, drive: Drive, folder: Path) -> list[Path]:
    """Write every figure of ``paper`` as PNG to ``folder``; return their paths."""
    paths = []
    for name, figure in draw_figures(paper, drive):
        paths.append(folder / f"{name}.png")
        save_figure(figure, paths[-1], PICTURE_DPI)
    return paths


def draw_figures(paper: str, drive: Drive) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of those that have a counterpart, in order."""
    for item in FIGURES:
        if item.paper == paper and item.draw is not None:
            runs = [drive(name) for name in item.scenarios]
            with style_context():
                figure = item.draw(runs)
            yield item.name, figure


def entry_of(item: PaperFigure) -> dict[str, Any]:
    """Return what is known of a figure as plain data."""
    return {
        "paper": item.paper,
        "number": item.number,
        "title": item.title,
        "scenarios": list(item.scenarios),
        "files": [f"{item.name}{suffix}" for suffix in (*FORMATS, ".csv")] if item.draw is not None else [],
        "command": command_of(item),
        "note": item.note,
    }


def command_of(item: PaperFigure) -> str:
    """Return the command that writes the figure."""
    return f"apa reproduce {item.paper} --figures figures" if item.draw is not None else ""


def gallery_text(figures: list[PaperFigure], images: str = "") -> str:
    """Return a list of figures as Markdown: the picture and its command, or the reason that there is none."""
    parts = []
    for item in figures:
        parts.append(f"### {item.number}: {item.title}\n")
        if item.draw is not None:
            parts.append(f"![{item.title}]({images}{item.name}.png)\n")
            runs = f" Runs: {', '.join(f'`{name}`' for name in item.scenarios)}." if item.scenarios else ""
            parts.append(
                f"`{command_of(item)}`: `{item.name}.png`, `.svg`, `.pdf`, `.csv`.{runs} {item.note}".strip() + "\n"
            )
        else:
            parts.append(f"No counterpart: {item.note}.\n")
    return "\n".join(parts)


def data_of(figure: Figure) -> str:
    """Return the lines of a figure as CSV: panel, line, x, y."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("panel", "line", "x", "y"))
    for number, axis in enumerate(figure.axes, start=1):
        panel = f"{number}: {axis.get_xlabel()} / {axis.get_ylabel()}"
        for line in axis.lines:
            for x, y in zip(np.asarray(line.get_xdata()), np.asarray(line.get_ydata()), strict=True):
                writer.writerow((panel, line.get_label(), f"{float(x):.9g}", f"{float(y):.9g}"))
    return text.getvalue()
