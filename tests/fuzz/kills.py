"""Runs, sweeps, builds and recovers ended at random moments: nothing lost, nothing mixed, nothing left."""

import json
import os
import random
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fmus.contents.archive import archive_guid
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.read_log import read_log
from orchestrator.studies.sweep.table import Table
from tests.fuzz.fair_time import FairTime

SIGNALS = (signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
SOON = 2.5
"""An end takes no longer, the time in which other processes had its core left out [s]."""
LONGEST = 300.0
"""A command that nobody ends takes no longer, counted alike [s]."""
LOOK = 0.1
ENDS = (0, 1, 130)


class Stage(NamedTuple):
    """Where it is played, and what whole results are."""

    folder: Path
    environment: dict[str, str]
    table: bytes
    """The study that nothing happened to."""
    log: bytes
    guids: list[str | None]

    def start(self, *words: str) -> "subprocess.Popen[str]":
        """Start ``apa``."""
        pipe = subprocess.PIPE
        command = [sys.executable, "-m", "orchestrator", *words]
        return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=self.environment)

    def finish(self, *words: str) -> str:
        """Return what is wrong with a command that nobody ends, empty if it ends well."""
        child = self.start(*words)
        said, _ = waited(child, LONGEST)
        return "" if child.returncode in ENDS else f"apa {' '.join(words)}: {child.returncode}: {said}"


STUDY = """name: trial
scenario: guo2015-case4
runs:
  latin_hypercube: {n: 60, vehicle.start.x: {uniform: [SHIFT, 2.2]}, vehicle.start.y: {uniform: [-0.1, 0.1]}}
"""


def stage(folder: Path) -> Stage:
    """Return a stage in ``folder``, with its own folder for temporary files."""
    temporary = folder / "tmp"
    temporary.mkdir(parents=True)
    environment = {**os.environ, "TMPDIR": str(temporary), "PYTHONPATH": str(Path(__file__).parents[2])}
    for name, shift in (("one", "1.9"), ("two", "2.0")):
        (folder / f"{name}.yaml").write_text(STUDY.replace("SHIFT", shift))
    empty = Stage(folder, environment, b"", b"", [])
    wrong = empty.finish("sweep", str(folder / "one.yaml"), "--chunk", "4", "--no-page", "--out", str(folder / "whole"))
    wrong += empty.finish("run", "guo2015-case4", "--fmus", "none", "--no-page", "--out", str(folder / "log"))
    wrong += empty.finish("build", "--fmus", "python", "--out", str(folder / "built"))
    assert not wrong, wrong
    guids = [archive_guid(path) for path in sorted((folder / "built").rglob("*.fmu"))]
    table = (folder / "whole" / "trial.parquet").read_bytes()
    return Stage(folder, environment, table, (folder / "log" / "run.mcap").read_bytes(), guids)


def waited(child: "subprocess.Popen[str]", longest: float, taken: FairTime | None = None) -> tuple[str, float]:
    """Return what a process said until it ended, and the time it took of its own; one that takes longer is killed."""
    taken, late = taken or FairTime(child.pid), ""
    while True:
        try:
            _, said = child.communicate(timeout=LOOK)
            return late + said, taken.seconds()
        except subprocess.TimeoutExpired:
            if taken.seconds() > longest:
                child.kill()
                late = f"killed after {longest:g} s: "


def ended(child: "subprocess.Popen[str]", after: float, draw: random.Random) -> str:
    """End a process after a time; return what is wrong with how it ended."""
    try:
        child.wait(timeout=after)
    except subprocess.TimeoutExpired:
        number = draw.choice(SIGNALS)
        taken = FairTime(child.pid)
        child.send_signal(number)
        said, seconds = waited(child, LONGEST, taken)
        if seconds > SOON:
            return f"{number.name} took {seconds:.1f} s: {said}"
        # Before Python has come to our first line, a signal ends it as any program.
        if child.returncode not in (*ENDS, -number):
            return f"{number.name} left {child.returncode}: {said}"
        return ""
    said, _ = waited(child, LONGEST)
    return "" if child.returncode in (*ENDS, 2) else f"{child.returncode}: {said}"


def a_run(at: Stage, draw: random.Random) -> str:
    """Two scenarios in one folder by turns: what lies beside a log is made of it."""
    out = at.folder / "run"
    kind = draw.choice(("none", "python", "native"))
    sets = ["--set", f"vehicle.start.x={draw.choice((2.0, 2.05, 2.1))}"]
    child = at.start("run", "guo2015-case4", *sets, "--fmus", kind, "--force", "--out", str(out))
    wrong = ended(child, draw.uniform(0.2, 6.0), draw)
    return wrong or _mixed(out)


