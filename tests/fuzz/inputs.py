"""Odd scenarios, cars, settings, studies, requirements, tolerances and flags: each ends with one line or a run."""

import math
import random
import shutil
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from orchestrator.inputs.scenario.plausible import LARGEST
from orchestrator.presentation.log.read_log import read_log
from tests.fuzz.limits import ask
from tests.fuzz.more_texts import COLUMNS, SCENE, STEP_TEST

JUDGED: Counter[str] = Counter()
FAR = 1.5
"""A signal may pass what is plausible for a parameter by so much."""

VALUES = (
    "0",
    "-1",
    "1",
    "1e300",
    "-1e300",
    ".inf",
    "-.inf",
    ".nan",
    "1e-300",
    "1e-9",
    "1" * 400,
    "0x" + "f" * 400,
    "1e400",
    "1:30:45",
    "2001-99-99",
    "2001-01-01",
    "!!int abc",
    "!!float x",
    "!!python/object:os.system x",
    "!foo bar",
    "''",
    "null",
    "~",
    "true",
    "on",
    "[]",
    "{}",
    "[1, 2, 3]",
    "{a: 1}",
    "'5 km/h'",
    "'5 m m'",
    "'" + "1" * 3000 + "'",
    "'1 " + "m" * 3000 + "'",
    '"\\ud800"',
    '"\\0"',
    '"\\u2028"',
    "'" + "x" * 300 + "'",
    "..",
    "'../../x'",
    "'/dev/zero'",
    "&a [*a]",
    "*b",
    "&c 1",
    "'" + "9" * 59 + "'",
    "2147483648",
    "-2147483649",
    "1e6",
    "1e7",
    "99999999999",
    "0.001",
    "[" * 3000,
    "[" * 30 + "]" * 30,
    "{[1]: 2}",
    "{? {a: 1} : 2}",
    "'nan'",
    "'inf'",
    "'-inf deg'",
    "'1e5 deg'",
    "%",
    "@x",
    "|",
    "'  '",
    "\t",
    "- 1",
    "1_000_000",
    "0o17",
    "0b1",
    "1.",
    ".5",
    "+1",
    "'\u0663'",
    "'\uff11'",
    "<<",
    "=",
    "3 rad",
    "PARKED",
)
PLAIN = ("0.3", "-3", "2.5", "50", "1e3", "2e4", "5e5", "-9e5", "45 deg", "5 km/h", "10 cm", "false", "1", "0.0")
"""Values that are often accepted, some of them far from any car park."""
SETTINGS = (
    "vehicle",
    "vehicle.start.x",
    "vehicle.start",
    "vehicle.car.wheelbase",
    "car.width",
    "car.extends",
    "car.steering",
    "vehicle.chassis.mass",
    "controller",
    "target",
    "controller.system",
    "target.x",
    "slot.x",
    "slot.length",
    "step",
    "stop_time",
    "decimation.vehicle",
    "decimation.controller",
    "decimation",
    "seed",
    "name",
    "title",
    "faults",
    "requirements",
    "stop_condition",
    "expected_outcome",
    "task",
    "car",
    "extends",
    "scene",
    "scene.boxes",
    "vehicle.driver.profile",
    "vehicle.body",
    "controller.guo2015.k4",
    "vehicle.scene.boxes[1].x",
    "file",
    "overrides",
    "unsupported_parameters",
    "scene.boxes[1].x",
    "",
    ".",
    "vehicle.",
    "a.b.c",
    "vehicle.start.x.y",
    "controller.target.x",
    "ultrasonic.seed",
)
SCENARIO = """name: odd
extends: guo2015-case4
title: odd
stop_time: 0.3
step: 0.01
decimation: {controller: 1}
seed: 1
car: guo2015
vehicle:
  start: {x: 2.0, y: 1.0, heading: 0.1}
  driver: {profile: [[0, 1.5], [5, 0]]}
slot: {x: -1.0, y: -1.0, length: 5.0, width: 2.0}
target: [0.0, 0.0, 0.0]
faults:
  - {signal: vehicle.odometry, kind: delay, start: 0.1, stop: 1, delay: 0.1}
  - {signal: vehicle.odometry.x, kind: noise, sigma: 0.1}
  - {signal: vehicle.odometry.heading, kind: dropout, probability: 0.5}
requirements:
  - project
  - {id: a, signal: vehicle.speed, max: 3, window: {from: 0, to: 1, phase: PARKED}, source: me}
stop_condition: {still: 0.001, standstill: 0.5, succeeded: [PARKED]}
"""
STUDY = """name: odd
title: odd
scenario: guo2015-trial-odd
set: {stop_time: 0.1}
seed: 1
runs:
  grid:
    vehicle.start.x: [2.0, 2.1]
    vehicle.start.y: {from: 0.9, to: 1.0, steps: 2}
  monte_carlo: {n: 2, vehicle.start.heading: {uniform: [0, 0.1]}}
measures:
  offset: {largest: controller.lateral_error}
within:
  project: [project]
map: {x: vehicle.start.x, y: vehicle.start.y}
""".replace("guo2015-trial-odd", "guo2015-case4")
RULES = """- {id: a, signal: vehicle.speed, max: 3 m/s, window: {from: 0, to: 2 s, at: end}, source: me}
- {id: b, signal: final.lateral_error, max_abs: 5 cm, source: me, where: slot, required: false}
- {id: c, signal: controller.phase, equals: PARKED, window: {phase: [PARKED], if_never: pass}, source: me}
"""
TOLERANCES = """"vehicle.pose.*": {abs: 1 cm, rel: 0.01, time: 100 ms}
"*.heading": {abs: 0.5 deg}
"""


