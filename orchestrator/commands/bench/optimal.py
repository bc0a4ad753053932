"""``apa bench optimal``: how much longer a drive takes than the time-optimal motion at equal limits."""

import argparse
import json
from pathlib import Path
from typing import Any

from fmus.files import write_whole
from orchestrator.inputs.text.console import console, say, working
from orchestrator.inputs.text.errors import NOT_PARKED, PARKED
from orchestrator.inputs.text.locked_folder import lock_folder
from orchestrator.presentation.report.replay import write_replay
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.studies.benchmark.driving import KINEMATIC, drive_scene
from orchestrator.studies.benchmark.optimal.reference import Optimum, find_optimum

EXAMPLES = """examples:
  apa bench optimal valet-dead-end
  apa bench optimal tpcap/Case8.yaml --out case8
  apa bench optimal tpcap/Case8.yaml --json

The scene is driven on the kinematic body without errors. The optimum has the same speed, acceleration, deceleration,
wheel angle, wheel rate and margin, the same gears, and starts from the drive: it is a local one. It counts only if its
inputs, integrated with finer steps, reach the goal, keep clear between the knots and are not slower than the drive;
otherwise it is reported as invalid.

writes DIR/optimal.json and DIR/report.html: the drive with the optimal path (dotted)
exit codes: 0 a valid optimum, 1 none or not parked, 2 bad input
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("scene", metavar="SCENE", help="scenario with a known target: a name or a YAML file")
    parser.add_argument("--out", type=Path, metavar="DIR", help="output folder (default: runs/bench/optimal/NAME)")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace) -> int:
    """Drive, optimize, print. Returns 0 if the optimum is valid, else 1."""
    drive, ran = drive_scene(arguments.scene, KINEMATIC, fmu_files("native", say), "native")
    out: Path = arguments.out or Path("runs/bench/optimal") / ran.scenario.name
    if not drive.parked:
        say(f"apa: the drive has not parked: {drive.reason or 'contact'}")
        return NOT_PARKED
    with working("optimizing"):
        optimum = find_optimum(ran.scenario, ran.recording)
    data, text = _data(ran.scenario.name, optimum), _text(optimum)
    summary = ran.summary.model_copy(update={"notes": [*ran.summary.notes, text]})
    with lock_folder(out):
        write_whole(out / "optimal.json", json.dumps(data, indent=1) + "\n")
        path = optimum.poses[:, :2] if optimum.is_valid else None
        write_replay(out / "report.html", ran.recording, summary, [], optimal_path=path)
    if arguments.json:
        print(json.dumps(data, indent=1))
    else:
        console().print(f"{ran.scenario.name}: {text}", markup=False, soft_wrap=True)
        console().print(f"results in {out}", markup=False, soft_wrap=True)
    return PARKED if optimum.is_valid else NOT_PARKED


def _text(optimum: Optimum) -> str:
    driven = f"driven in {optimum.driven_duration:.1f} s over {optimum.driven_length:.1f} m"
    if not optimum.is_valid:
        return f"{driven}; no valid optimum: {optimum.reason}"
    return (
        f"{driven}; optimum {optimum.duration:.1f} s, {optimum.length:.1f} m; driven over optimal: "
        f"time {optimum.time_ratio:.2f}, length {optimum.length_ratio:.2f}"
    )


def _data(name: str, optimum: Optimum) -> dict[str, Any]:
    known = {
        "duration": optimum.duration,
        "length": optimum.length,
        "clearance": optimum.clearance,
        "time_ratio": optimum.time_ratio,
        "length_ratio": optimum.length_ratio,
    }
    figures = {key: value if optimum.is_valid else None for key, value in known.items()}
    driven = {"driven_duration": optimum.driven_duration, "driven_length": optimum.driven_length}
    return {"scene": name, "valid": optimum.is_valid, "reason": optimum.reason, **figures, **driven}
