"""Each benchmark runs, and its C compiles with the models' C as it is now and does what CPython does."""

import ast
import importlib
import importlib.util
import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.__main__ import main, measured
from benchmarks.results import Measurement, lasting, read_table, write_table
from benchmarks.rounds import in_turn
from modelkit.variables import flatten

BENCHMARKS = sorted(file.stem.removeprefix("bench_") for file in Path("benchmarks").glob("bench_*.py"))
PROJECT = ("modelkit", "vehicle_fmu", "controller_fmu", "fmus", "orchestrator", "apa_cosim")
NEEDS_LITTLE = ("cosim",)


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Import a benchmark; what it compares with need not be installed."""

    def load(name: Any, *needs: Any) -> Any:
        for package in needs:
            pytest.importorskip(package)
        return importlib.import_module(f"benchmarks.{name}")

    return load


@pytest.mark.filterwarnings("ignore")
def test_bodies(bench: Any) -> None:
    module = bench("bench_vehicle", "vehiclemodels")
    library = module.compiled()
    for name, (_, run) in module.bodies(0).items():
        end = run(40)
        pose = (end if name == "kinematic" else end.motion).pose
        assert module.compiled_bodies(library, 40)[name][1](40) == pose.x != 0.0
    assert len({run(100) for _, run in module.vehicles(library, 0).values()}) == 3


@pytest.mark.release
@pytest.mark.filterwarnings("ignore")
def test_controllers(bench: Any) -> None:
    module = bench("bench_controllers", "cvxpy", "daqp", "osqp", "skfuzzy")
    library, source = module.compiled(), np.random.default_rng(1)
    points = source.uniform(-3.0, 3.0, (50, 2))
    ours = [module.infer(a, b, *module.FUZZY) for a, b in points.tolist()]
    assert library.bench_infer(points.ctypes.data, len(points)) == sum(ours) != 0.0
    now, stages, weights = module.random_problem(source)
    flat = [np.array(flatten(item)) for item in (stages, weights)]
    found = library.bench_solve(1, *now, *(item.ctypes.data for item in flat))
    assert found == module.solve(now, stages, weights, 1e-10, 40).nodes[0].u


@pytest.mark.parametrize("file", [*Path("benchmarks").glob("*.py"), *Path("docs").glob("*.py")], ids=str)
def test_what_it_imports_of_the_project_is_there(file: Path) -> None:
    """Neither folder is type-checked, and most of the scripts run before a release only."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] in PROJECT:
            module = importlib.import_module(node.module or "")
            for name in node.names:
                assert hasattr(module, name.name) or importlib.util.find_spec(f"{node.module}.{name.name}"), name.name


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in NEEDS_LITTLE else pytest.mark.release) for name in BENCHMARKS]
)
def test_runs_at_its_smallest_size(name: str, capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main([name, "--smallest", "--table", str(tmp_path / "table.tsv")]) == 0
    assert f"== {name}" in capfd.readouterr().out
    assert not (tmp_path / "table.tsv").exists(), "the smallest size says nothing about speed"


def test_a_benchmark_that_fails_or_measures_nothing_is_counted(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.executable", "false")
    assert main(["sweep", "cosim", "--smallest"]) == 2
    monkeypatch.setattr("sys.executable", "true")
    assert main(["sweep", "--smallest"]) == 1
    assert "sweep recorded nothing" in capfd.readouterr().out
    with pytest.raises(SystemExit) as end:
        main(["swep"])
    assert end.value.code == 2
    assert "no benchmark swep; there are" in capfd.readouterr().err


def test_new_results_replace_those_of_the_same_benchmark_only(tmp_path: Path) -> None:
    def row(benchmark: str, value: str) -> Measurement:
        return Measurement(benchmark, "one step", value, "us", "x86_64, 2 cores", "2026-11-26", "abc")

    file = tmp_path / "table.tsv"
    write_table([row("sweep", "1"), row("step", "2")], file)
    write_table([row("sweep", "3")], file)
    assert read_table(file) == [row("step", "2"), row("sweep", "3")]


def test_a_busy_machine_gives_processor_times_only() -> None:
    wall = Measurement("step", "one step", "2", "us", "x86_64, 2 cores", "2026-11-26", "abc")
    processor = wall._replace(quantity="one step, processor time")
    assert lasting([wall, processor], was_idle=True) == [wall, processor]
    assert lasting([wall, processor], was_idle=False) == [processor]


def test_rounds_end_when_the_medians_are_known() -> None:
    calls: list[str] = []

    def work(name: str, values: list[float]) -> Callable[[], float]:
        each = itertools.cycle(values)

        def once() -> float:
            calls.append(name)
            return next(each)

        return once

    found = in_turn({"a": work("a", [1.0, 1.001]), "b": work("b", [2.0])}, 30)
    assert list(map(len, found.values())) == [3, 3]
    assert calls == ["a", "b"] * 4, "in turn, the first round does not count"
    assert len(in_turn({"a": work("a", [1.0, 2.0])}, 9)["a"]) == 9
    assert in_turn({"a": work("a", [1.0])}, 9, budget=0.0)["a"] == [1.0], "one round, whatever it takes"
    assert in_turn({"a": work("a", [1.0])}, 1)["a"] == [1.0]


def test_what_the_table_has_of_this_commit_is_not_measured_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    row = Measurement("step", "one step", "2", "us", "x86_64, 2 cores", "2026-11-26", "abc")
    file = tmp_path / "table.tsv"
    write_table([row, row._replace(benchmark="gym", commit="old"), row._replace(benchmark="live", commit="abc+")], file)
    monkeypatch.setattr("benchmarks.__main__.commit", lambda: "abc")
    assert measured(file) == {"step"}
    assert main(["step", "--resume", "--table", str(file)]) == 0
    assert "== step" not in capfd.readouterr().out
    monkeypatch.setattr("benchmarks.__main__.commit", lambda: "abc+")
    assert measured(file) == set(), "of changed files the table says nothing"
