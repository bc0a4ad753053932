"""How long the planner takes, sample by sample: its compiled code alone, called as the vehicle stands at the start."""

import time
from typing import NamedTuple

import numpy as np

from fmus.native.libraries import load_model, memory_size
from modelkit.variables import flatten, variables, with_values
from modelkit.vocabulary import Gear
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput

SAMPLE_NS = 10_000_000
"""Between two samples of the controller [ns]."""
MAX_SAMPLES = 6000
FREE_RANGE = 5.0
"""What the ultrasonic sensors measure [m]: no echo."""
SEARCHED, PIECES, MARGIN, REASON = "apa.steps", "apa.segments", "apa.margin", "reason"


class FoundPlan(NamedTuple):
    """What the planner has found, and the processor time that it took."""

    found: bool
    reason: str
    """Why there is none; empty if there is one."""
    steps: int
    """Of the search."""
    margin: float
    """Clearance [m] that the path keeps."""
    sample_times: tuple[float, ...]
    """Processor time [s] of each sample until the search ended: the least of several passes."""

    @property
    def time(self) -> float:
        """Processor time [s] of the whole search."""
        return sum(self.sample_times)


def plan_scene(scenario: Scenario, passes: int = 3) -> FoundPlan:
    """Return the plan of a scene. Raises ``BadInput`` if its controller has no planner of its own."""
    names = [item.name for item in variables(scenario.models["controller"].outputs)]
    if SEARCHED not in names or any(name not in names for name in (PIECES, MARGIN, REASON)):
        text = "this controller plans no path to the target: expected apa or apa_large"
        raise BadInput(text, file=scenario.file, key="controller.system")
    done = [_run_planner(scenario, names) for _ in range(passes)]
    outputs = done[0][0]
    times = np.min([item[1] for item in done], axis=0)
    found = outputs[PIECES] > 0.0
    reason = "" if found else _reason(scenario, outputs[REASON])
    return FoundPlan(found, reason, int(outputs[SEARCHED]), outputs[MARGIN], tuple(times.tolist()))


def _run_planner(scenario: Scenario, names: list[str]) -> tuple[dict[str, float], list[float]]:
    """Return the outputs when the search has ended, and the processor time [s] of each sample until then."""
    model = scenario.models["controller"]
    library = load_model(model)
    params = np.array(flatten(with_values(model.params, scenario.controller)), dtype=float)
    inputs = dict.fromkeys((item.name for item in variables(model.inputs)), 0.0) | {"gear": float(Gear.DRIVE)}
    inputs |= {name: FREE_RANGE for name in inputs if name.startswith("ultrasonic[")}
    inputs |= {f"odometry.{axis}": scenario.vehicle.get(f"start.{axis}", 0.0) for axis in ("x", "y", "heading")}
    u, y = np.array(list(inputs.values()), dtype=float), np.zeros(len(names))
    memory = np.zeros(memory_size(library), dtype=np.uint8)
    library.model_start(memory.ctypes.data, params.ctypes.data, y.ctypes.data)
    ends = names.index(PIECES), names.index(REASON)
    times: list[float] = []
    while not y[ends[0]] and not y[ends[1]] and len(times) < MAX_SAMPLES:
        begun = time.thread_time()
        library.model_step(memory.ctypes.data, u.ctypes.data, y.ctypes.data, SAMPLE_NS)
        times.append(time.thread_time() - begun)
    return dict(zip(names, y.tolist(), strict=True)), times


def _reason(scenario: Scenario, value: float) -> str:
    outputs = variables(scenario.models["controller"].outputs)
    states = next(item.signal.states for item in outputs if item.name == REASON)
    if not value or states is None:
        return f"no path in {MAX_SAMPLES * SAMPLE_NS * 1e-9:.0f} s"
    return states(int(value)).name.lower()
