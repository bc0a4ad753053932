"""A planted fault is found, shrunk and written down; where none is, the hunt says what it proves."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from fmus.native.compilers import can_compile
from orchestrator.cli import main, parser
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.session import SimulationResult, run_scenario
from orchestrator.studies.falsification import begin
from orchestrator.studies.falsification.counterexamples import BITS, NOTES, rerun_counterexamples
from orchestrator.studies.falsification.objective import objective_of
from orchestrator.studies.falsification.shrink import away
from orchestrator.studies.falsification.subject import Subject, _read_part
from orchestrator.studies.falsification.written import space_of
from orchestrator.studies.sweep.job import Chunk, make_job
from orchestrator.studies.sweep.study.read_study import read_study
from tests.fmi.built import native_fmu_of

RUNS = {
    "n": 64,
    "vehicle.driver.profile[1].speed": {"uniform": [0.3, 1.5]},
    "vehicle.driver.reaction_delay": {"uniform": [0.0, 0.5]},
    "vehicle.start.x": {"uniform": [-0.1, 0.3]},
    "vehicle.start.y": {"uniform": [-0.1, 0.1]},
    "vehicle.start.heading": {"uniform": [-0.02, 0.02]},
    "vehicle.steering.backlash": {"uniform": [0.0, 0.05]},
    "vehicle.steering.dead_time": {"uniform": [0.0, 0.1]},
    "vehicle.driver.speed_oscillation_amplitude": {"uniform": [0.0, 0.1]},
}
WHOLE = "controller.target.y"
TRUE = -3.056
PLANTED = TRUE + 0.045
"""Of the 5 cm that the lateral position may be off, the controller gives most away."""


@pytest.fixture
def study(tmp_path: Path) -> Any:
    """A function from the target that the controller believes to the file of a study."""

    def written(target: Any) -> Any:
        content = {"scenario": "guo2015-case3-105", "set": {"requirements": ["guo2015-in-line"], WHOLE: target}}
        path = tmp_path / "drivers.yaml"
        path.write_text(yaml.safe_dump({**content, "runs": {"monte_carlo": RUNS}}))
        return str(path)

    return written


def hunted(capsys: pytest.CaptureFixture[str], *words: Any) -> Any:
    code = main(["falsify", *words, "--json"])
    return code, json.loads(capsys.readouterr().out)


def test_a_planted_fault_is_found_in_500_runs_and_shrunk(
    study: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    words = ("--requirement", "final lateral position", "--budget", "400", "--seed", "3", "--out", str(out))
    code, found = hunted(capsys, study(PLANTED), *words)
    assert code == 1
    assert found["first_after"] <= 500
    assert found["counterexamples"]
    for item in found["counterexamples"]:
        assert item["margin"] <= 0.0
        assert len(item["factors"]) < len(RUNS) - 1
    assert (out / "falsify.html").read_text(encoding="utf-8").count("<script") == 0
    assert json.loads((out / "falsify.json").read_text()) == {key: found[key] for key in found if key != "page"}


def test_a_find_runs_again_to_the_same_bits(study: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """In the compiled batch, and as an ordinary run through the Python master."""
    out = tmp_path / "out"
    words = ("--requirement", "final lateral position", "--budget", "100", "--out", str(out))
    code, found = hunted(capsys, study(TRUE + 0.055), *words)
    assert code == 1
    folder = out / "counterexamples"
    again = rerun_counterexamples(folder)
    assert [item.same for item in again] == [True] * len(found["counterexamples"])
    assert all(item.breaks for item in again)
    noted = json.loads((folder / NOTES).read_text())
    scenario = load_scenario(str(folder / f"{again[0].name}.yaml"))
    summary = summarize(run_scenario(scenario).recording, scenario, 1.0)
    reported = {
        "duration": summary.duration,
        **{f"final.{key}": value for key, value in summary.final.model_dump().items()},
    }
    bits = noted[again[0].name]["bits"]
    assert {key: reported[key].hex() for key in BITS if key in reported} == {
        key: bits[key] for key in BITS if key in reported
    }
    assert summary.outcome == "not_parked"
    assert main(["falsify", "--regression", str(folder)]) == 1
    repaired = folder / f"{again[0].name}.yaml"
    content = yaml.safe_load(repaired.read_text())
    for path in folder.glob("*.yaml"):
        path.unlink()
    content["controller"]["target.y"] = TRUE
    repaired.write_text(yaml.safe_dump(content))
    assert main(["falsify", "--regression", str(folder)]) == 0
    assert [item.same for item in rerun_counterexamples(folder)] == [False]


def test_where_nothing_breaks_it_says_what_that_proves(
    study: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--requirement", "final lateral position", "--budget", "200", "--out", str(tmp_path / "out"))
    code, found = hunted(capsys, study(TRUE), *words)
    assert (code, found["counterexamples"], found["first_after"], found["independent"]["broken"]) == (0, [], None, 0)
    assert found["probability"]["below"] == pytest.approx(1.0 - 0.05 ** (1.0 / found["independent"]["runs"]))
    assert found["influences"][0]["first"]["value"] > 0.0


def test_an_interrupted_hunt_goes_on_to_the_same_end(
    study: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = (study(PLANTED), "--requirement", "final lateral position", "--budget", "100")
    _, whole = hunted(capsys, *words, "--out", str(tmp_path / "whole"))
    out, made = tmp_path / "cut", Subject._run_part

    def cut(self: Any, part: Any, shares: Any, seeds: Any) -> Any:
        if self.runs > 40:
            self.interrupt.requested = True
        return made(self, part, shares, seeds)

    monkeypatch.setattr(Subject, "_run_part", cut)
    assert main(["falsify", *words, "--out", str(out)]) == 130
    monkeypatch.setattr(Subject, "_run_part", made)
    capsys.readouterr()
    kept = len(list((out / "journal").glob("*.npz")))
    assert kept > 0
    _, resumed = hunted(capsys, *words, "--out", str(out), "--resume")
    assert {**resumed, "page": ""} == {**whole, "page": ""}
    assert main(["falsify", *words, "--seed", "9", "--out", str(out), "--resume"]) == 2
    assert "made with another seed;" in capsys.readouterr().err


def test_the_space_of_a_study_is_that_of_its_columns(study: Any) -> None:
    made = read_study(study(TRUE), {})
    space = space_of(made)
    assert {factor.name for factor in space.factors} == {key for key in RUNS if key != "n"}
    nominal = space.nominal()
    assert away(space, nominal) == []
    line = space.values(nominal[None], np.array([1]))[0]
    keys = [field.key for field in made.design.fields]
    assert line[keys.index("vehicle.start.y")] == pytest.approx(0.0, abs=1e-12)
    assert away(space, np.where(np.arange(len(nominal)) == 2, 0.99, nominal)) == [2]


def test_what_cannot_be_hunted_is_refused(study: Any, capsys: pytest.CaptureFixture[str]) -> None:
    made = read_study(study(TRUE), {})
    assert objective_of(made, None).name == "contact"
    assert objective_of(made, "gbt41630").limits
    with pytest.raises(BadInput, match="--requirement: final heeding: no requirement of this name; did you mean"):
        objective_of(made, "final heeding")
    assert main(["falsify"]) == 2
    assert main(["falsify", "no-such-study"]) == 2
    assert main(["falsify", study(TRUE), "--budget", "3"]) == 2
    assert "expected a number from 50" in capsys.readouterr().err


@pytest.mark.skipif(not can_compile(), reason="no C compiler")
def test_beside_their_controller_our_vehicle_is_native(study: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the bits of the models in process, which ``--fmus none`` takes."""
    made = read_study(study(TRUE), {"stop_time": "2"})
    theirs = str(native_fmu_of(MODELS["controller"]))
    used: list[tuple[str, set[str]]] = []

    def drive(scenario: Scenario, files: Any, *, kind: str, foreign: Any) -> SimulationResult:
        used.append((kind, set(files)))
        return run_scenario(scenario, files, kind=kind, foreign=foreign)

    monkeypatch.setattr(begin, "run_scenario", drive)
    job, seeds = make_job(made), made.design.seeds[:2]
    rows = [
        begin._task(made, parser().parse_args(["falsify", "drivers.yaml", "--controller", theirs, *words])).work(
            job, Chunk(0, 0, made.design.values[:2], seeds)
        )
        for words in ([], ["--fmus", "none"])
    ]
    assert used == [("native", set(MODELS))] * 2 + [("none", set())] * 2
    assert np.array_equal(rows[0], rows[1], equal_nan=True)


