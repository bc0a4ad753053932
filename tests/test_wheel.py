"""The wheel alone, in a fresh environment without any extra: what the documentation promises works there."""

import os
import shutil
import subprocess
import sys
import sysconfig
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from orchestrator.commands import COMMANDS
from orchestrator.simulation.cosim.fmu_files import can_compile

ROOT = Path(__file__).parents[1]
PACKAGES = ("apa_cosim", "modelkit", "vehicle_fmu", "controller_fmu", "fmus", "orchestrator")
FILES = ("pyproject.toml", "README.md", "LICENSE")
pytestmark = pytest.mark.release


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from a copy: building leaves folders beside the sources."""
    source, out = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("wheel")
    for name in PACKAGES:
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("dist", "__pycache__"))
    for name in FILES:
        shutil.copy(ROOT / name, source)
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(out), str(source)]
    subprocess.run(command, check=True)
    return next(out.glob("apa_cosim-*.whl"))


@pytest.fixture(scope="module")
def apa(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The command ``apa`` of an environment that has the wheel and what it requires, nothing else."""
    folder = tmp_path_factory.mktemp("environment") / "venv"
    subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    program = folder / ("Scripts" if os.name == "nt" else "bin")
    subprocess.run([program / "python", "-m", "pip", "install", "--quiet", "--no-compile", str(wheel)], check=True)
    return program / "apa"


@pytest.fixture(scope="module")
def full(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same with all extras: those of the environment that runs this."""
    if not can_compile():
        pytest.skip("needs a C compiler")
    folder = tmp_path_factory.mktemp("full") / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    program = folder / ("Scripts" if os.name == "nt" else "bin")
    code = "import sysconfig; print(sysconfig.get_path('purelib'))"
    place = subprocess.run([program / "python", "-c", code], capture_output=True, text=True, check=True).stdout.strip()
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-compile", "--no-deps", "--target", place]
    subprocess.run([*command, str(wheel)], check=True)
    Path(place, "extras.pth").write_text(sysconfig.get_path("purelib") + "\n")
    apa = program / "apa"
    apa.write_text(f"#!{program / 'python'}\nfrom orchestrator.cli import main\nraise SystemExit(main())\n")
    apa.chmod(0o755)
    return apa


def call(apa: Path, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "APA_DIST")}
    environment["XDG_CACHE_HOME"] = str(folder / "cache")
    environment.setdefault("ZIG_GLOBAL_CACHE_DIR", str(Path.home() / ".cache" / "zig"))  # the C library, built once
    return subprocess.run([apa, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_no_extra_is_there(apa: Path, tmp_path: Path) -> None:
    code = "import importlib.util as u, sys; sys.exit(any(map(u.find_spec, ('ziglang', 'pyarrow', 'dask', 'mkdocs'))))"
    subprocess.run([apa.with_name("python"), "-c", code], cwd=tmp_path, check=True)


def test_help_and_version(apa: Path, tmp_path: Path) -> None:
    assert "commands:" in call(apa, tmp_path, "--help").stdout
    assert call(apa, tmp_path, "--version").stdout.startswith("apa-cosim ")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(command: str, apa: Path, tmp_path: Path) -> None:
    done = call(apa, tmp_path, command, "--help")
    assert done.stdout.startswith(f"usage: apa {command}"), done.stderr


def installed(apa: Path) -> set[str]:
    """Return the files of the environment but for what Python compiles."""
    found = (path for path in apa.parents[1].rglob("*") if path.is_file() and path.suffix != ".pyc")
    return {str(path) for path in found}


def test_what_the_documentation_promises(apa: Path, tmp_path: Path) -> None:
    before = installed(apa)
    done = call(apa, tmp_path, "run", "guo2015-case4")
    assert done.returncode == 0, done.stderr
    made = {path.name for path in (tmp_path / "runs" / "guo2015-case4").iterdir()}
    assert made == {"run.mcap", "summary.json", "overview.png", "report.html"}
    done = call(apa, tmp_path, "test", "fault-*", "--out", "results")
    assert done.returncode == 0, done.stderr
    assert "8 of 8 scenarios passed" in done.stdout
    assert ElementTree.parse(tmp_path / "results" / "junit.xml").getroot().get("failures") == "0"
    assert call(apa, tmp_path, "list", "parameters", "steering").returncode == 0
    done = call(apa, tmp_path, "build", "--out", "built")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "built" / "python" / "Controller.fmu").is_file()
    assert installed(apa) == before
    assert (tmp_path / "cache").is_dir()


def test_a_controller_of_ones_own_and_a_study_from_the_wheel(full: Path, tmp_path: Path) -> None:
    before = installed(full)
    for words in (
        ["new", "controller", "my_controller"],
        ["new", "ci", "my_controller"],
        ["run", "my_controller/scenario.yaml"],
        ["test", "my_controller/scenario.yaml", "my_controller/test_steps.yaml", "guo2015-case4"],
        ["run", "guo2015-case4"],
        ["sweep", "guo2015-trial", "--stride", "1000", "--out", "study"],
    ):
        done = call(full, tmp_path, *words)
        assert done.returncode == 0, (words, done.stdout, done.stderr)
    assert (tmp_path / ".gitlab-ci.yml").is_file()
    assert {path.suffix for path in (tmp_path / "study").iterdir()} >= {".parquet", ".html"}
    assert (tmp_path / "cache").is_dir()
    assert installed(full) == before
    code = "import orchestrator, apa_cosim; print(orchestrator.__file__, apa_cosim.__file__)"
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    words = [str(full.with_name("python")), "-c", code]
    done = subprocess.run(words, cwd=tmp_path, env=clean, capture_output=True, text=True, check=True)
    assert all(str(full.parents[1]) in file for file in done.stdout.split())


@pytest.mark.parametrize(
    ("arguments", "extra"),
    [
        (["sweep", "guo2015-trial"], "sweep"),
        (["replay", "table.parquet", "--row", "1"], "sweep"),
        (["build", "--fmus", "native"], "native"),
    ],
)
def test_what_needs_an_extra_says_which(arguments: list[str], extra: str, apa: Path, tmp_path: Path) -> None:
    done = call(apa, tmp_path, *arguments)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("apa: ")
    assert "Traceback" not in done.stderr
    assert f"apa-cosim[{extra}" in done.stderr or f",{extra}]" in done.stderr
