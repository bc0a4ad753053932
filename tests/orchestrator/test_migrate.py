"""Old names are rejected in one line with the new one, and ``apa migrate`` rewrites files and touches no more."""

import errno
from pathlib import Path

import pytest
import yaml

from apa_cosim.testing import ClosedLoopRun, OpenLoopRun
from controller_fmu import APA
from modelkit.variables import variables
from orchestrator.cli import main
from orchestrator.evaluation.verdict.numbers import NUMBERS
from orchestrator.inputs.scenario.files import find_file
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.renamed_names import (
    METRICS,
    MOVED_VARIABLES,
    REMOVED_VARIABLES,
    SCENARIO_KEYS,
    SHIPPED_NAMES,
    VARIABLES,
    current_name,
    new_name,
)
from orchestrator.studies.sweep.study.study_file import load_study
from tests.fuzz.limits import ask

OLD = """\
# a comment of mine
base: guo2015-case4
every: {controller: 2}   # slower
limits:
  - house
  - {id: few, signal: shifts, max: 8, source: mine, where: slot}
ending: {done: [PARKED], over: []}
expect: parked
vehicle:
  driver: {"wobble": 0.1, obeys_stop: true}
  odometry.perfect: false
controller: {limit.wheel_off: 0.2, threshold: {wheel: 2 deg}}
faults: [{signal: vehicle.person.brake, kind: freeze, start: 100}]
"""
NEW = """\
# a comment of mine
extends: guo2015-case4
decimation: {controller: 2}   # slower
requirements:
  - project
  - {id: few, signal: manoeuvres, max: 8, source: mine, where: slot}
stop_condition: {succeeded: [PARKED], ended: []}
expected_outcome: parked
vehicle:
  driver: {"speed_oscillation_amplitude": 0.1, complies_with_stop: true}
  odometry.ideal: false
controller: {limit.steering_tracking_error: 0.2, threshold: {steering_angle_reached: 2 deg}}
faults: [{signal: vehicle.manual.brake, kind: stuck_at_last, start: 100}]
"""
STUDY = """\
scenario: guo2015-case3-105
within: {house: [house, gbt41630]}
set: {every.controller: 2, vehicle.driver.wobble_period: 2}
runs:
  grid: {"vehicle.road.slope, vehicle.road.bank": [0, 0.01]}
  monte_carlo: {n: 3, vehicle.driver.obeys_stop: {choice: [true]}}
measures: {most: {last: controller.shifts}}
"""
TEST = """\
model: vehicle
stop_time: 1
inputs: {person.drives: true}
expect: [{id: a, signal: person.brake, always: {max: 1}}]
"""


def migrated(folder: Path, text: str) -> str:
    file = folder / "old.yaml"
    file.write_bytes(text.encode())
    assert main(["migrate", str(file)]) == 0
    return file.read_bytes().decode()


def test_a_scenario_keeps_all_but_the_old_names(tmp_path: Path) -> None:
    assert migrated(tmp_path, OLD) == NEW
    assert migrated(tmp_path, OLD.replace("\n", "\r\n")) == NEW.replace("\n", "\r\n")
    assert migrated(tmp_path, NEW) == NEW
    assert load_scenario(str(tmp_path / "old.yaml")).decimation == {"controller": 2}


def test_a_study_and_an_open_loop_test_are_rewritten(tmp_path: Path) -> None:
    study = yaml.safe_load(migrated(tmp_path, STUDY))
    assert set(study["set"]) == {"decimation.controller", "vehicle.driver.speed_oscillation_period"}
    assert set(study["runs"]["grid"]) == {"vehicle.road.grade, vehicle.road.cross_slope"}
    assert study["within"] == {"house": ["project", "gbt41630"]}
    assert study["measures"] == {"most": {"last": "controller.manoeuvres"}}
    assert load_study(str(tmp_path / "old.yaml"))[0].name == "old"
    test = yaml.safe_load(migrated(tmp_path, TEST))
    assert (test["inputs"], test["expect"][0]["signal"]) == ({"manual.active": True}, "manual.brake")


@pytest.mark.parametrize("folder", SHIPPED_NAMES)
def test_shipped_files_of_an_earlier_name_are_rejected_with_the_new_one(folder: str, tmp_path: Path) -> None:
    for old, new in SHIPPED_NAMES[folder].items():
        with pytest.raises(BadInput, match=f"{old}: no .* of this name; it is called {new} now .apa migrate rewrites"):
            find_file(old, folder, folder, tmp_path)
        assert find_file(new, folder, folder, tmp_path).is_file()
    written = migrated(tmp_path, "base: apa-told  # mine\nlimits: [parked, house]\n")
    assert written == "extends: apa-external-slot  # mine\nrequirements: [parked, project]\n"


def test_output_and_check_leave_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "old.yaml"
    file.write_text(OLD)
    assert main(["migrate", str(file), "--output", "-"]) == 0
    assert capsys.readouterr().out == NEW
    assert main(["migrate", str(file), "--check"]) == 1
    assert "old.yaml:2: base -> extends" in capsys.readouterr().err
    assert main(["migrate", str(file), "--output", str(tmp_path / "new.yaml")]) == 0
    assert (file.read_text(), (tmp_path / "new.yaml").read_text()) == (OLD, NEW)
    assert main(["migrate", str(tmp_path / "new.yaml"), "--check"]) == 0


def test_old_and_new_name_together_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "both.yaml"
    file.write_text("limits: []\nrequirements: []\n")
    assert main(["migrate", str(file)]) == 2
    assert "requirements: has the old and the new name of this key" in capsys.readouterr().err
    assert file.read_text() == "limits: []\nrequirements: []\n"


