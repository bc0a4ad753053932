"""The fixed list of mistakes: it covers the packages, and a mistake in it is put where it belongs and detected."""

import ast

import pytest

from tests.mutants.fixed import PROJECT, ROOT, Row, codes_of, detected_by, function_around, located, read_table
from tests.mutants.sites import mutants_of

GEOMETRY = ROOT / "modelkit" / "geometry.py"
ROW = Row("modelkit/geometry.py", "at_a < 0.0", "(at_a >= 0.0)", 1, "modelkit/test_geometry.py::test_cone")


def test_eighty_mistakes_of_all_packages_are_listed_once() -> None:
    rows = read_table()
    assert len({row[:4] for row in rows}) == len(rows) >= 80
    assert {row.file.split("/")[0] for row in rows} >= set(PROJECT) - {"apa_cosim"}, "apa_cosim only hands on"
    assert len({row.file.rpartition("/")[0] for row in rows}) > 30


def test_each_mistake_is_in_the_code() -> None:
    """Whoever changes a line of the list puts the mistake into the new line, and sees its test detect it there."""
    gone = [f"{row.file}: {row.before}" for row in read_table() if located(row) is None]
    assert not gone, f"tests/mutants/fixed.tsv: not in the code any more: {gone}"


def test_each_test_of_the_list_is_there() -> None:
    tests = {row.test for row in read_table()}
    gone = [test for test in tests if f"def {test.split('::')[1]}(" not in text_of(test.split("::")[0])]
    assert not gone, f"tests/mutants/fixed.tsv: no such test: {gone}"


def text_of(file: str) -> str:
    return (ROOT / "tests" / file).read_text(encoding="utf-8")


def test_a_mistake_that_is_not_in_the_code_is_not_located() -> None:
    assert located(ROW) is not None
    assert located(ROW._replace(count=9)) is None
    assert located(ROW._replace(file="modelkit/no_such_file.py")) is None


def test_the_function_around_a_mistake_is_the_outermost_one() -> None:
    tree = ast.parse(GEOMETRY.read_text(encoding="utf-8"))
    spans = {node.name: (node.lineno, node.end_lineno) for node in tree.body if isinstance(node, ast.FunctionDef)}
    known = {code.co_name for code in codes_of(compile(tree, "geometry", "exec"))}
    for mutant in mutants_of(ROOT, GEOMETRY):
        around = function_around(mutant)
        if around is not None:
            assert spans[around.name][0] < mutant.line <= (around.end_lineno or 0)
            assert around.name in known


@pytest.mark.release
def test_a_mistake_is_detected_and_no_mistake_is_not() -> None:
    import modelkit.geometry  # noqa: F401  # in this process, so that the forked one has it

    assert detected_by(located(ROW), [ROW.test]) == ROW.test
    assert detected_by(None, [ROW.test]) == ""
