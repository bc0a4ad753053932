"""Runs every ``bench_*.py`` of this folder, each in a process of its own: ``python -m benchmarks [NAME...]``."""

import os
import platform
import subprocess
import sys
from pathlib import Path


def main(names: list[str]) -> int:
    """Run the benchmarks called ``names``, or all. Returns how many failed."""
    folder = Path(__file__).parent
    found = sorted(path.stem for path in folder.glob("bench_*.py"))
    chosen = [name for name in found if not names or name.removeprefix("bench_") in names or name in names]
    print(f"Python {platform.python_version()}, {os.cpu_count()} cores, {platform.machine()}")
    failed = 0
    for name in chosen:
        print(f"\n== {name.removeprefix('bench_')}", flush=True)
        failed += subprocess.run([sys.executable, "-m", f"benchmarks.{name}"], check=False).returncode != 0
    return failed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
