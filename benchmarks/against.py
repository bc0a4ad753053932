"""This checkout against another one of this project, in turns: ``python -m benchmarks.against FOLDER``.

FOLDER is a checkout with a ``.venv`` of its own in which it is installed with ``[native,sweep]`` and libcosimpy:

    git worktree add /tmp/release COMMIT && cd /tmp/release && python3.11 -m venv .venv
    .venv/bin/pip install -e '.[native,sweep]' libcosimpy

Each round is a process of either checkout, which runs the loops of its own ``bench_step`` and ``bench_sweep``, case 4.
Processor time, so that it holds on a busy machine; medians of the rounds.
"""

import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

ROUNDS = 5
PIECE = """
import json, time
time.perf_counter = time.process_time
from benchmarks import bench_step as step, bench_sweep as sweep

SAME = {f"vehicle.scene.boxes[{n}].{name}": 0.0 for n in (1, 2) for name in ("length", "width")}
scenario = step.load_scenario("guo2015-case4", [f"{key}={value}" for key, value in SAME.items()])
files = step.fmu_files("native", print)
loops = {
    "compiled master": step.master_loop(step.CompiledMaster, files, scenario),
    "limit": step.in_process_loop(scenario),
}
found = {}
for name, loop in loops.items():
    loop()
    found[name] = 1e9 * min(loop() for _ in range(9)) / step.STEPS
job, chunk = sweep.bound(500, **SAME)
sweep.run_batch(job, chunk)
spent = []
for _ in range(3):
    begun = time.process_time()
    out = sweep.run_batch(job, chunk)
    spent.append(time.process_time() - begun)
found["batch"] = 500 / min(spent)
found["steps in a run"] = float(out[:, 1].mean()) / 1e7
print(json.dumps(found))
"""
"""Nanoseconds a step of the pair, and runs a second of one thread; the quickest of some tries. No neighbours."""


def measured(folder: Path, python: Path) -> dict[str, float]:
    """Return what one process of a checkout found."""
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    done = subprocess.run([python, "-c", PIECE], cwd=folder, env=environment, check=True, capture_output=True)
    return dict(json.loads(done.stdout.splitlines()[-1]))


def main(other: Path) -> None:
    """Print both and their ratio."""
    ours = (Path(__file__).parents[1], Path(sys.executable))
    pairs = [(measured(*ours), measured(other, other / ".venv/bin/python")) for _ in range(ROUNDS)]
    print(f"{'':20}{'here':>10}{'other':>10}{'here / other':>14}   (medians of {ROUNDS} rounds)")
    for name in pairs[0][0]:
        here, there = (statistics.median(pair[side][name] for pair in pairs) for side in (0, 1))
        print(f"{name:20}{here:10.1f}{there:10.1f}{here / there:14.2f}")
    ratio = statistics.median(pair[0]["compiled master"] / pair[0]["limit"] for pair in pairs)
    print(f"compiled master / limit here: {ratio:.2f}")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
