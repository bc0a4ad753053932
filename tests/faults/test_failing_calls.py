"""The n-th open, write, mmap or fork of a command fails, on its own files: never a verdict, a row or a margin of it.

As SQLite tests itself: a shared library in front of the C library lets one call fail. A command ends with 2 and one
line, or does without what failed and comes to the same result.
"""

import json
import os
import select
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from fmus.native.compilers import can_compile
from tests.faults.printed_result import result

ROOT = Path(__file__).parents[2]
SHIM = Path(__file__).with_name("failing_call.c")
CALLS = ("open", "write", "mmap", "fork")
COMMANDS = {
    "run": ["run", "guo2015-case4", "--fmus", "native", "--no-page", "--json", "--set", "stop_time=1"],
    "test": [
        "test",
        "guo2015-case4",
        "--fmus",
        "native",
        "--set",
        "stop_time=1",
        "--set",
        "expected_outcome=not_parked",
        "--json",
    ],
    "sweep": ["sweep", "few.yaml", "--fmus", "native", "--no-page", "--jobs", "1", "--json"],
    "falsify": ["falsify", "small.yaml", "--fmus", "native", "--budget", "50", "--jobs", "1", "--json"],
}
MOST = 2000
"""Calls of one kind that a command may make: more is a mistake of this test."""
FIRST, STRIDE = 30, 23
"""A falsification repeats the calls of its first runs 60 times: of the later ones every ``STRIDE``-th fails."""
STUDY = """
name: few
scenario: guo2015-case4
set: {stop_time: 1}
runs: {grid: {vehicle.start.x: [0, 0.01]}}
"""
SEARCHED = """
name: small
scenario: guo2015-case4
set: {stop_time: 1}
runs: {monte_carlo: {n: 4, vehicle.start.x: {uniform: [0, 0.01]}, vehicle.start.y: {uniform: [0, 0.01]}}}
"""
LONGEST = 1800.0
"""A command that takes longer hangs, also on a machine with much else to do [s]."""

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="LD_PRELOAD"),
    pytest.mark.skipif(not can_compile(), reason="needs a C compiler"),
]


SERVER = """
import importlib, json, os, sys, tempfile, contextlib
for line in sys.stdin:
    asked = json.loads(line)
    if "modules" in asked:
        for name in asked["modules"]:
            with contextlib.suppress(Exception):
                importlib.import_module(name)
        print(0, flush=True)
        continue
    child = os.fork()
    if not child:
        break
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
else:
    sys.exit()
for number, name in enumerate(("in", "out", "err")):
    os.dup2(os.open(asked["streams"] + name, os.O_RDWR | os.O_CREAT), number)
os.environ.update(asked["environment"])
os.chdir(asked["folder"])
tempfile.tempdir = None
sys.argv = ["apa", *asked["words"]]
from orchestrator.cli import main
code = main()
if asked["list"]:
    print("\\n" + json.dumps(list(sys.modules)))
sys.exit(code)
"""
"""Runs each command in a process of its own that has its modules already: to import them takes most of the time."""


class Bench:
    """A folder in which commands are run with a call that fails."""

    def __init__(self, folder: Path) -> None:
        self.folder, library = folder, folder / "failing_call.so"
        self._runs = 0
        command = ["gcc", "-shared", "-fPIC", "-O1", "-o", str(library), str(SHIM), "-ldl"]
        if subprocess.run(command, capture_output=True, check=False).returncode:
            pytest.skip("needs gcc")
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "LD_PRELOAD": str(library)}
        pipe = subprocess.PIPE
        self.server = subprocess.Popen(
            [sys.executable, "-c", SERVER], cwd=folder, env=environment, stdin=pipe, stdout=pipe, text=True
        )
        self._imported: set[str] = set()

    def import_modules(self, command: str) -> None:
        """Let the server have the modules of a command."""
        if command not in self._imported:
            self._imported.add(command)
            _, printed, said, _ = self.run(command, list_modules=True)
            assert printed, said
            self._ask({"modules": json.loads(printed.splitlines()[-1])})

    def close(self) -> None:
        """End the server."""
        self.server.communicate(timeout=LONGEST)
        assert self.server.returncode == 0

    def _ask(self, asked: dict[str, object]) -> int:
        assert self.server.stdin is not None
        assert self.server.stdout is not None
        self.server.stdin.write(json.dumps(asked) + "\n")
        self.server.stdin.flush()
        ready, _, _ = select.select([self.server.stdout], [], [], LONGEST)
        assert ready, f"hangs: {asked}"
        return int(self.server.stdout.readline())

    def run(self, command: str, call: str = "", at: int = 0, list_modules: bool = False) -> tuple[int, str, str, bool]:
        """Return exit code, what was printed, what was said on the other stream, and whether the call was reached."""
        self._runs += 1
        own = self.folder / f"{self._runs}"
        (own / "tmp").mkdir(parents=True)
        (own / "few.yaml").write_text(STUDY)
        (own / "small.yaml").write_text(SEARCHED)
        mark, streams = self.folder / f"reached-{self._runs}", f"{self.folder}/said-{self._runs}-"
        fault = {"APA_FAIL_CALL": call, "APA_FAIL_AT": str(at), "APA_FAIL_UNDER": str(own), "APA_FAIL_MARK": str(mark)}
        asked = {
            "words": [*COMMANDS[command], "--out", "out"],
            "folder": str(own),
            "streams": streams,
            "environment": {"TMPDIR": str(own / "tmp"), **fault},
            "list": list_modules,
        }
        code = self._ask(asked)
        printed, said = (Path(streams + name).read_text() for name in ("out", "err"))
        shutil.rmtree(own)
        return code, printed, said, mark.exists()


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    made = Bench(tmp_path_factory.mktemp("calls"))
    yield made
    made.close()


@pytest.fixture(scope="module")
def references(bench: Bench) -> dict[str, tuple[int, Any]]:
    return {}


def holds(bench: Bench, references: Any, command: str, call: str, at: int) -> bool:
    """Check a command whose ``at``-th ``call`` fails; return whether it was reached."""
    bench.import_modules(command)
    if command not in references:
        code, printed, said, _ = bench.run(command)
        assert code in (0, 1), said
        references[command] = code, result(command, printed)
    code, printed, said, reached = bench.run(command, call, at)
    place = f"{command}: {call} {at}: exit code {code}\n{printed}\n{said}"
    assert "Traceback" not in said, place
    assert "internal error" not in said, place
    if code != 2:
        assert (code, result(command, printed)) == references[command], place
    elif command != "test":
        assert sum(line.startswith("apa: ") and "warning" not in line for line in said.splitlines()) == 1, place
    return reached


@pytest.mark.parametrize(("call", "at"), [("open", 2), ("open", 4), ("write", 1)])
def test_a_run_of_which_one_call_fails(bench: Bench, references: Any, call: str, at: int) -> None:
    assert holds(bench, references, "run", call, at)


@pytest.mark.release
@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("command", COMMANDS)
def test_every_call_of_a_command(bench: Bench, references: Any, command: str, call: str) -> None:
    at = 1
    while at < MOST:
        if not holds(bench, references, command, call, at):
            return
        at += 1 if at < FIRST or command != "falsify" else STRIDE
    raise AssertionError(f"{command}: more than {MOST} calls of {call}")
