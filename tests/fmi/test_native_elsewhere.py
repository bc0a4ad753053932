"""Native FMUs of other platforms, run under Wine and QEMU where these are installed, against those of linux64."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import NamedTuple

import pytest
from fmpy import read_model_description
from test_native_host import HERE

from fmus.native.fmu import build
from fmus.native.platforms import LINUX, LINUX_ARM, WINDOWS
from fmus.native.sources import C_FILES
from modelkit.vocabulary import Prompt

STEPS = 300
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


@pytest.fixture
def fmu(model, tmp_path):
    """The FMU with a binary for every place that can be run here."""
    return build(model, tmp_path / "fmu", [place.platform for place in PLACES if place.needs])


def held(description):
    """Return the inputs to hold: the driver of the vehicle is told to reverse, its wheel to turn."""
    wanted = {"prompt": f"int:{{}}={int(Prompt.REVERSE)}", "steering_wheel_request": "real:{}=3.5"}
    wanted |= {"steering_active": "bool:{}=1", "force[1]": "real:{}=0.3"}
    inputs = {item.name: item.valueReference for item in description.modelVariables if item.causality == "input"}
    return [text.format(inputs[name]) for name, text in wanted.items() if name in inputs]


def rows(place, fmu, folder):
    """Return the Real outputs of each step, as a program for ``place`` saw them."""
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    description = read_model_description(str(fmu), validate=False)
    outputs = [v for v in description.modelVariables if v.causality == "output" and v.type == "Real"][:40]
    (library,) = (folder / "binaries" / place.platform).iterdir()
    program = folder / f"host{place.suffix}"
    flags = ["-std=gnu11", "-O1", f"-I{C_FILES}", str(HERE / "host.c"), "-o", str(program)]
    libraries = [] if place.suffix else ["-ldl", "-lm"]
    command = [sys.executable, "-m", "ziglang", "cc", "-target", place.target, *flags, *libraries]
    subprocess.run(command, check=True, capture_output=True)
    words = [str(STEPS), "0.01", *(str(item.valueReference) for item in outputs), *held(description)]
    env = {**os.environ, "WINEPREFIX": str(folder / "wine"), "WINEDEBUG": "-all"}
    done = subprocess.run(
        [*place.command, str(program), "run", str(library), description.guid, *words],
        capture_output=True, text=True, env=env, check=False, timeout=300,
    )  # fmt: skip
    assert done.returncode == 0, (done.returncode, done.stdout[-500:], done.stderr[-500:])
    return [[float.fromhex(word) for word in line.split()] for line in done.stdout.splitlines()]


@pytest.mark.parametrize("place", PLACES[1:], ids=lambda place: place.platform)
def test_other_platforms_give_the_same_numbers(place, fmu, tmp_path):
    """Their C libraries may round sin and tan differently in the last bit."""
    if not place.needs:
        pytest.skip(f"no way to run {place.platform} here")
    here = rows(PLACES[0], fmu, tmp_path / "here")
    there = rows(place, fmu, tmp_path / "there")
    assert len(here) == len(there) == STEPS
    assert here[-1] != here[0]
    for mine, its in zip(here, there, strict=True):
        assert its == pytest.approx(mine, rel=1e-9, abs=1e-9)