def mutated(text: str, draw: random.Random) -> str:
    """Return a text with a few things wrong."""
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        lines = text.split("\n")
        place = draw.randrange(len(lines))
        text = "\n".join(draw.choice(CHANGES)(lines, place, draw))
    return text


def _value(lines: list[str], place: int, draw: random.Random) -> list[str]:
    """Put another value behind one of the colons, or commas, of a line."""
    between = ": " if ": " in lines[place] else ","
    parts = lines[place].split(between)
    if len(parts) > 1:
        which = draw.randrange(1, len(parts))
        head, sep, tail = parts[which], "", ""
        for mark in ",]}":
            if mark in head:
                head, sep, tail = head.partition(mark)
                break
        parts[which] = draw.choice(draw.choice((VALUES, PLAIN))) + sep + tail
    lines[place] = between.join(parts)
    return lines


def _letter(lines: list[str], place: int, draw: random.Random) -> list[str]:
    line = lines[place]
    at = draw.randrange(len(line) + 1)
    lines[place] = line[:at] + draw.choice("{}[]:,-&*!|>%@`'\"#?\t 0eE.x\x07\x7fé�") + line[at + draw.randrange(2) :]
    return lines


def _line(lines: list[str], place: int, draw: random.Random) -> list[str]:
    other = draw.choice(
        (lines[draw.randrange(len(lines))], f"{draw.choice(SETTINGS)}: {draw.choice(VALUES)}", "  x: 1")
    )
    return [*lines[:place], other, *lines[place + draw.randrange(2) :]]


def _bomb(lines: list[str], _place: int, draw: random.Random) -> list[str]:
    marks = [f"x{k}: &x{k} [{', '.join([f'*x{k - 1}'] * 9)}]" for k in range(1, 9)]
    return ["x0: &x0 [1, 1]", *marks, f"vehicle: {draw.choice(('*x8', '{<<: [*x7, *x7]}'))}", *lines]


CHANGES: tuple[Callable[[list[str], int, random.Random], list[str]], ...] = (
    *(_value,) * 6,
    *(_letter,) * 3,
    *(_line,) * 3,
    _bomb,
)


def attacks(folder: Path, log: Path, draw: random.Random) -> Iterator[list[str]]:
    """Yield command lines without end; the files they name are written before."""
    file = folder / "odd.yaml"
    out = ["--out", str(folder / "out")]
    while True:
        settings = [
            f"{draw.choice(SETTINGS)}={draw.choice(draw.choice((VALUES, PLAIN))).strip(chr(39))}"
            for _ in range(draw.randrange(1, 4))
        ]
        sets = [word for text in settings for word in ("--set", text)]
        kind = draw.randrange(12)
        content = {7: STUDY, 8: RULES, 9: TOLERANCES, 10: STEP_TEST, 11: SCENE}.get(kind, SCENARIO)
        file.write_text(mutated(content, draw), encoding="utf-8", errors="surrogatepass")
        if kind <= 3:
            yield ["run", str(file), "--fmus", "none", "--no-page", *out]
        elif kind <= 5:
            yield ["run", "guo2015-case4", "--set", "stop_time=0.2", *sets, "--fmus", "none", "--no-page", *out]
        elif kind == 6:
            yield ["test", str(file), *sets[:2], "--fmus", "none", *out]
        elif kind == 7:
            yield ["sweep", str(file), *sets[: draw.choice((0, 2))], "--restart", "--no-page", "--jobs", "1", *out]
        elif kind == 8:
            yield ["check", str(log), str(file)]
        elif kind == 10:
            columns = draw.choice((COLUMNS, mutated(COLUMNS, draw), COLUMNS[: draw.randrange(len(COLUMNS))]))
            (folder / "odd.csv").write_text(columns, encoding="utf-8", errors="surrogatepass")
            yield ["test", str(file), "--fmus", "none", *out]
        elif kind == 11:
            yield ["import", "tpcap", str(file), *out]
        else:
            yield ["compare", str(log), str(log), "--tolerances", str(file), "--abs", draw.choice(VALUES).strip("'")]


def fuzz(folder: Path, log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """Try one input after the other without end; yield the words and what was wrong, empty if nothing."""
    for words in attacks(folder, log, draw):
        shutil.rmtree(folder / "out", ignore_errors=True)
        answer = ask(words)
        mistake = answer.mistake
        if not mistake and words[0] == "run" and answer.code in (0, 1):
            JUDGED["inputs that were run and judged"] += 1
            mistake = nonsense(folder / "out", answer.err)
        yield words, mistake


def nonsense(out: Path, said: str) -> str:
    """Return what an accepted input has led to that no car does and nobody was warned of; empty if nothing."""
    if not (out / "summary.json").is_file() or not (out / "run.mcap").is_file():
        return "judged, without results"
    recording = read_log(out / "run.mcap")
    for name, variable in recording.variables.items():
        values = recording.signals.get(name)
        most = LARGEST.get(variable.signal.unit, math.inf)
        owner = name.partition(".")[0]
        if values is None or owner != "vehicle" or "clearance" in name:
            continue
        if not np.isfinite(values).all():
            return f"{name} is not finite"
        if np.abs(values).max(initial=0.0) > FAR * most and "beyond what is plausible" not in said:
            return f"{name} = {np.abs(values).max():g} {variable.signal.unit}, and nobody was warned"
    return ""
