"""Ground truth is shown as the scenario defines it, whatever the controller received and an FMU lacks."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from orchestrator.evaluation.verdict.logged_scenario import read_logged_scenario
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Target
from orchestrator.presentation.drawing.figure import _plan
from orchestrator.presentation.drawing.picture_data import overview_of
from orchestrator.presentation.log.read_log import read_log
from orchestrator.presentation.report.still import still_of
from orchestrator.session.foreign import bind_parameters
from orchestrator.session.session import SimulationResult, run_scenario
from orchestrator.testing.suite.collection import picture

TRUE = (-7.608, -3.056, 0.0)
TOLD = load_scenario("guo2015-case4", ["controller.target.y=-3.2", "stop_time=2", "expected_outcome=not_parked"])


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> tuple[SimulationResult, Path]:
    log = tmp_path_factory.mktemp("ground_truth") / "run.mcap"
    return run_scenario(TOLD, log=log), log


def test_the_page_shows_the_true_target(ran: tuple[SimulationResult, Path]) -> None:
    for recording in (ran[0].recording, read_log(ran[1])):
        assert still_of(recording, (0.0, 0.0))["target"] == list(TRUE)
        assert recording.parameters["controller.target.y"] == -3.2


def test_the_log_shows_the_true_target(ran: tuple[SimulationResult, Path]) -> None:
    with ran[1].open("rb") as stream:
        rows = make_reader(stream, decoder_factories=[DecoderFactory()]).iter_decoded_messages(topics=["/scene"])
        shown = [entity for row in rows for entity in row.decoded_message.entities if entity.id == "target"]
    position = shown[0].lines[0].pose.position
    assert (position.x, position.y) == TRUE[:2]


def test_the_picture_shows_the_true_target(ran: tuple[SimulationResult, Path]) -> None:
    axis = Figure().subplots()
    _plan(axis, "a", overview_of(ran[0].recording, summarize(ran[0].recording, TOLD, 1.0), TOLD))
    line = next(line for line in axis.lines if line.get_label() == "target")
    assert np.asarray(line.get_ydata())[:4].mean() == pytest.approx(TRUE[1])


def test_the_card_of_a_test_is_turned_to_the_true_target(ran: tuple[SimulationResult, Path]) -> None:
    recording = ran[0].recording
    turned = TOLD.model_copy(update={"target": Target(x=TRUE[0], y=TRUE[1], heading=0.5)})
    assert picture(recording, TOLD) != picture(recording, turned)
    reported = TOLD.model_copy(update={"controller": {**TOLD.controller, "target.heading": 0.5}})
    assert picture(recording, TOLD) == picture(recording, reported)


def test_the_log_carries_what_is_true(ran: tuple[SimulationResult, Path]) -> None:
    scenario = read_logged_scenario(read_log(ran[1]))
    assert (scenario.target, scenario.slot, scenario.stop_condition) == (TOLD.target, TOLD.slot, TOLD.stop_condition)
    assert scenario.requirements == TOLD.requirements


def test_what_a_foreign_vehicle_does_not_have_stays_true(ran: tuple[SimulationResult, Path]) -> None:
    """Its outline, its neighbours and the kerb are the scenario's, as it has no parameters for them."""
    kerb = "scene.kerbs=[[-15, -4.1, 5, -4.1, 0.1]]"
    scenario, unsupported_parameters = bind_parameters(load_scenario("guo2015-case4", [kerb]), {"vehicle": []})
    assert "vehicle.scene.boxes[1].x" in unsupported_parameters
    assert scenario.parameters_for("vehicle") == {}
    recording = ran[0].recording
    theirs = {name: value for name, value in recording.parameters.items() if not name.startswith("vehicle.")}
    info = {**recording.info, "scenario": scenario.model_dump(mode="json", exclude={"file"})}
    bare = type(recording)(recording.t_ns, recording.signals, theirs, recording.variables, info)
    shown = still_of(bare, (0.0, 0.0))
    assert len(shown["boxes"]) == 2
    assert shown["car"]["half"] == pytest.approx(0.825)
    assert "nearest tyre to the kerb" in {check.id for check in summarize(bare, scenario, 1.0).checks}
