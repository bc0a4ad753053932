"""A third-party controller, which has none of our parameters, is judged by the scenario's ground truth."""

import json
from pathlib import Path

import pytest
from two_arcs import MODEL

from fmus.python.fmu import build
from orchestrator.cli import main
from orchestrator.presentation.log.read_log import read_log
from orchestrator.presentation.report.still import still_of


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("two_arcs")
    fmu = build(MODEL, folder)
    main(["test", "guo2015-case4", "--controller", str(fmu), "--fmus", "python", "--out", str(folder)])
    return folder / "guo2015-case4"


def test_it_is_parked_although_it_was_told_no_target(results: Path) -> None:
    summary = json.loads((results / "summary.json").read_text(encoding="utf-8"))
    assert (summary["outcome"], summary["reason"]) == ("parked", "all checks passed")
    assert abs(summary["final"]["lateral_error"]) < 0.03
    assert abs(summary["final"]["longitudinal_error"]) < 0.05
    assert summary["final"]["outline_margin"] > 0.05


def test_its_log_shows_the_target(results: Path, tmp_path: Path) -> None:
    log = results / "run.mcap"
    assert still_of(read_log(log), (0.0, 0.0))["target"] == [-7.608, -3.056, 0.0]
    assert main(["report", str(log), "--out", str(tmp_path / "again.html")]) == 0
    assert main(["check", str(log), "guo2015", "gbt41630"]) == 0
