"""Where the time of one co-simulation step goes: models, FMI calls, log; and the real-time factor of case 4.

Case 4 is run in process, with PythonFMUs, and with PythonFMUs and the log, in turn; medians.
"""

import statistics
import tempfile
from collections.abc import Callable
from pathlib import Path

from benchmarks.results import record, size
from benchmarks.rounds import in_turn, new_log
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files

MOST_ROUNDS = size(15, 1)


def main() -> None:
    """Print the split."""
    scenario = load_scenario("guo2015-case4")
    python, native = (fmu_files(kind, lambda text: None) for kind in ("python", "native"))
    folder = Path(tempfile.mkdtemp())
    runs: dict[str, Callable[[], float]] = {
        "models in process": lambda: run_scenario(scenario).wall_time,
        "PythonFMUs": lambda: run_scenario(scenario, python, kind="python").wall_time,
        "PythonFMUs, log": lambda: run_scenario(scenario, python, kind="python", log=new_log(folder)).wall_time,
        "native FMUs": lambda: run_scenario(scenario, native, kind="native").wall_time,
        "native FMUs, log": lambda: run_scenario(scenario, native, kind="native", log=new_log(folder)).wall_time,
    }
    ran = run_scenario(scenario, native, kind="native")
    steps = len(ran.recording.t) - 1
    times = in_turn(runs, MOST_ROUNDS)
    median = {name: statistics.median(values) for name, values in times.items()}
    rounds = len(times["native FMUs"])
    print(f"case 4: {steps} communication steps of {scenario.step * 1e3:g} ms, medians of {rounds} runs")
    for name, wall in median.items():
        factor = ran.recording.t[-1] / wall
        record(f"one step, {name}", wall / steps * 1e6, "us")
        print(f"  {name:20} {wall * 1e3:8.1f} ms  {wall / steps * 1e6:7.1f} us a step  {factor:6.0f} times real time")
    base, fmus, log = (median[name] / steps * 1e6 for name in list(runs)[:3])
    for name in ("PythonFMUs", "native FMUs"):
        ratio = median[f"{name}, log"] / median[name]
        record(f"{name}: with log / without", ratio, "1")
        print(f"  {name}: with log {ratio:.2f} times as long as without")
    print("one step of the PythonFMU pair, all signals exchanged and recorded:")
    print(f"  models and master {base:.1f} us, FMI calls {fmus - base:.1f} us, log {log - fmus:.1f} us")


if __name__ == "__main__":
    main()
