"""An episode as a run: driven once more from its scene and its actions, recorded, judged, logged, shown by the replay.

The models are the same machine code, the loop is the co-simulation's: the same bits.
"""

import ctypes
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from apa_cosim.gym.scene_source import SceneSource
from apa_cosim.runs import Run
from controller_fmu.policy.signals import ACTION_COUNT
from fmus.native.libraries import load_model, memory_size
from modelkit.model import Model
from modelkit.variables import flatten, variables, with_values
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.session.session import Messages, run_instances
from orchestrator.simulation.cosim.fmu_instance import Array, Ports


class RecordedEpisode(NamedTuple):
    """What an episode is made of: nothing else decides about any of its bits."""

    source: SceneSource
    seed: int
    """Of its scene."""
    actions: Array
    """(periods, 3) as they were given."""
    period: float
    duration: float
    """[s]"""

    @property
    def scenario(self) -> Scenario:
        """Return the scene as a scenario that ends where the episode did."""
        whole = self.source.scenario_of(self.seed)
        stop = min(whole.longest, max(self.duration, whole.step))
        return whole.model_copy(update={"stop_time": stop})

    def run(self, log: Path | str | None = None) -> Run:
        """Return the episode as a run: all signals at all exchanges, and the verdict; ``log``: an MCAP file for it."""
        scenario = self.scenario
        vehicle, controller = (
            CompiledInstance(name, scenario.models[name], scenario.parameters_for(name))
            for name in ("vehicle", "controller")
        )
        replayed = ReplayedInstance(controller, self.actions, scenario.step_ns, round(self.period * 1e9))
        try:
            ran = run_instances(scenario, [vehicle, replayed], Messages(), log=None if log is None else Path(log))
        finally:
            for instance in (vehicle, replayed):
                instance.close()
        return Run(scenario, ran.recording, summarize(ran.recording, scenario, ran.wall_time))


class CompiledInstance:
    """A model as machine code in this process, without an FMU."""

    has_variable_step = True

    def __init__(self, name: str, model: Model, parameters: Mapping[str, Any]) -> None:
        self.name, self.identity = name, f"compiled {model.name}"
        given = with_values(model.params, dict(parameters))
        self.inputs, self.outputs = Ports(variables(model.inputs)), Ports(variables(model.outputs))
        self.parameters = Ports(variables(model.params, given))
        self._library = load_model(model)
        self._memory = (ctypes.c_int64 * (memory_size(self._library) // 8 + 1))()
        self._params = np.array([float(value) for value in flatten(given)])
        self._latest_outputs, self._latest_inputs = self.outputs.values.copy(), self.inputs.values.copy()

    def initialize(self, stop_ns: int) -> None:
        """Compute the state at time zero and the outputs that are valid then."""
        self._library.model_start(self._memory, self._params.ctypes.data, self._latest_outputs.ctypes.data)

    def start(self) -> None:
        """Nothing to leave."""

    def fetch_outputs(self) -> None:
        """Copy the latest outputs."""
        self.outputs.values[: len(self._latest_outputs)] = self._latest_outputs

    def send_inputs(self) -> None:
        """Copy the inputs."""
        self._latest_inputs[:] = self.inputs.values[: len(self._latest_inputs)]

    def step(self, t_ns: int, dt_ns: int) -> None:
        """Call the model's step."""
        self._library.model_step(self._memory, self._latest_inputs.ctypes.data, self._latest_outputs.ctypes.data, dt_ns)

    def close(self) -> None:
        """Nothing to free."""


class ReplayedInstance:
    """The policy's controller, whose actions are those of an episode: the first one comes after the first step."""

    has_variable_step = True

    def __init__(self, controller: CompiledInstance, actions: Array, first_ns: int, period_ns: int) -> None:
        self._controller, self._actions, self._first_ns, self._period_ns = controller, actions, first_ns, period_ns
        self.name, self.identity = controller.name, controller.identity
        self.inputs, self.outputs, self.parameters = controller.inputs, controller.outputs, controller.parameters
        first = self.inputs.index["action[1]"]
        self._places = slice(first, first + ACTION_COUNT)
        self._t_ns = -1
        """-1: not started."""

    def initialize(self, stop_ns: int) -> None:
        """Initialize the controller."""
        self._controller.initialize(stop_ns)

    def start(self) -> None:
        """From here on time runs, and actions are given."""
        self._t_ns = 0

    def fetch_outputs(self) -> None:
        """Copy the latest outputs; give the action of the period that has begun."""
        self._controller.fetch_outputs()
        number = (self._t_ns - self._first_ns) // self._period_ns
        if 0 <= number < len(self._actions):
            self.inputs.values[self._places] = self._actions[number]

    def send_inputs(self) -> None:
        """Copy the inputs."""
        self._controller.send_inputs()

    def step(self, t_ns: int, dt_ns: int) -> None:
        """Call the model's step."""
        self._controller.step(t_ns, dt_ns)
        self._t_ns = t_ns + dt_ns

    def close(self) -> None:
        """Nothing to free."""
