"""Figures of runs for a publication."""

from pathlib import Path

import pytest

from orchestrator.cli import main
from orchestrator.presentation.drawing.run_figure import run_figure, width_in_cm
from orchestrator.studies.papers.drive import drive


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("figure") / "case2"
    assert main(["run", "guo2015-case2", "--fmus", "native", "--out", str(folder)]) in (0, 1)
    return folder


@pytest.mark.parametrize(("name", "begin"), [("a.pdf", b"%PDF"), ("a.svg", b"<?xml"), ("a.png", b"\x89PNG")])
def test_a_figure_of_two_runs_is_written(run_folder: Path, tmp_path: Path, name: str, begin: bytes) -> None:
    words = ["report", str(run_folder), str(run_folder), "--figure", str(tmp_path / name), "--dpi", "40"]
    assert main([*words, "--width", "8.4cm", "--panels", "path,speed"]) == 0
    assert (tmp_path / name).read_bytes().startswith(begin)


def test_the_figure_from_python_has_the_panels_asked_for_and_one_line_a_run() -> None:
    recording = drive("guo2015-case2").recording
    figure = run_figure([("a", recording), ("b", recording)], ("speed", "vehicle.clearance"), 8.4)
    assert figure.get_figwidth() == pytest.approx(8.4 / 2.54)
    assert [axis.get_ylabel() for axis in figure.axes] == ["speed [m/s]", "vehicle.clearance"]
    solid = list(figure.axes[1].lines)
    assert [line.get_label() for line in solid] == ["a", "b"]
    assert solid[0].get_linestyle() != solid[1].get_linestyle()


@pytest.mark.parametrize(
    "wrong", [["--panels", "sped"], ["--width", "3 parsec"], ["--dpi", "1"], ["--figure", "figure.doc"]]
)
def test_bad_words_are_refused(run_folder: Path, tmp_path: Path, wrong: list[str]) -> None:
    assert main(["report", str(run_folder), "--figure", str(tmp_path / "f.png"), *wrong]) == 2


def test_a_page_is_of_one_run(run_folder: Path) -> None:
    assert main(["report", str(run_folder), str(run_folder)]) == 2


def test_widths() -> None:
    assert [width_in_cm(text) for text in ("8.4cm", "84mm", "8.4")] == pytest.approx([8.4] * 3)
    assert width_in_cm("3.3in") == pytest.approx(8.382)
