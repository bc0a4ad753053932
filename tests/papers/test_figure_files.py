"""Figures and tables of the papers as files: formats, data, reasons, totals."""

import csv
import json
from pathlib import Path

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from orchestrator.cli import main
from orchestrator.presentation.drawing.run_figure import style_context
from orchestrator.studies.papers.figure_files import write_figures
from orchestrator.studies.papers.paper_figures import FIGURES, PaperFigure
from orchestrator.studies.papers.papers import papers
from orchestrator.studies.papers.result import CONCLUSION, Drive, Reproduction, Row, not_tested
from orchestrator.studies.papers.table_files import bibtex_entries, csv_text, latex_text, summary_lines, total

ROWS = [
    Row("run_1", "depth", "m", 1.0, 1.5, 0.1, basis=CONCLUSION, differs="50 % & more"),
    Row("run_1", "width", "m", 1.0, 1.0, 0.1, basis=CONCLUSION),
    not_tested("colour", "not printed"),
    Row("run_1", "time", "s", None, 3.0),
]
RESULTS = [Reproduction("one", "One", ROWS, []), Reproduction("two", "Two", ROWS[:2], [])]


def test_every_figure_has_a_counterpart_or_a_reason() -> None:
    assert {item.paper for item in FIGURES} == set(papers()) == set(bibtex_entries())
    counts = {paper: sum(item.paper == paper and item.number != "States" for item in FIGURES) for paper in papers()}
    assert counts == {"apa": 5, "guo2015": 13, "hsic": 13, "preview": 12, "zhang2022": 8}
    assert all(len(item.note) > 10 for item in FIGURES if item.draw is None)
    assert len({item.name for item in FIGURES}) == len(FIGURES)


def test_figures_of_a_paper_are_written_with_data_and_commands(by_default: Drive, tmp_path: Path) -> None:
    write_figures("zhang2022", by_default, tmp_path, dpi=40)
    for entry in json.loads((tmp_path / "zhang2022-figures.json").read_text(encoding="utf-8")):
        assert bool(entry["files"]) == bool(entry["command"])
        for name in entry["files"]:
            assert (tmp_path / name).stat().st_size > 500
    assert (tmp_path / "zhang2022-fig7.pdf").read_bytes().startswith(b"%PDF")
    with (tmp_path / "zhang2022-fig7.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert {row["line"] for row in rows} == {"car", "reference"}
    assert min(float(row["y"]) for row in rows if row["line"] == "reference") == pytest.approx(-1.0)


def test_a_reproduction_writes_its_numbers_and_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["reproduce", "zhang2022", "--out", str(tmp_path), "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)
    assert found == json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    assert [Path(figure).name for figure in found["figures"]] == [f"zhang2022-fig{n}.png" for n in (2, 5, 6, 7, 8)]
    assert all(Path(figure).stat().st_size > 10_000 for figure in found["figures"])


@pytest.mark.parametrize(
    "item",
    [item for item in FIGURES if item.draw is not None and not item.scenarios and item.name != "preview-fig11"],
    ids=lambda item: item.name,
)
def test_words_of_a_figure_are_inside_it_and_none_is_over_another(item: PaperFigure) -> None:
    assert item.draw is not None
    with style_context():
        figure = item.draw([])
    FigureCanvasAgg(figure).draw()
    texts = [text for axis in figure.axes for text in (*axis.texts, axis.xaxis.label, axis.yaxis.label)]
    boxes = [(text.get_text(), text.get_window_extent()) for text in texts if text.get_text().strip()]
    inside = figure.bbox
    for words, box in boxes:
        assert box.x0 > inside.x0 - 1.0, words
        assert box.x1 < inside.x1 + 1.0, words
        assert box.y0 > inside.y0 - 1.0, words
        assert box.y1 < inside.y1 + 1.0, words
    for number, (words, box) in enumerate(boxes):
        for others, other in boxes[number + 1 :]:
            across = min(box.x1, other.x1) - max(box.x0, other.x0)
            along = min(box.y1, other.y1) - max(box.y0, other.y0)
            assert min(across, along) < 1.0, f"{words} over {others}"


def test_rows_as_csv_and_latex_and_their_total() -> None:
    rows = list(csv.DictReader(csv_text(RESULTS).splitlines()))
    assert [row["verdict"] for row in rows[:4]] == ["differs", "agrees", "not testable", ""]
    assert rows[0]["difference"] == "0.5"
    text = latex_text(RESULTS)
    assert text.count(r"\toprule") == text.count(r"\bottomrule") == 3
    assert r"run\_1 & depth & 1 m & 1.5 m & differs \\" in text
    assert total(RESULTS) == (2, 2, 1)
    assert summary_lines(RESULTS)[-1].split() == ["total", "2", "2", "1"]


def test_bibtex_needs_no_run(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["reproduce", "guo2015", "--bibtex"]) == 0
    assert capsys.readouterr().out.startswith("@article{guo2015,")
