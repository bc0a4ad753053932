"""``python -m tests.fuzz KIND --seconds N --seed N``: attack for so long; what is found is kept and printed."""

import argparse
import random
import shutil
import sys
import tempfile
import time
from pathlib import Path

from tests.fuzz import external_inputs, fmi_calls, inputs, kills, logs, planner, received, systems, tables
from tests.fuzz.limits import ask, limit_memory

KINDS = {
    "inputs": inputs.fuzz,
    "logs": logs.fuzz,
    "kills": kills.fuzz,
    "calls": fmi_calls.fuzz,
    "tables": tables.fuzz,
    "ssp": systems.fuzz,
    "planner": planner.fuzz,
    "fmus": received.fuzz_fmus,
    "journals": received.fuzz_journals,
    "parquet": received.fuzz_parquet,
    "scenes": external_inputs.fuzz_scenes,
    "drives": external_inputs.fuzz_drives,
    "policies": external_inputs.fuzz_policies,
}

SLOWEST = 600.0
"""What is attacked is made first; that may compile [s]."""


def main() -> int:
    """Attack; return 1 if something was found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--seed", type=int, default=None, help="default: another one each time")
    parser.add_argument("--finds", type=Path, default=Path("build/fuzz"), help="where what is found is kept")
    asked = parser.parse_args()
    seed = random.SystemRandom().randrange(1 << 32) if asked.seed is None else asked.seed
    folder = Path(tempfile.mkdtemp(prefix="fuzz-"))
    log = folder / "run" / "run.mcap"
    ask(
        ["run", "guo2015-case4", "--fmus", "none", "--set", "stop_time=1", "--no-page", "--out", str(log.parent)],
        SLOWEST,
    )
    if asked.kind in ("logs", "parquet"):
        ask(["sweep", "guo2015-trial", "--stride", "100", "--no-page", "--out", str(folder / "study")], SLOWEST)
        (folder / "study" / "guo2015-trial.parquet").rename(log.with_name("table.parquet"))
    if asked.kind in ("inputs", "logs", "tables", "ssp", "fmus", "parquet", "scenes", "drives"):
        limit_memory()
    tried, found, until = 0, 0, time.monotonic() + asked.seconds
    for words, mistake in KINDS[asked.kind](folder, log, random.Random(seed)):
        tried += 1
        if mistake:
            found += 1
            place = asked.finds / f"{asked.kind}-{seed}-{tried}"
            shutil.copytree(folder, place, dirs_exist_ok=True, ignore=shutil.ignore_patterns("out"))
            print(f"{place}: apa {' '.join(words)[:300]}\n{mistake[-1500:]}\n", flush=True)
        if time.monotonic() > until:
            break
    shutil.rmtree(folder, ignore_errors=True)
    more = "".join(f", {count} {what}" for what, count in inputs.JUDGED.items())
    print(f"{asked.kind}: seed {seed}, {tried} tried in {asked.seconds:g} s{more}, {found} found")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
