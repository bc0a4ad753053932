"""Every command printed in README and docs is run as it is printed, and prints what is printed below it."""

import io
import os
import re
import shlex
import shutil
import subprocess
import sys
from contextlib import redirect_stdout
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import pytest
import yaml

from orchestrator.cli import main, parser
from orchestrator.simulation.cosim.fmu_files import fmu_files

ROOT = Path(__file__).parents[2]
RECIPES = {ROOT / "docs" / "extend.md", ROOT / "docs" / "extend-tools.md"}
"""Their commands are of what they add; ``test_extend`` runs them."""
PAGES = sorted({ROOT / "README.md", *(ROOT / "docs").glob("*.md")} - RECIPES, key=lambda path: path.name)
INSTEAD = {"make run": "apa run guo2015-case4"}
"""What a command does after it has installed everything."""
FEWER = {'"guo2015-*"': "guo2015-case4", "catalogue/iso20900": "catalogue/cicap-b2"}
"""Tests of a suite -> some of them, which are enough to see that the command does what it says."""
NOT_RUN = {
    "make test": "it is what runs this",
    "source ": "the environment is there",
    "python -m venv": "tests/test_wheel.py installs",
    ".venv/bin/": "tests/test_wheel.py installs",
    "apa test catalogue --out": "a minute; tests/orchestrator/test_catalogue.py has parts",
    "apa reproduce all": "minutes; tests/papers has each paper",
    "apa build --fmus native --out build --platform": "compiles C libraries of other platforms; tests/fmi",
    "apa build --fmi 3 --out build --platform": "compiles C libraries of other platforms; tests/fmi",
    "apa build --fmus native --cc gcc": "would replace the FMUs that all runs here use",
    "apa falsify": "minutes; tests/falsification has small ones",
    "apa export container guo2015-case4 --set": "compiles for half a minute what the line above it does",
    "pip install": "tests/test_wheel.py installs",
    "python -m apa_cosim.gym": "a minute a system; tests/gym has small ones",
    "apa new controller learned --from": "needs a trained policy; tests/gym has a small one",
    "apa run learned/scenario.yaml": "needs a trained policy",
    "apa test learned/scenario.yaml": "needs a trained policy",
    "apa build --system": "compiles; tests/fmi/test_system_fmus.py",
    "apa recover runs/guo2015-case4/run.mcap.part": "needs a killed run; tests/orchestrator/test_recover.py has some",
}
"""How a command begins that is not run here -> why."""
LONG_PAGES = (
    *("catalogue", "index", "learn-to-park", "parking", "parking-planning", "parking-results", "parking-use"),
    *("parking-benchmarks", "see-and-drive", "studies", "targets", "test-in-ci", "third-party-fmus"),
    *("scenario", "use-in-your-tool", "vehicle", "write-a-model"),
)
"""Pages whose commands drive, sweep and compile for minutes what tests of the command drive in small. On each change
the words of their commands are checked, `make release` runs them."""
NEEDS = {
    "apa export mf4": "asammdf",
    "apa export rerun": "rerun",
    "apa export ros2": "rosbags",
    "apa export container": "ziglang",
    "fmpy simulate guo2015-case4.fmu": "ziglang",
    "apa sweep": "pyarrow",
    "apa replay": "pyarrow",
}
"""Package of an extra that a command needs."""
ENDS = {
    "apa compare A.mcap B.mcap": 1,
    "apa compare runs/guo2015-case4": 1,
    "apa check runs/gentle": 1,
    "apa run my-slot.yaml": None,
    "apa test": None,
    "apa replay": None,
    "apa sweep parking-world": None,
}
"""Exit code that is not 0; None: 0 or 1, for what is judged there is the reader's own."""
PARKED = "- {id: parked, signal: controller.phase, equals: PARKED, window: {at: end}, source: REQ-1}"
FILES = {
    "acceptance.yaml": PARKED,
    "requirements.yaml": PARKED,
    "rules.yaml": PARKED,
    "my-scenario.yaml": "extends: guo2015-case3",
}
NAMES = {"- id": "requirements.yaml", '"vehicle': "tolerances.yaml"}
"""How a block of YAML begins that the page gives no name -> how its commands call it."""
SUFFIXES = {"python": ".py", "yaml": ".yaml"}


class Block(NamedTuple):
    language: str
    text: str
    file: str = ""
    """The file it is, if the paragraph before it names one of its kind."""


def blocks(page: Path) -> list[Block]:
    """Return the blocks of a page in order; indented ones that hold commands count as ``sh``."""
    text = page.read_text(encoding="utf-8")
    fences = re.finditer(r"^```(\w+)\n(.*?)^```", text, re.S | re.M)
    found = [(match.start(), Block(match[1], match[2], file_of(text[: match.start()], match[1]))) for match in fences]
    bare = re.sub(r"^```.*?^```", lambda match: " " * len(match[0]), text, flags=re.S | re.M)
    for match in re.finditer(r"(?:^ {4}(?:apa|fmpy|dask|OMSimulator|python) .*\n)+", bare, re.M):
        found.append((match.start(), Block("sh", "\n".join(line.strip() for line in match[0].splitlines()))))
    return [block for _, block in sorted(found)]


def file_of(before: str, language: str) -> str:
    """Return the file that the paragraph before a block speaks of: ``tank.py``, a water tank."""
    paragraph = before.rstrip().rpartition("\n\n")[2]
    names = re.findall(r"`([\w-]+\.\w+)`", paragraph)
    return next((name for name in names if name.endswith(SUFFIXES.get(language, "-"))), "")


def commands(block: Block) -> list[str]:
    """Return the commands of a block, without what is said of them."""
    lines = (re.split(r"\s+#|\s{3,}", line)[0].strip() for line in block.text.splitlines())
    return [line for line in lines if line]


