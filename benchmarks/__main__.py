"""Runs every ``bench_*.py`` of this folder, each in a process of its own: ``python -m benchmarks [NAME...]``."""

import argparse
import importlib
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.results import (
    FILE,
    MEASUREMENTS,
    SIZE,
    SKIPPED,
    SMALLEST,
    Measurement,
    commit,
    is_idle,
    lasting,
    machine,
    read_measurements,
    read_table,
    write_table,
)


def main(arguments: list[str]) -> int:
    """Run the benchmarks that are named, or all. Returns how many failed."""
    found = sorted(path.stem.removeprefix("bench_") for path in Path(__file__).parent.glob("bench_*.py"))
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(found)}")
    parser.add_argument("--smallest", action="store_true", help="show only that they work; writes no table")
    parser.add_argument("--resume", action="store_true", help="leave out those that the table has of this commit")
    parser.add_argument("--table", type=Path, default=FILE, help="where the results go")
    parser.add_argument("--in-process", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args(arguments)
    names = [name.removeprefix("bench_") for name in asked.names] or found
    unknown = [name for name in names if name not in found]
    if unknown:
        parser.error(f"no benchmark {', '.join(unknown)}; there are {', '.join(found)}")
    if asked.in_process:
        return run_here(names[0])
    if asked.resume:
        names = [name for name in names if name not in measured(asked.table)]
    print(f"Python {platform.python_version()}, {os.cpu_count()} cores, {platform.machine()}")
    measurements: list[Measurement] = []
    failed = 0
    for number, name in enumerate(names, start=1):
        begun = time.monotonic()
        failed += run_apart(name, asked.smallest, asked.table, measurements)
        print(f"{number} of {len(names)} benchmarks, this one {time.monotonic() - begun:.0f} s", flush=True)
    print(f"\n{text_of(measurements)}")
    return failed


def measured(table: Path) -> set[str]:
    """Return the benchmarks of which the table has results of this commit; none while files are changed."""
    now = commit()
    return {row.benchmark for row in read_table(table) if row.commit == now and not now.endswith("+")}


def text_of(measurements: list[Measurement]) -> str:
    """Return all that was measured as one table."""
    width = max((len(row.quantity) for row in measurements), default=0)
    return "\n".join(f"{row.benchmark:12} {row.quantity:{width}} {row.value:>10} {row.unit}" for row in measurements)


def run_here(name: str) -> int:
    """Run one benchmark in this process; one whose packages are not installed is skipped with a message."""
    try:
        module = importlib.import_module(f"benchmarks.bench_{name}")
    except ModuleNotFoundError as error:
        print(f"skipped: {error.name} is not installed")
        return SKIPPED
    module.main()
    return 0


def run_apart(name: str, is_smallest: bool, table: Path, all_measurements: list[Measurement]) -> bool:
    """Run one benchmark in a process of its own and write its results into the table; return whether it failed.

    They are added to ``all_measurements``.
    """
    print(f"\n== {name}", flush=True)
    where, was_idle = machine(), is_smallest or is_idle()
    with tempfile.TemporaryDirectory(prefix="benchmark-") as folder:
        file = Path(folder) / "measurements.jsonl"
        environment = {**os.environ, MEASUREMENTS: str(file), SIZE: SMALLEST if is_smallest else ""}
        command = [sys.executable, "-m", "benchmarks", "--in-process", name]
        code = subprocess.run(command, env=environment, check=False).returncode
        measurements = read_measurements(file, name, where)
    all_measurements += measurements
    if code == 0 and not measurements:
        print(f"{name} recorded nothing")
    if code == 0 and measurements and not is_smallest:
        kept = lasting(measurements, was_idle)
        if len(kept) < len(measurements):
            print(f"busy machine: {len(measurements) - len(kept)} wall times are not written to {table.name}")
        write_table(kept, table)
    return code not in (0, SKIPPED) or (code == 0 and not measurements)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
