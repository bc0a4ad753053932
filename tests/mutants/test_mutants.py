"""Some of the mistakes of ``make mutants``: they can be made, and the scenarios and step tests find them."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from tests.mutants.__main__ import COUNT, SEED
from tests.mutants.listed import listed
from tests.mutants.printed import printed
from tests.mutants.runner import ROOT, ask, checkout
from tests.mutants.sites import SYSTEMS, Mutant, drawn, files_of, mutants_of

EQUIVALENT = yaml.safe_load((Path(__file__).parent / "equivalent.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize(("mutants", "count"), [(listed(ROOT), 20), (printed(ROOT), 30)])
def test_those_listed_each_say_something_else(mutants: list[Mutant], count: int) -> None:
    assert len({mutant.name for mutant in mutants}) == len(mutants) == count
    for mutant in mutants:
        text = (ROOT / mutant.file).read_text(encoding="utf-8")
        assert ast.dump(ast.parse(mutant.put_into(text))) != ast.dump(ast.parse(text)), mutant.name


def test_those_drawn_are_of_all_papers_and_do_not_depend_on_other_files() -> None:
    mutants = drawn(ROOT, COUNT, SEED)
    assert {mutant.system for mutant in mutants} == set(SYSTEMS)
    assert len({mutant.name for mutant in mutants}) == COUNT
    assert drawn(ROOT, 10, SEED) == mutants[:10] != drawn(ROOT, 10, SEED + 1)
    for mutant in mutants:
        text = (ROOT / mutant.file).read_text(encoding="utf-8")
        assert ast.dump(ast.parse(mutant.put_into(text))) != ast.dump(ast.parse(text)), mutant.name


def test_what_changes_nothing_is_named_with_its_reason() -> None:
    known = {mutant.name for system in SYSTEMS for file in files_of(ROOT, system) for mutant in mutants_of(ROOT, file)}
    assert set(EQUIVALENT) <= known
    assert all(len(reason) > 20 for reason in EQUIVALENT.values())


def test_numbers_signs_comparisons_guards_rows_are_changed() -> None:
    kinds = {mutant.kind for file in files_of(ROOT, "guo2015") for mutant in mutants_of(ROOT, file)}
    assert kinds == {"number", "operator", "sign", "comparison", "guard", "extreme", "row"}


@pytest.mark.release
def test_a_checkout_without_mistake_passes() -> None:
    with checkout() as copy:
        assert ask("step tests", "guo2015", copy) == ""
        broken = copy / "controller_fmu" / "guo2015" / "legs.py"
        broken.write_text(broken.read_text(encoding="utf-8") + "\nraise RuntimeError\n", encoding="utf-8")
        assert ask("step tests", "guo2015", copy) != ""


@pytest.mark.release
@pytest.mark.parametrize("every", [9])
def test_some_of_the_twenty_are_found(every: int) -> None:
    words = [sys.executable, "-m", "tests.mutants", "--listed", "--every", str(every)]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "3 of 3 found" in done.stdout


@pytest.mark.release
def test_one_in_ten_of_the_printed_is_found_by_the_tests_of_what_is_printed() -> None:
    words = [sys.executable, "-m", "tests.mutants", "--printed", "--every", "10"]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert "3 of 3 found" in done.stdout, done.stdout + done.stderr


def test_a_text_that_is_not_there_is_refused() -> None:
    mutant = Mutant("controller_fmu/guo2015/legs.py", 1, 0, 3, "abc", "def", "number")
    with pytest.raises(AssertionError):
        mutant.put_into("xyz")
