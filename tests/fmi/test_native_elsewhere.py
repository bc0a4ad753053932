"""Native FMUs of other platforms, run under Wine and QEMU where these are installed, against those of linux64."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import toy_model
from fmpy import read_model_description

from fmus.native.fmu import build
from fmus.native.library_cache import C_FILES
from fmus.native.platforms import LINUX, LINUX_ARM, WINDOWS
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.session.session import run_scenario
from tests.fmi.test_native_host import HERE

STEPS = 300
DRIVES = ("guo2015-case4", "apa-parallel", "hsic")
ARM_SYSROOT = Path("/usr/aarch64-linux-gnu")


class Elsewhere(NamedTuple):
    """How a program for another platform is made and run here."""

    platform: str
    target: str
    suffix: str
    command: tuple[str, ...]
    """What runs the program."""
    needs: bool


WINE = shutil.which("wine64") or "/usr/lib/wine/wine64"
PLACES = (
    Elsewhere("linux64", LINUX.triple, "", (), True),
    Elsewhere("win64", WINDOWS.triple, ".exe", (WINE,), Path(WINE).exists()),
    Elsewhere(
        "aarch64-linux",
        LINUX_ARM.triple,
        "",
        ("qemu-aarch64", "-L", str(ARM_SYSROOT)),
        shutil.which("qemu-aarch64") is not None and ARM_SYSROOT.is_dir(),
    ),
)
pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux") or not any(place.needs for place in PLACES[1:]), reason="needs Wine or QEMU"
)


def rows(place: Any, fmu: Any, folder: Any, steps: Any, size: Any, *words: Any) -> Any:
    """Return the Real outputs of each step, diagnostics too, as a program for ``place`` saw them."""
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    description = read_model_description(str(fmu), validate=False)
    outputs = [v for v in description.modelVariables if v.causality in ("output", "local") and v.type == "Real"]
    (library,) = (folder / "binaries" / place.platform).iterdir()
    program = folder / f"host{place.suffix}"
    flags = ["-std=gnu11", "-O1", f"-I{C_FILES}", str(HERE / "host.c"), "-o", str(program)]
    libraries = [] if place.suffix else ["-ldl", "-lm"]
    command = [sys.executable, "-m", "ziglang", "cc", "-target", place.target, *flags, *libraries]
    subprocess.run(command, check=True, capture_output=True)
    given = [str(steps), str(size), *(str(item.valueReference) for item in outputs), *words]
    env = {**os.environ, "WINEPREFIX": str(folder / "wine"), "WINEDEBUG": "-all"}
    done = subprocess.run(
        [*place.command, str(program), "run", str(library), description.guid, *given],
        capture_output=True, text=True, env=env, check=False, timeout=300,
    )  # fmt: skip
    assert done.returncode == 0, (done.returncode, done.stdout[-500:], done.stderr[-500:])
    return [[float.fromhex(word) for word in line.split()] for line in done.stdout.splitlines()]


def is_same(place: Any, fmu: Any, folder: Any, steps: Any, size: Any, *words: Any) -> None:
    """Compare the outputs; other C libraries may round sin and tan differently in the last bit."""
    if not place.needs:
        pytest.skip(f"no way to run {place.platform} here")
    here = rows(PLACES[0], fmu, folder / "here", steps, size, *words)
    there = rows(place, fmu, folder / "there", steps, size, *words)
    assert len(here) == len(there) == steps
    assert len(set(map(tuple, here))) > 100
    for mine, its in zip(here, there, strict=True):
        assert its == pytest.approx(mine, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("place", PLACES[1:], ids=lambda place: place.platform)
def test_other_platforms_give_the_same_numbers(place: Any, tmp_path: Path) -> None:
    fmu = build(toy_model.MODEL, tmp_path / "fmu", [place.platform for place in PLACES if place.needs])
    known = read_model_description(str(fmu), validate=False).modelVariables
    force = next(item for item in known if item.name == "force[1]")
    is_same(place, fmu, tmp_path, STEPS, 0.01, f"real:{force.valueReference}=0.3")


def word(variable: Any, value: Any) -> Any:
    """Return what sets a variable, as the host program reads it."""
    kind = {"Real": "real", "Boolean": "bool"}.get(variable.type, "int")
    return f"{kind}:{variable.valueReference}={float(value)!r}"


def written(drive: Any, name: Any, fmu: Any, path: Any) -> Any:
    """Write what a model was given in a drive, parameters and then inputs; return how many steps, and their size."""
    scenario = load_scenario(drive, [])
    signals = run_scenario(scenario).recording.signals
    known = {item.name: item for item in read_model_description(str(fmu), validate=False).modelVariables}
    lines = [" ".join(word(known[key], value) for key, value in dict(getattr(scenario, name)).items())]
    inputs = {key: item for key, item in known.items() if item.causality == "input"}
    seen = {key: signals[f"{name}.{key}"] for key in inputs}
    steps = len(next(iter(seen.values()))) - 1
    lines += [" ".join(word(item, seen[key][k]) for key, item in inputs.items()) for k in range(steps)]
    path.write_text("\n".join([*lines, ""]), encoding="ascii")
    return steps, scenario.step_ns * 1e-9


@pytest.mark.parametrize("place", PLACES[1:], ids=lambda place: place.platform)
@pytest.mark.parametrize("name", ["vehicle", "controller"])
def test_other_platforms_drive_the_same(place: Any, name: str, tmp_path: Path) -> None:
    """Each model is given what it was given in shipped scenarios."""
    fmu = build(MODELS[name], tmp_path / "fmu", [place.platform for place in PLACES if place.needs])
    for drive in DRIVES:
        folder = tmp_path / drive
        folder.mkdir()
        steps, size = written(drive, name, fmu, folder / "inputs.txt")
        is_same(place, fmu, folder, steps, size, f"file:{folder / 'inputs.txt'}")