def test_resume_of_a_hunt_that_has_not_begun_begins_it(tmp_path: Path) -> None:
    begin._open(tmp_path / "journal", "{}", resume=True)
    assert (tmp_path / "journal" / "about.json").read_text() == "{}"
    (tmp_path / "journal" / "about.json").write_bytes(b"\xff")
    with pytest.raises(BadInput, match="another description, which is damaged"):
        begin._open(tmp_path / "journal", "{}", resume=True)


@pytest.mark.parametrize(
    "change",
    [
        {"margins": np.zeros(3)},
        {"margins": np.array([np.nan, 1.0])},
        {"words": np.array(["a"])},
        {"words": np.array([1, 2])},
        {"words": np.array(["a", None], dtype=object)},
    ],
)
def test_a_journal_that_says_something_else_is_made_again(
    change: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shares, seeds = np.zeros((2, 1)), np.array([1, 2])
    good: dict[str, Any] = {
        "shares": shares,
        "seeds": seeds,
        "margins": np.array([0.1, -0.1]),
        "words": np.array(["a", "b"]),
    }
    part = tmp_path / "000000.npz"
    np.savez(part, **good)
    found = _read_part(part, shares, seeds)
    assert found is not None
    assert found.words.tolist() == ["a", "b"]
    np.savez(part, **{**good, **change})
    assert _read_part(part, shares, seeds) is None
    assert "made again" in capsys.readouterr().err
    whole = part.read_bytes()
    part.write_bytes(whole[: len(whole) // 2])
    assert _read_part(part, shares, seeds) is None
