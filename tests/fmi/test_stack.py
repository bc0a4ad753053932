"""How much stack the functions of a native FMU take: along every chain of calls, and what the FMU's page says of it."""

import re
import shutil
import subprocess
import zipfile
from pathlib import Path
from typing import Any

import pytest

from fmus.native.compilers import find_compiler
from fmus.native.fmu import PAGE
from fmus.native.platforms import LINUX
from fmus.native.sources import fmu_sources, unit_name
from tests.docs.scripts import script
from tests.fmi.conftest import ALL_MODELS
from tests.fmi.test_native_host import OTHERS, STACK

BOUND = STACK // 2
"""Bytes of stack that a call may take: the other half is for what the importer does, and for its logger."""


needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc, which writes a call graph")


EACH_CHANGE = {("Vehicle", 3), ("Controller_apa", 2)}
"""Models and versions of FMI: the deepest chain of a step is the model's, the same in both versions."""


@needs_gcc
@pytest.mark.parametrize(
    ("name", "fmi"),
    [
        pytest.param(name, fmi, marks=() if (name, fmi) in EACH_CHANGE else pytest.mark.release)
        for name in ALL_MODELS
        for fmi in (2, 3)
    ],
)
def test_no_chain_of_calls_takes_half_of_a_small_stack(name: str, fmi: int, tmp_path: Path) -> None:
    check_stack(ALL_MODELS[name], fmi, tmp_path)


@needs_gcc
@pytest.mark.release
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", OTHERS)
def test_no_chain_of_calls_of_other_fmus_does(name: str, fmi: int, tmp_path: Path) -> None:
    check_stack(OTHERS[name](), fmi, tmp_path)


def check_stack(model: Any, fmi: int, folder: Path) -> None:
    """Compile an FMU's sources and look at each chain of calls that begins in a function of FMI."""
    for name, text in fmu_sources(model, "{token}", fmi).items():
        (folder / name).write_text(text)
    options = ["-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-fcallgraph-info=su"]
    command = ["gcc", *options, f"-DFMI{fmi}_OVERRIDE_FUNCTION_PREFIX", "-c", unit_name(model, fmi), "-o", "x.o"]
    subprocess.run(command, check=True, cwd=folder)
    found = script("embedded").deepest((folder / "x.ci").read_text())
    public = {name: size for name, size in found.items() if name.startswith(f"fmi{fmi}")}
    assert len(public) == {2: 34, 3: 75}[fmi]
    assert public[f"fmi{fmi}DoStep"] > 100, "the step is in the graph"
    assert max(public.values()) <= BOUND, max(public.items(), key=lambda item: item[1])


@pytest.mark.parametrize("kind", ["native_fmus", pytest.param("fmi3_fmus", marks=pytest.mark.release)])
def test_the_page_of_an_fmu_states_its_largest_frame(request: pytest.FixtureRequest, kind: str, any_model: Any) -> None:
    with zipfile.ZipFile(request.getfixturevalue(kind)[any_model.name]) as archive:
        page = archive.read(PAGE).decode()
    (stated,) = re.findall(r"largest stack frame of its functions, those of a step among them, has (\d+) bytes", page)
    least = {"Controller": 6_000, "Controller_apa": 8_000}.get(any_model.name, 500)
    assert least < int(stated) < BOUND


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
def test_two_compilers_say_how_large_a_frame_is() -> None:
    text = "int f(int n) { volatile char room[5000]; room[n] = 1; return room[0]; }"
    for name in ("zig", "gcc"):
        made = find_compiler(name).link({"a.c": text}, ["a.c"], "a.so", LINUX)
        assert 4800 <= made.largest_frame <= 5200, name  # clang leaves out the red zone of 128 bytes