WITH_COMMANDS = [page for page in PAGES if any(block.language == "sh" for block in blocks(page))]


def test_most_pages_have_commands() -> None:
    assert len(WITH_COMMANDS) > 8
    shells = [block for page in WITH_COMMANDS for block in blocks(page) if block.language == "sh"]
    printed = [line for block in shells for line in commands(block)]
    assert len(printed) > 40
    for start in (*INSTEAD, *NOT_RUN, *NEEDS, *ENDS):
        assert any(line.startswith(start) for line in printed), f"{start}: no page has it any more"
    for tests in FEWER:
        assert any(tests in line for line in printed), f"{tests}: no page has it any more"


@pytest.fixture(scope="module")
def shelf(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What pages take for granted: a log, a second one, a third-party controller, own rules."""
    folder = tmp_path_factory.mktemp("shelf")
    for name, sets in {"A": [], "B": ["--set", "controller.guo2015.k4=3"]}.items():
        main(["run", "guo2015-case4", "--out", str(folder / name), "--no-page", "--quiet", *sets])
        shutil.move(folder / name / "run.mcap", folder / f"{name}.mcap")
        shutil.rmtree(folder / name)
    for name in ("run.mcap", "copied.mcap", "C.mcap"):
        shutil.copy(folder / "A.mcap", folder / name)
    (folder / "runs" / "guo2015-case4").mkdir(parents=True)
    shutil.copy(folder / "A.mcap", folder / "runs" / "guo2015-case4" / "run.mcap")
    (folder / "build").mkdir()
    for name in ("their.fmu", "build/Controller.fmu"):
        shutil.copy(fmu_files("native")["controller"], folder / name)
    for name, text in FILES.items():
        (folder / name).write_text(text)
    return folder


@pytest.mark.parametrize("page", WITH_COMMANDS, ids=lambda page: page.name)
def test_apa_knows_every_word_that_is_printed(page: Path) -> None:
    printed = [shlex.split(line) for block in blocks(page) if block.language == "sh" for line in commands(block)]
    for words in printed:
        if words[0] == "apa":
            assert parser().parse_args(words[1:]).run, words


PAGES_BY_COST = [
    pytest.param(page, marks=pytest.mark.release if page.stem in LONG_PAGES else (), id=page.name)
    for page in WITH_COMMANDS
]


def test_long_pages_are_there() -> None:
    assert set(LONG_PAGES) < {page.stem for page in WITH_COMMANDS}


@pytest.mark.parametrize("page", PAGES_BY_COST)
def test_commands_do_what_is_printed(page: Path, shelf: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = shutil.copytree(shelf, tmp_path / "work")
    monkeypatch.chdir(folder)
    found = blocks(page)
    for block in found:
        write_file(block)
    printed, names = "", dict[str, object]()
    for block in found:
        if block.language == "sh":
            printed = "\n".join(run(line) for line in commands(block))
        elif block.language == "text" and printed:
            reported(block.text, printed)
        elif block.language == "python" and not block.file and has_packages(block.text):
            with redirect_stdout(io.StringIO()) as out:
                exec(compile(block.text, page.name, "exec"), names)
            comments = re.findall(r"^print\(.*#\s*(.*)$", block.text, re.M)
            assert all(comment_fits(comment, out.getvalue()) for comment in comments), out.getvalue()


def has_packages(code: str) -> bool:
    """Return whether all packages that Python code imports are installed."""
    return all(find_spec(name) is not None for name in re.findall(r"^(?:import|from) (\w+)", code, re.M))


def write_file(block: Block) -> None:
    """Write a block under the name that the page calls it, if it is a file."""
    name = block.file
    if block.language == "yaml" and not name:
        name = next((name for start, name in NAMES.items() if block.text.startswith(start)), "")
        name = f"{yaml.safe_load(block.text)['name']}.yaml" if block.text.startswith("name:") else name
    if name:
        Path(name).write_text(block.text, encoding="utf-8")


def run(line: str) -> str:
    """Run a command in the current folder and return what it printed."""
    line = INSTEAD.get(line, line)
    for tests, some in FEWER.items():
        line = line.replace(tests, some)
    missing = [package for start, package in NEEDS.items() if line.startswith(start) and find_spec(package) is None]
    if missing or any(line.startswith(start) for start in NOT_RUN):
        return ""
    words = shlex.split(line)
    if words[0] == "apa":
        with redirect_stdout(io.StringIO()) as out:
            code = main(words[1:])
        wanted = next((end for start, end in ENDS.items() if line.startswith(start)), 0)
        assert code in ((0, 1) if wanted is None else (wanted,)), f"{line}: exit code {code}\n{out.getvalue()}"
        return out.getvalue()
    done = subprocess.run([sys.executable, "-m", *words], capture_output=True, text=True, check=False, env=os.environ)
    assert done.returncode == 0, f"{line}\n{done.stderr}"
    return done.stdout


def reported(block: str, printed: str) -> None:
    """Assert that every line of ``block`` was printed, but for dots that stand for more."""
    have = [" ".join(line.split()) for line in printed.splitlines()]
    for line in block.splitlines():
        wanted = " ".join(line.split())
        if wanted == "...":
            continue
        start = wanted.removesuffix("...") if wanted.endswith("...") else None
        assert any(got.startswith(start) if start else got == wanted for got in have), (
            f"{wanted!r} is not in:\n{printed}"
        )


def comment_fits(comment: str, printed: str) -> bool:
    """Return whether the numbers of a comment are those printed, as far as it gives them."""
    wanted = re.findall(r"-?\d+\.\d+", comment)
    got = re.findall(r"-?\d+\.\d+", printed)
    return all(any(round(float(one), len(text.split(".")[1])) == float(text) for one in got) for text in wanted)
