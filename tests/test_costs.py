"""Cost of the tests: what is measured, to whom a shared fixture is charged, and what the table says."""

from pathlib import Path
from types import SimpleNamespace

from tests.costs import CostTable, cost_of_files, function_of, is_slow, read_costs, write_costs


def report(test: str, cost: float, shared: list[list[str]], made: list[list[object]]) -> SimpleNamespace:
    return SimpleNamespace(nodeid=f"tests/{test}", cost=cost, shared=shared, made=made, when="call")


def test_a_shared_fixture_is_divided_among_those_that_use_it() -> None:
    table, fixture = CostTable(), ["tests/a", "fmus"]
    table.pytest_runtest_logreport(report("a/test_a.py::test_one[x]", 1.0, [fixture], [[*fixture, 6.0]]))
    table.pytest_runtest_logreport(report("a/test_a.py::test_one[y]", 2.0, [fixture], []))
    table.pytest_runtest_logreport(report("a/test_b.py::test_two", 0.5, [fixture], []))
    table.pytest_runtest_logreport(report("a/test_b.py::test_three", 0.1, [], []))
    assert table.costs() == {"a/test_a.py::test_one": 7.0, "a/test_b.py::test_two": 2.5, "a/test_b.py::test_three": 0.1}


def test_the_table_keeps_what_costs_something(tmp_path: Path) -> None:
    file = tmp_path / "costs.tsv"
    write_costs({"b.py::two": 1.26, "a.py::one": 0.3, "a.py::none": 0.01}, file)
    assert read_costs(file) == {"a.py::one": 0.3, "b.py::two": 1.3}
    assert file.read_text(encoding="utf-8").splitlines()[1:] == ["0.3\ta.py::one", "1.3\tb.py::two"]


def test_slow_is_what_costs_three_tenths_of_a_second() -> None:
    costs = {"a.py::one": 0.2, "a.py::two": 0.3}
    assert [is_slow(f"tests/a.py::{name}[x]", costs) for name in ("one", "two", "new")] == [False, True, False]
    assert function_of("tests/a.py::one[x::y]") == "a.py::one"
    assert cost_of_files(costs) == {"a.py": 0.5}


def test_the_report_of_a_process_that_crashed_has_no_cost() -> None:
    table = CostTable()
    table.pytest_runtest_logreport(SimpleNamespace(nodeid="tests/a.py::one", when="???"))
    assert table.costs() == {}
