"""Systems on the same scenes: this project's controllers, policies, FMUs of others; how many of them park."""

import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from apa_cosim.gym.catalogue import scene_source
from apa_cosim.gym.episodes import Episodes
from apa_cosim.gym.ids import IDS
from apa_cosim.gym.options import EnvironmentOptions
from apa_cosim.gym.policies import OnnxPolicy, Policy, RandomPolicy
from apa_cosim.gym.recorded import CompiledInstance
from apa_cosim.gym.scene_source import SceneSource
from apa_cosim.runs import with_foreign
from controller_fmu import System
from fmus.compiled_episodes import RUNNING
from fmus.policy_fmu import PEDALS
from modelkit.variables import variables
from orchestrator.evaluation.verdict.confidence import wilson
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.models import models_for
from orchestrator.inputs.scenario.obstacle_map import map_of
from orchestrator.inputs.scenario.scenario import DONE, Scenario
from orchestrator.inputs.text.errors import BadInput, suggestion_or_choices
from orchestrator.session.foreign import ImportedFmus, fmu_of
from orchestrator.session.session import Messages, run_instances
from orchestrator.simulation.cosim.fmu_instance import FmuInstance

RANDOM = "random"
SIDE_BY_SIDE = 64
"""Episodes of a policy that run at once."""


class SceneOutcome(NamedTuple):
    """How one scene came out."""

    outcome: str
    reason: str
    duration: float
    contact: bool


class Score(NamedTuple):
    """How a system came out on the scenes of an environment."""

    system: str
    scenes: str
    outcomes: Sequence[SceneOutcome]

    @property
    def success_count(self) -> int:
        """Scenes that ended parked."""
        return sum(item.outcome in DONE for item in self.outcomes)

    @property
    def contacts(self) -> int:
        """Scenes with contact."""
        return sum(item.contact for item in self.outcomes)

    @property
    def median_time(self) -> float:
        """Of the parked [s]; NaN if there are none."""
        return statistics.median([item.duration for item in self.outcomes if item.outcome in DONE] or [float("nan")])

    @property
    def interval(self) -> tuple[float, float]:
        """Of the parked share, 95 % (Wilson)."""
        return wilson(self.success_count, len(self.outcomes))


def score(system: str, name: str, seeds: Sequence[int], options: EnvironmentOptions) -> Score:
    """Return how ``system`` does on the scenes of the environment ``name``. Raises ``BadInput``.

    ``system``: ``random``, a policy's ``.onnx``, a controller's ``.fmu``, or the name of a controller of this project.
    """
    if name not in IDS:
        raise BadInput(f"no such environment{suggestion_or_choices(name, list(IDS))}", key=name)
    suffix = Path(system).suffix.lower()
    if system == RANDOM or suffix == ".onnx":
        policy = RandomPolicy() if system == RANDOM else OnnxPolicy(Path(system))
        source = scene_source(IDS[name], options._replace(pedals=PEDALS[policy.action_count]))
        return Score(system, name, policy_outcomes(policy, source, seeds, options.period))
    source = scene_source(IDS[name], options)
    if suffix == ".fmu":
        foreign = ImportedFmus({"controller": fmu_of(system)})
        return Score(system, name, [_run(source.scenario_of(seed), foreign) for seed in seeds])
    return Score(system, name, [_run(for_system(source.scenario_of(seed), system), ImportedFmus()) for seed in seeds])


def policy_outcomes(policy: Policy, source: SceneSource, seeds: Sequence[int], period: float) -> list[SceneOutcome]:
    """Return how a policy does on the scenes of ``seeds``."""
    episodes = Episodes(source, min(SIDE_BY_SIDE, len(seeds)), period)
    found: list[SceneOutcome] = []
    for first in range(0, len(seeds), episodes.count):
        some = np.array(seeds[first : first + episodes.count])
        which = np.arange(len(some))
        episodes.begin(which, some)
        while (episodes.progress == RUNNING).any():
            episodes.advance(np.asarray(policy(episodes.observations), dtype=np.float64))
        ended = episodes.results(which)
        durations = ended.numbers["duration"].tolist()
        rows = zip(ended.outcomes, ended.reasons, durations, ended.contacts.tolist(), strict=True)
        found += [SceneOutcome(*row) for row in rows]
    episodes.close()
    return found


def for_system(scenario: Scenario, system: str) -> Scenario:
    """Return a scene of the environments with a controller of this project, given what it has parameters for.

    Raises ``BadInput`` for a name that no controller has.
    """
    names = {item.name.lower(): int(item) for item in System}
    if system.lower() not in names:
        raise BadInput(f"no such system{suggestion_or_choices(system, [RANDOM, *names])}", key=system)
    chosen = {"system": names[system.lower()]}
    known = {item.name for item in variables(models_for(chosen)["controller"].params)} - {"system"}
    given = {name: value for name, value in scenario.controller.items() if name in known}
    whole = scenario.model_copy(update={"controller": {**given, **chosen}})
    return whole.model_copy(update={"controller": {**whole.controller, **map_of(whole)}})


def _run(scenario: Scenario, given: ImportedFmus) -> SceneOutcome:
    scenario, foreign = with_foreign(scenario, None, given)
    messages = Messages()
    instances = [_instance(name, scenario, foreign, messages) for name in scenario.places]
    try:
        ran = run_instances(scenario, instances, messages, foreign=foreign)
    finally:
        for instance in instances:
            instance.close()
    summary = summarize(ran.recording, scenario, ran.wall_time)
    return SceneOutcome(summary.outcome, summary.reason, summary.duration, summary.penetration > 0.0)


def _instance(name: str, scenario: Scenario, foreign: ImportedFmus, messages: Messages) -> FmuInstance:
    if name in foreign.files:
        ours, parameters = scenario.models.get(name), scenario.parameters_for(name)
        return foreign.make_instance(name, foreign.files[name], parameters, messages.from_fmu, ours)
    return CompiledInstance(name, scenario.models[name], scenario.parameters_for(name))
