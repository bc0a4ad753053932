"""How long the planner takes, sample by sample, and the drive: ``python -m benchmarks.bench_planning [FILE.yaml ...]``.

The scenarios are those of ``apa import tpcap``, or others of ``parking`` with a known target; without a file, those
shipped.
Times are of the processor, compiled; samples are measured in three passes, of which the least counts, since other
programs take their share.
"""

import argparse
import statistics
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.results import record, size
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.studies.benchmark.driving import DOUBLE_TRACK, KINEMATIC, drive_scene
from orchestrator.studies.benchmark.planning import plan_scene
from orchestrator.studies.benchmark.scenes import valet_scenarios

PASSES = size(3, 1)
HEAD = "| case | samples | planned in | slowest sample | steps | margin | length | cusps | driven in | clearance |"


def main(arguments: Sequence[str] = ()) -> None:
    """Print a table of the files among ``arguments``, or of the shipped scenarios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*")
    parser.add_argument("--perfect", action="store_true", help="drive without errors of sensors and actuators")
    parser.add_argument("--set", action="append", default=[])
    asked = parser.parse_args(arguments)
    files, rows = fmu_files("native", lambda text: None), []
    body = KINEMATIC if asked.perfect else DOUBLE_TRACK
    print(HEAD, "|---:" * 10 + "|", sep="\n")
    for name in asked.files or size(valet_scenarios(), ["valet-parallel"]):
        plan = plan_scene(load_scenario(name, asked.set), PASSES)
        drive, _ = drive_scene(name, body, files, "native", overrides=asked.set)
        slowest = max(plan.sample_times)
        rows.append((plan.time, slowest, drive.parked))
        print(
            f"| {Path(name).stem.removeprefix('Case')} | {len(plan.sample_times)} | {plan.time * 1e3:.1f} ms | "
            f"{slowest * 1e3:.2f} ms | {plan.steps} | {plan.margin * 100:.0f} cm | "
            f"{drive.length:.1f} m | {max(drive.manoeuvres - 1, 0)} | "
            f"{drive.duration:.0f} s{' ' + drive.reason if drive.reason else ''} | {drive.clearance * 100:.1f} cm |",
            flush=True,
        )
    middle = statistics.median(row[0] for row in rows)
    record("planning, median of the scenarios, processor time", middle * 1e3, "ms")
    record("planning, slowest sample, processor time", max(row[1] for row in rows) * 1e3, "ms")
    print(
        f"\nmedian {middle * 1e3:.1f} ms, longest {max(row[0] for row in rows):.2f} s, "
        f"slowest sample {max(row[1] for row in rows) * 1e3:.2f} ms, "
        f"{sum(row[2] for row in rows)} of {len(rows)} parked"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
