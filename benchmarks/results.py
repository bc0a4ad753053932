"""What the benchmarks measured: a table with machine, date and commit, which the documentation shows.

``python -m benchmarks`` runs each benchmark in a process of its own. It names the file of measurements and the size in
the environment; the benchmark asks for its numbers with ``size`` and hands over what it measured with ``record``.
"""

import json
import os
import platform
import subprocess
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple, TypeVar

T = TypeVar("T")
ROOT = Path(__file__).parents[1]
FILE = ROOT / "benchmarks" / "results.tsv"
SIZE, MEASUREMENTS = "BENCHMARK_SIZE", "BENCHMARK_MEASUREMENTS"
SMALLEST = "smallest"
PROCESSOR_TIME = "processor time"
"""What the name of a quantity says that other programs do not change much."""
STAT = Path("/proc/stat")
LEAST_IDLE = 0.9
"""Share of the processors' time that others must leave."""
SKIPPED = 77
"""Exit code of a benchmark that needs what is not here, as of automake's tests."""


class Measurement(NamedTuple):
    """One number that a benchmark measured, and where."""

    benchmark: str
    quantity: str
    value: str
    """Four significant digits."""
    unit: str
    machine: str
    date: str
    """ISO 8601."""
    commit: str


def size(full: T, smallest: T) -> T:
    """Return the number for this run: ``smallest`` shows only that the benchmark works."""
    return smallest if os.environ.get(SIZE) == SMALLEST else full


def record(quantity: str, value: float, unit: str) -> None:
    """Hand a number over to the process that started the benchmark, if one did."""
    file = os.environ.get(MEASUREMENTS)
    if file:
        with Path(file).open("a", encoding="utf-8") as lines:
            lines.write(json.dumps([quantity, f"{value:.4g}", unit]) + "\n")


def machine() -> str:
    """Return processor architecture, cores, load when it began, and Python of this machine."""
    load = f", load {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    return f"{platform.machine()}, {os.cpu_count()} cores{load}, Python {platform.python_version()}"


def commit() -> str:
    """Return the short name of the commit, with ``+`` if files but the table were changed; empty outside a clone."""
    name = _git("describe", "--always", "--abbrev=9", "--exclude=*")
    table = f":!{FILE.relative_to(ROOT)}"
    return name + "+" if name and _git("status", "--porcelain", "--untracked-files=no", "--", ".", table) else name


def _git(*words: str) -> str:
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()


def is_idle() -> bool:
    """Return whether other programs leave the processors free for a second, so that wall times mean something.

    The load average would still have the benchmark before this one in it; it counts where there is no ``/proc/stat``.
    """
    if not STAT.exists():
        return not hasattr(os, "getloadavg") or os.getloadavg()[0] < (os.cpu_count() or 1)
    before = _processor_ticks()
    time.sleep(1.0)
    idle, every = (late - early for late, early in zip(_processor_ticks(), before, strict=True))
    return idle >= LEAST_IDLE * every


def _processor_ticks() -> tuple[int, int]:
    """Return the ticks of all processors without work, and all their ticks."""
    ticks = [int(word) for word in STAT.read_text(encoding="ascii").split("\n", 1)[0].split()[1:9]]
    return ticks[3] + ticks[4], sum(ticks)


def read_measurements(file: Path, benchmark: str, where: str) -> list[Measurement]:
    """Return what a benchmark handed over in ``file``; ``where`` is its machine."""
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    stamp = (where, datetime.now(UTC).date().isoformat(), commit())
    handed_over: list[tuple[str, str, str]] = [json.loads(line) for line in lines]
    return [Measurement(benchmark, quantity, value, unit, *stamp) for quantity, value, unit in handed_over]


def lasting(measurements: list[Measurement], was_idle: bool) -> list[Measurement]:
    """Return what goes into the table: on a busy machine processor times only."""
    return [row for row in measurements if was_idle or PROCESSOR_TIME in row.quantity]


def read_table(file: Path = FILE) -> list[Measurement]:
    """Return the rows of a table; none if there is no file."""
    lines = file.read_text(encoding="utf-8").splitlines()[1:] if file.exists() else []
    return [Measurement(*line.split("\t")) for line in lines]


def write_table(new: list[Measurement], file: Path = FILE) -> None:
    """Replace the rows of the benchmarks that ran, keep those of the others."""
    ran = {row.benchmark for row in new}
    rows = sorted([*(row for row in read_table(file) if row.benchmark not in ran), *new], key=lambda row: row.benchmark)
    file.write_text("\n".join("\t".join(row) for row in [Measurement._fields, *rows]) + "\n", encoding="utf-8")