def _mixed(out: Path) -> str:
    if not (out / "run.mcap").is_file():
        return "" if not (out / "summary.json").exists() else "a summary without a log"
    recording = read_log(out / "run.mcap")
    if (out / "summary.json").is_file():
        summary = json.loads((out / "summary.json").read_text())
        reported, true = summary["overrides"], recording.info["scenario"]["overrides"]
        if reported != true or abs(summary["duration"] - recording.t[-1]) > 1e-9:
            return f"the summary of {reported} lies beside the log of {true}"
    elif (out / "report.html").exists() or (out / "overview.png").exists():
        return "a page without a summary"
    return ""


def a_sweep(at: Stage, draw: random.Random) -> str:
    """A study ended again and again, one of another name for its turn, comes to the bytes of the one left alone."""
    out = at.folder / "sweep"
    kind = draw.choice(([], ["--fmus", "none"], []))
    file = "two" if draw.random() < 0.2 else "one"
    more = ["--restart"] if draw.random() < 0.2 else ["--resume"]
    words = ["sweep", str(at.folder / f"{file}.yaml"), "--chunk", "4", "--no-page", "--out", str(out), *more, *kind]
    wrong = ended(at.start(*words), draw.uniform(0.5, 5.0), draw)
    if wrong or draw.random() < 0.6:
        return wrong
    words = ["sweep", str(at.folder / "one.yaml"), "--chunk", "4", "--no-page", "--out", str(out), "--resume"]
    child = at.start(*words)
    said, _ = waited(child, LONGEST)
    if child.returncode == 2 and "another" in said:
        child = at.start(*words[:-1], "--restart")
        said, _ = waited(child, LONGEST)
    if child.returncode:
        return f"resume: {child.returncode}: {said}"
    if Table(out / "trial.parquet").count != 60 or (out / "trial.parquet").read_bytes() != at.table:
        return "the table is another one"
    return "parts are left" if (out / "parts").exists() else ""


def a_build(at: Stage, draw: random.Random) -> str:
    """An FMU is whole or not there."""
    out = at.folder / "build"
    if draw.random() < 0.5:
        shutil.rmtree(out, ignore_errors=True)
    wrong = ended(at.start("build", "--fmus", "python", "--out", str(out)), draw.uniform(0.3, 4.0), draw)
    if wrong:
        return wrong
    for path in out.rglob("*.fmu"):
        if archive_guid(path) not in at.guids:
            return f"{path.name} is another one"
    return ""


def a_recover(at: Stage, draw: random.Random) -> str:
    """A log is repaired whole or not at all, and the one that is whole stays."""
    out = at.folder / "recover"
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir()
    (out / "run.mcap.part").write_bytes(at.log[: draw.randrange(len(at.log) // 2, len(at.log))])
    if draw.random() < 0.5:
        (out / "run.mcap").write_bytes(at.log)
    wrong = ended(at.start("recover", str(out / "run.mcap.part")), draw.uniform(0.1, 1.5), draw)
    for path in out.glob("run*.mcap"):
        try:
            before = np.diff(read_log(path).t_ns)
        except BadInput as error:
            return f"{path.name}: {error}"
        if len(before) and before.max() > 10_000_000:
            return f"{path.name} has a gap"
    whole = out / "run.mcap"
    return wrong or ("" if not whole.exists() or len(read_log(whole).t_ns) else "the whole log is gone")


PLAYS: tuple[Callable[[Stage, random.Random], str], ...] = (a_run, a_run, a_sweep, a_sweep, a_build, a_recover)


def left(at: Stage) -> str:
    """Return what is left in the folder for temporary files after one more command."""
    wrong = at.finish("export", "csv", str(at.folder / "log"), "--out", str(at.folder / "log" / "x.csv"))
    words = ["run", "guo2015-case4", "--fmus", "python", "--no-page", "--force", "--out", str(at.folder / "last")]
    wrong = wrong or at.finish(*words)
    names = [path.name for path in (at.folder / "tmp").iterdir()]
    return wrong or (f"left: {names}" if names else "")


def fuzz(folder: Path, _log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """End one command after the other without end; yield what was done and what was wrong, empty if nothing."""
    at = stage(folder / "kills")
    for count in range(1, 1 << 30):
        play = draw.choice(PLAYS)
        wrong = play(at, draw)
        if not wrong and count % 10 == 0:
            wrong = left(at)
        yield [play.__name__], wrong