@pytest.mark.parametrize(
    "text",
    [
        "start: {x: 1.?}\n",
        "a: {b: 1, c?}\n",
        "a :\t1\n",
        'expect: "p\\x61rked"\n',
        "a: !x 1\n",
        "[" * 50,
        "\ufeffa: 1\n",
    ],
)
def test_what_two_readers_of_yaml_read_differently_is_no_mistake_of_ours(text: str, tmp_path: Path) -> None:
    file = tmp_path / "odd.yaml"
    file.write_text(text, encoding="utf-8")
    answer = ask(["migrate", str(file)])
    assert not answer.mistake, answer.mistake
    assert answer.code in (0, 2)
    assert answer.err.splitlines()[-1].startswith("apa: ")


def test_many_keys_are_looked_through_at_once(tmp_path: Path) -> None:
    file = tmp_path / "many.yaml"
    file.write_text("".join(f"k{number}: 1\n" for number in range(5_000)))
    answer = ask(["migrate", str(file), "--check"], 10.0)
    assert (answer.code, answer.mistake) == (0, "")


def test_a_file_that_cannot_be_written_is_left_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, data: bytes) -> int:
        with path.open("wb") as file:
            file.write(data[: len(data) // 2])
        raise OSError(errno.ENOSPC, "no space", str(path))

    file = tmp_path / "old.yaml"
    file.write_text(OLD)
    file.chmod(0o640)
    with monkeypatch.context() as patched:
        patched.setattr(Path, "write_bytes", full)
        answer = ask(["migrate", str(file)])
    assert answer.code == 2
    assert "the disk is full" in answer.err
    assert file.read_text() == OLD
    assert main(["migrate", str(file)]) == 0
    assert (file.read_text(), file.stat().st_mode & 0o777) == (NEW, 0o640)


@pytest.mark.parametrize(
    ("sets", "new"),
    [
        ("every.controller=2", "decimation.controller"),
        ("limits=[]", "requirements"),
        ("ending.done=[PARKED]", "stop_condition.succeeded"),
        ("target.of=left", "target.reference_point"),
        ("task=run", "open_loop"),
        ("faults=[{signal: vehicle.speed, kind: drop}]", "dropout"),
        ("requirements=[{id: a, signal: speed, max: 1, where: polygons, source: x}]", "obstacles"),
        ("vehicle.driver={wobble: 0.1}", "vehicle.driver.speed_oscillation_amplitude"),
        ("controller.told.kind=1", "controller.external_slot.kind"),
    ],
)
def test_an_old_name_is_answered_with_the_new_one(sets: str, new: str) -> None:
    with pytest.raises(BadInput) as error:
        load_scenario("guo2015-case4", [sets])
    assert f"it is called {new} now" in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("words", "new"),
    [
        (["sweep", "guo2015-trial", "--every", "9"], "--stride now"),
        (["sweep", "guo2015-trial", "--workers=1"], "--jobs now"),
        (["hunt", "guo2015-trial"], "falsify"),
        (["list", "systems"], "controllers"),
    ],
)
def test_an_old_option_or_command_is_answered_with_the_new_one(
    words: list[str], new: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as end:
        main(words)
    assert end.value.code == 2
    assert new in capsys.readouterr().err


@pytest.mark.parametrize("cls", [ClosedLoopRun, OpenLoopRun])
def test_the_runs_of_the_fixtures_name_the_new_methods(cls: type) -> None:
    with pytest.raises(AttributeError, match="assert_requirements"):
        getattr(object.__new__(cls), "must_meet")  # noqa: B009 - mypy knows that it is not there


def test_the_table_holds_names_that_exist_and_no_old_one_does() -> None:
    names = {
        f"{owner}.{item.name}"
        for owner, model in (*MODELS.items(), ("controller", APA))
        for cls in (model.params, model.inputs, model.outputs)
        for item in variables(cls)
    }
    for old, new in VARIABLES.items():
        assert old.count(".") == new.count(".")
        assert any(name == new or name.startswith(f"{new}.") for name in names) or "preview" in new, new
        assert not any(name == old or name.startswith(f"{old}.") for name in names), old
    for old, new in MOVED_VARIABLES.items():
        assert any(name == new or name.startswith(f"{new}.") for name in names), new
        assert not any(name == old or name.startswith(f"{old}.") for name in names), old
    assert not [old for old in REMOVED_VARIABLES if any(f"{name}.".startswith(f"{old}.") for name in names)]
    assert set(METRICS.values()) <= NUMBERS.keys()
    assert not METRICS.keys() & NUMBERS.keys()
    top = {(old, new) for old, new in SCENARIO_KEYS.items() if "." not in old}
    assert {new for _, new in top} <= Scenario.model_fields.keys()
    assert not {old for old, _ in top} & Scenario.model_fields.keys()
    assert current_name("vehicle.person.lever") == "vehicle.manual.lever"
    assert new_name("shifts") == "manoeuvres"
    assert new_name("wobble") == "vehicle.driver.speed_oscillation_amplitude"
    assert new_name("nothing") == ""


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("controller.apa.drive.creep", "it is called controller.drive.creep_speed now"),
        ("controller.apa.drive.k1", "it is called controller.drive.k1 now"),
        ("controller.apa.plan.at_a_time", "this version has no such variable"),
    ],
)
def test_parameters_in_another_group_are_rejected_with_their_present_name(
    name: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "apa-parallel", "--set", f"{name}=1", "--out", str(tmp_path / "out")]) == 2
    assert said in capsys.readouterr().err
