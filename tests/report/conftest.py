from pathlib import Path
from typing import Any

import pytest

from orchestrator.evaluation.comparison.compare import compare
from orchestrator.evaluation.comparison.tolerance import Tolerance, Tolerances
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.presentation.log.line import Line
from orchestrator.presentation.report.overlay import write_overlay
from orchestrator.presentation.report.replay import replay_page
from tests.native_runs import drive_natively

EVIL = "<script>window.evil = 1</script><img src=x onerror='window.evil = 1'>"


@pytest.fixture(scope="session")
def case4() -> Any:
    """Recording and summary of case 4, run in process, with a hostile title."""
    scenario = load_scenario("guo2015-case4").model_copy(update={"title": f"{EVIL} & case 4"})
    ran = drive_natively(scenario)
    return ran.recording, summarize(ran.recording, scenario, ran.wall_time)


@pytest.fixture(scope="session")
def replay(case4: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The replay page of that run, with a hostile message."""
    path: Path = tmp_path_factory.mktemp("replay") / "report.html"
    recording, summary = case4
    path.write_text(replay_page(recording, summary, [Line(1.0, "warning", "model", EVIL)]), encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def overlay(case4: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of that run and one with another gain."""
    scenario = load_scenario("guo2015-case4", ["controller.guo2015.k4=3"])
    runs = (case4[0], drive_natively(scenario).recording)
    path: Path = tmp_path_factory.mktemp("overlay") / "overlay.html"
    write_overlay(path, runs, ([], []), [compare(*runs, Tolerances(Tolerance(0.01, 0.0, 0.1)))])
    return path


@pytest.fixture(scope="session")
def three(case4: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of three runs, each with another gain."""
    others = [
        drive_natively(load_scenario("guo2015-case4", [f"controller.guo2015.k4={k4}"])).recording for k4 in (2, 3)
    ]
    runs = [case4[0], *others]
    path: Path = tmp_path_factory.mktemp("three") / "overlay.html"
    write_overlay(path, runs, ([], [], []), [compare(runs[0], run, Tolerances(Tolerance(0.01))) for run in others])
    return path
