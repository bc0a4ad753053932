"""The paired comparison of two systems and the sensitivity to tuning constants, without running a study."""

import ast
from pathlib import Path

import pytest

from benchmarks.paired import Pair, is_lost, report
from benchmarks.sensitivity import COLUMNS, SCALES, WITHOUT_RESULT, lines_in, without_effect
from benchmarks.tuning_constants import ARRAY, ROOT, can_vary, constants_of, marked, scaled, with_array

CODE = '''from enum import IntEnum
from typing import Annotated, NamedTuple

from modelkit.signal import Signal

LIMIT = 0.35
PAIRS = (0.1, 7)


class Kind(IntEnum):
    FIVE = 5


class Params(NamedTuple):
    gain: Annotated[float, Signal("1", "gain", 0.01, 99.0)] = 2.5


def f(x: tuple[float, ...]) -> float:
    """ü: 6.5"""
    return 1.7 * x[7] + 0.0 + 1.0
'''


@pytest.mark.parametrize(
    ("first", "second", "lost"),
    [
        ("parked", "gave up", True),
        ("gave up", "parked", False),
        ("gave up", "contact", True),
        ("gave up", "contact, standing", True),
        ("contact", "contact, standing", False),
        ("gave up", "false parked", True),
        ("parked", "parked", False),
    ],
)
def test_what_the_second_system_loses(first: str, second: str, lost: bool) -> None:
    assert is_lost(Pair(0, first, second)) is lost


def test_the_report_names_transitions_and_lost_rows() -> None:
    pairs = [Pair(0, "parked", "parked"), Pair(1, "parked", "gave up"), Pair(2, "gave up", "parked")]
    lines = report(pairs)
    assert lines[0] == "3 rows, 1 with the same outcome; parked 2 -> 2"
    assert lines[1] == "1 lost, 1 won"
    assert lines[-1] == "lost row 1: parked -> gave up"


def test_constants_are_numbers_that_tune(tmp_path: Path) -> None:
    (tmp_path / "code.py").write_text(CODE)
    found = constants_of(tmp_path, tmp_path)
    assert sorted(item.value for item in found) == [0.1, 0.35, 1.7, 2.5, 7]
    names = {item.value: item.name for item in found}
    assert names == {0.35: "LIMIT", 0.1: "PAIRS[1]", 7: "PAIRS[2]", 2.5: "Params.gain", 1.7: "f 1.7"}
    for item in found:
        changed = scaled(CODE, item, 1.4)
        ast.parse(changed)
        assert sum(a != b for a, b in zip(CODE.splitlines(), changed.splitlines(), strict=True)) == 1
    gain = next(item for item in found if item.value == 2.5)
    assert "= 1.75" in scaled(CODE, gain, 0.7)


def test_the_marks_of_real_constants_become_items_of_an_array(tmp_path: Path) -> None:
    (tmp_path / "code.py").write_text(CODE)
    found = constants_of(tmp_path, tmp_path)
    variable = [(number, item) for number, item in enumerate(found) if can_vary(item)]
    assert {item.name for _, item in variable} == {"LIMIT", "f 1.7"}
    text = marked(CODE, variable)
    marks = [line.split()[-1] for line in text.splitlines() if line.startswith("LIMIT")]
    code = f"static const double LIMIT = {marks[0]};\nstatic const double TABLE[1] = {{{marks[0]}}};\nx = {marks[0]};\n"
    changed, places = with_array(code, found)
    limit = next(number for number, item in variable if item.name == "LIMIT")
    assert places == [limit]
    assert f"#define LIMIT ({ARRAY}[{limit}])" in changed
    assert "TABLE[1] = {0.35}" in changed, "a table is initialised by constants alone"
    assert f"x = ({ARRAY}[{limit}]);" in changed


def test_every_constant_of_a_package_can_be_scaled() -> None:
    folder = ROOT / "controller_fmu" / "parking" / "planning"
    for item in constants_of(folder):
        ast.parse(scaled((ROOT / item.file).read_text(), item, 0.7))


def test_the_measured_constants_have_a_line_for_each_scale(tmp_path: Path) -> None:
    file = ROOT / "benchmarks" / "sensitivity.tsv"
    lines = lines_in(file)
    assert len({tuple(line[:4]) for line in lines}) == len(lines)
    assert {len(line) for line in lines} == {len(COLUMNS)}
    for scale in SCALES:
        assert len([line for line in lines if line[3] == f"{scale:g}"]) * len(SCALES) == len(lines)
    ran = [line for line in lines if tuple(line[4:]) != WITHOUT_RESULT]
    assert all(int(line[5]) >= int(line[6]) >= 0 for line in ran), "another outcome is another row"
    assert len(ran) > 0.9 * len(lines)
    few = tmp_path / "few.tsv"
    few.write_text("\n".join(["\t".join(COLUMNS), "a\tX\t1\t0.7\t2\t0\t0\t0\t0", "a\tX\t1\t1.4\t2\t1\t0\t0\t0"]))
    assert without_effect(few) == set(), "one scale is enough"
