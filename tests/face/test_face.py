"""What ``import apa_cosim`` gives, pinned: names, signatures, and what they return."""

import inspect
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import apa_cosim as apa
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.kinds import fastest_kind

PINNED = {
    "compare": "(a, b, *, absolute, relative, time, signals)",
    "judge": "(run, *requirements)",
    "load_scenario": "(name, changes)",
    "read_log": "(path)",
    "read_table": "(path)",
    "run": "(scenario, changes, *, fmus, log, controller, vehicle)",
    "scenario_names": "()",
    "sweep": "(study, changes, *, folder, first, every, resume)",
}


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return tmp_path_factory.mktemp("log") / "run.mcap"


@pytest.fixture(scope="module")
def case4(log: Any) -> Any:
    return apa.run("guo2015-case4", fmus="native", log=log)


def bare(function: Any) -> str:
    signature = inspect.signature(function)
    names = [
        item.replace(default=inspect.Parameter.empty, annotation=inspect.Parameter.empty)
        for item in signature.parameters.values()
    ]
    return str(inspect.Signature(names))


def test_the_names_are_pinned() -> None:
    assert sorted(name for name in apa.__all__ if name[0].islower()) == sorted(PINNED)
    assert {name: bare(getattr(apa, name)) for name in PINNED} == PINNED
    assert {"BadInput", "Run", "Scenario", "StudyTable", "Summary"} <= set(dir(apa))


def test_nothing_is_imported_before_it_is_used() -> None:
    code = "import sys, apa_cosim; print([name for name in sys.modules if name.startswith(('numpy', 'orchestrator'))])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="parc"):
        apa.parc  # noqa: B018


def test_a_run_is_arrays_and_a_verdict(case4: Any) -> None:
    assert (case4.outcome, case4.reason) == ("parked", "all checks passed")
    assert case4["vehicle.pose.x"].shape == case4.t.shape
    assert case4["vehicle.pose.x"][-1] == case4.summary.final.x
    assert case4.unit("vehicle.pose.x") == "m"
    assert repr(case4).startswith("<Run guo2015-case4: parked")


def test_a_misspelt_signal_says_what_was_meant(case4: Any) -> None:
    with pytest.raises(KeyError, match=r"vehicle\.pose\.x"):
        case4["vehicle.pose.X"]


def test_a_log_gives_the_same_run_back(case4: Any, log: Any) -> None:
    again = apa.read_log(log)
    assert again.summary.as_json()["final"] == case4.summary.as_json()["final"]
    assert all(np.array_equal(again[name], values, equal_nan=True) for name, values in case4.signals.items())


@pytest.mark.parametrize("value", [3.0, 3, "3 1/m"])
def test_changes_are_numbers_or_texts_with_units(value: Any) -> None:
    assert apa.load_scenario("guo2015-case4", {"controller.guo2015.k4": value}).controller["guo2015.k4"] == 3.0


def test_changes_may_be_lists_of_mappings() -> None:
    profile = [{"at": 0, "speed": 0.5}]
    changed = apa.load_scenario("guo2015-case4", {"vehicle.driver.profile": profile, "step": 0.02})
    assert (changed.vehicle["driver.profile[1].speed"], changed.step_ns) == (0.5, 20_000_000)


def test_a_wrong_key_is_one_clear_error() -> None:
    with pytest.raises(apa.BadInput, match="k4"):
        apa.load_scenario("guo2015-case4", {"controller.guo2015.k44": 1.0})


def test_a_loaded_scenario_takes_no_more_changes() -> None:
    with pytest.raises(TypeError, match="load_scenario"):
        apa.run(apa.load_scenario("guo2015-case4"), {"step": 0.02})


def test_a_run_is_judged_by_shipped_sets_and_files(case4: Any, tmp_path: Path) -> None:
    own = tmp_path / "own.yaml"
    own.write_text("- {id: slow, signal: vehicle.speed, max_abs: 1 m/s, source: me}\n", encoding="utf-8")
    fast = {"id": "fast", "signal": "vehicle.speed", "max_abs": "2 m/s"}
    checks = {check.id: check for check in apa.judge(case4, "gbt41630", own, fast)}
    assert checks["manoeuvres"].passed
    assert checks["fast"].passed
    assert not checks["slow"].passed
    assert checks["slow"].value == pytest.approx(-1.5)


def test_two_runs_are_compared(case4: Any) -> None:
    other = apa.run("guo2015-case4", {"controller.guo2015.k4": 3.0}, fmus="native")
    assert apa.compare(case4, case4).passed
    found = apa.compare(case4, other, absolute=1e-6, signals=["vehicle.pose.*"])
    assert not found.passed
    assert [change.name for change in found.parameters] == ["controller.guo2015.k4"]


def test_the_picture_and_the_replay(case4: Any, tmp_path: Path) -> None:
    panels = [axes for axes in case4.plot().axes if axes.get_ylabel() != "steering wheel [deg]"]
    assert [axes.get_title("left")[:3] for axes in panels] == ["(d)", "(a)", "(b)", "(c)"]
    ribbons = [[type(item).__name__ for item in axes.collections].count("PolyCollection") for axes in panels]
    assert ribbons == [0, 1, 1, 1]
    assert case4._repr_html_().startswith("<iframe srcdoc=")
    assert case4.save(tmp_path / "out").name == "report.html"
    assert {file.name for file in (tmp_path / "out").iterdir()} == {"report.html", "overview.png", "summary.json"}


def test_a_replay_is_not_saved_beside_the_log_of_another_run(case4: Any, tmp_path: Path) -> None:
    driven = ["run", "guo2015-case1", "--fmus", "none", "--set", "stop_time=1", "--no-page", "--out", str(tmp_path)]
    subprocess.run([sys.executable, "-m", "orchestrator", *driven], capture_output=True, check=False)
    assert (tmp_path / "run.mcap").is_file()
    with pytest.raises(BadInput, match="the log of another run"):
        case4.save(tmp_path)
    assert not (tmp_path / "report.html").exists()
    assert apa.read_log(tmp_path).save(tmp_path).is_file()


def test_signals_as_a_data_frame(case4: Any) -> None:
    pd = pytest.importorskip("pandas")
    frame = case4.to_pandas()
    assert isinstance(frame, pd.DataFrame)
    assert frame["vehicle.speed"].iloc[-1] == case4["vehicle.speed"][-1]
    assert frame.index.name == "t"


def test_a_study_is_a_table_and_any_row_a_run(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    table = apa.sweep("guo2015-trial", folder=tmp_path, every=10)
    assert len(table) == len(table["outcome"]) == len(apa.read_table(table.path))
    assert 0.0 < table.share() < 1.0
    row = table.replay(1)
    assert (row.outcome, row.summary.final.x) == (table["outcome"][1], table["final.x"][1])
    assert {fmu["kind"] for fmu in row.recording.info["fmus"]} == {fastest_kind()}
