"""Parking episodes side by side: what an environment of one car and one of many cars both are.

A period is one call of machine code for all cars: vehicle, sensors, the policy's controller, faults, what is kept for
the verdict. An episode ends as a run does (its controller has ended and the car stands, or the stop time), and at the
first contact. It is judged as a run of a study is: the same numbers, the same requirements.
"""

from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from apa_cosim.gym.options import Reward
from apa_cosim.gym.polygon_contact import PolygonClearance
from apa_cosim.gym.recorded import RecordedEpisode
from apa_cosim.gym.scene_source import SceneSource
from apa_cosim.gym.spaces import Floats
from controller_fmu.policy.signals import ACTION_COUNT, OBSERVATION_COUNT
from fmus.compiled_batch import SampleTime
from fmus.compiled_episodes import AT_STOP_TIME, BROKEN_OFF, RUNNING, Access, CompiledEpisodes, EpisodeModels
from fmus.native.compilers import find_compiler
from fmus.policy_fmu import ACTION_PERIOD, MAX_ACTION_PERIOD
from fmus.study_slices import StudyCode, study_slices
from orchestrator.evaluation.verdict.geometry import CarOutline
from orchestrator.evaluation.verdict.measures import Measure
from orchestrator.evaluation.verdict.numbers import CLEARANCE
from orchestrator.inputs.scenario.scenario import DONE, PENETRATION, Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.batch import signal_to_record, stop_condition_of
from orchestrator.studies.sweep.disturbed import fault_receivers
from orchestrator.studies.sweep.rows import FIRST_MEASURE, measures_for
from orchestrator.studies.sweep.verdict import OUTCOMES, judge_rows

Integers = NDArray[np.int64]
Bools = NDArray[np.bool_]
ACTIONS = tuple(f"controller.action[{number + 1}]" for number in range(ACTION_COUNT))
OBSERVED = tuple(f"controller.observation[{number + 1}]" for number in range(OBSERVATION_COUNT))
POSE = ("vehicle.pose.x", "vehicle.pose.y", "vehicle.pose.heading", "vehicle.front_wheel_angle")
COST = OBSERVATION_COUNT
"""Place of the cost to go among what is seen; the pose and the front wheels follow."""
CONTACT = SampleTime("vehicle.contact", (1,))


class Results(NamedTuple):
    """Verdicts of some episodes, an entry for each."""

    outcomes: list[str]
    reasons: list[str]
    contacts: Bools
    numbers: dict[str, Array]
    """By the names of ``summary.json``; SI units."""


class Episodes:
    """``count`` episodes with scenes of ``source``. Raises ``BadInput`` without a C compiler."""

    def __init__(self, source: SceneSource, count: int, period: float = ACTION_PERIOD, threads: int = 1) -> None:
        scenario = source.scenario
        if not 0.0 < period <= MAX_ACTION_PERIOD:
            raise BadInput(f"{period!r} s: expected more than 0 and at most {MAX_ACTION_PERIOD:g} s", key="period")
        self.source, self.count, self.period = source, count, period
        self.measures = measures_for(scenario)
        self._clearance = FIRST_MEASURE + self.measures.index(CLEARANCE)
        self._runs = _compile(scenario, count, self.measures)
        self.seeds: Integers = np.zeros(count, dtype=np.int64)
        self.is_reported: Bools = np.ones(count, dtype=bool)
        """Whether :func:`take_step` has returned the end of each episode, or there was none yet."""
        self._truth = source.scenes(np.array([0])).truth.repeat(count)
        self.actions: Array = np.zeros((count, ACTION_COUNT))
        self._period_ns = round(period * 1e9)
        self._step_ns = 0
        self._polygons: list[PolygonClearance | None] = [None] * count
        self._action_log: list[list[bytes]] = [[] for _ in range(count)]
        self._finished: list[RecordedEpisode | None] = [None] * count
        self._threads = ThreadPoolExecutor(threads) if threads > 1 else None
        edges = np.linspace(0, count, threads + 1).astype(int).tolist()
        self._parts = list(pairwise(edges))

    @property
    def progress(self) -> Integers:
        """How each episode stands: running, at its stop time, standing at its end, broken off."""
        return self._runs.progress

    @property
    def observations(self) -> Floats:
        """(count, observations) as of now, a copy."""
        return self._runs.seen[:, :OBSERVATION_COUNT].astype(np.float32)

    @property
    def cost_to_go(self) -> Array:
        """Of each car to its target [m]."""
        return self._runs.seen[:, COST]

    @property
    def poses(self) -> Array:
        """(count, 4) x, y [m], heading, front-wheel angle [rad]."""
        return self._runs.seen[:, COST + 1 :]

    @property
    def times(self) -> Array:
        """Of each episode [s]."""
        return self._runs.rows[:, 1] / 1e9

    def begin(self, which: Integers, seeds: Integers) -> None:
        """Begin the episodes ``which`` with the scenes of ``seeds``."""
        scenes = self.source.scenes(seeds)
        if (self._period_ns % scenes.times[:, 0]).any():
            raise BadInput(f"{self.period:g} s is no whole number of communication steps", key="period")
        self._step_ns = int(np.gcd.reduce(scenes.times[:, 0], initial=self._step_ns))
        for number in which.tolist():
            if self._action_log[number]:
                self._finished[number] = self._record(number)
            self._action_log[number] = []
        self._runs.begin(which, scenes.parameters, scenes.times, scenes.faults)
        self.seeds[which] = seeds
        self.is_reported[which] = False
        for whole, part in zip(self._truth, scenes.truth, strict=True):
            whole[which] = part
        for place, number in enumerate(which.tolist()):
            polygons = self.source.obstacles(int(seeds[place]))
            car = CarOutline(*scenes.truth.cars[place].tolist())
            self._polygons[number] = PolygonClearance(polygons, car, self.poses[number, :3]) if polygons else None

    def advance(self, actions: Array) -> None:
        """Take all that are running on by a period with ``actions`` (count, 2 or 3)."""
        self.actions[:, : actions.shape[1]] = actions
        for number in np.flatnonzero(self._runs.progress == RUNNING).tolist():
            self._action_log[number].append(self.actions[number].tobytes())
        if any(self._polygons):
            self._advance_by_exchanges()
        elif self._threads is None:
            self._runs.advance(self.actions, self._period_ns)
        else:
            list(self._threads.map(lambda part: self._runs.advance(self.actions, self._period_ns, *part), self._parts))

    def _advance_by_exchanges(self) -> None:
        """Look for contact with polygons at each exchange; the verdict has the smaller clearance."""
        runs = self._runs
        for _ in range(self._period_ns // self._step_ns):
            running = np.flatnonzero(runs.progress == RUNNING).tolist()
            runs.advance(self.actions, self._step_ns)
            for number in running:
                near = self._polygons[number]
                if near is not None and near.look(self.poses[number, :3]) < 0.0:
                    runs.progress[number] = BROKEN_OFF
        for near, row in zip(self._polygons, runs.rows, strict=True):
            if near is not None:
                row[self._clearance] = min(row[self._clearance], near.smallest)

    def results(self, which: Integers) -> Results:
        """Return the verdicts of ``which``, as they would be if they ended now."""
        truth, rows = self._truth.select(which), self._runs.rows[which]
        verdict = judge_rows(self.source.scenario, truth, self.measures, rows)
        contacts = verdict.numbers[PENETRATION] > 0.0
        reasons = list(verdict.reason)
        for place in np.flatnonzero(self.progress[which] == BROKEN_OFF).tolist():
            reasons[place] = "contact" if contacts[place] else "wheel at a low kerb"
        return Results([OUTCOMES[code] for code in verdict.outcome], reasons, contacts, verdict.numbers)

    def record(self, number: int, previous: bool = False) -> RecordedEpisode:
        """Return an episode as it is so far, or the one before it. Raises ``BadInput`` if there is none."""
        found = self._finished[number] if previous else self._record(number)
        if found is None:
            raise BadInput(f"car {number} has no earlier episode")
        return found

    def _record(self, number: int) -> RecordedEpisode:
        actions = np.frombuffer(b"".join(self._action_log[number])).reshape(-1, ACTION_COUNT)
        return RecordedEpisode(self.source, int(self.seeds[number]), actions, self.period, float(self.times[number]))

    def close(self) -> None:
        """Free the memory."""
        self._runs.close()
        if self._threads is not None:
            self._threads.shutdown()


class Stepped(NamedTuple):
    """What a period has brought, an entry for each car."""

    rewards: Array
    terminated: Bools
    truncated: Bools
    results: Results | None
    """Verdicts of those that have ended in it."""


def take_step(episodes: Episodes, actions: Array, reward: Reward) -> Stepped:
    """Take all running episodes on by a period; those whose end was returned before get no reward and end no more."""
    cost, time = episodes.cost_to_go.copy(), episodes.times
    episodes.advance(actions)
    progress = episodes.progress
    rewards = reward.progress * (cost - episodes.cost_to_go) + reward.time * (episodes.times - time)
    ended = (progress != RUNNING) & ~episodes.is_reported
    episodes.is_reported |= ended
    truncated = ended & (progress == AT_STOP_TIME)
    terminated = ended & ~truncated
    results = None
    if ended.any():
        results = episodes.results(np.flatnonzero(ended))
        rewards[ended] += np.where(truncated[ended], 0.0, final_rewards(results, reward))
    return Stepped(rewards, terminated, truncated, results)


def final_rewards(results: Results, reward: Reward) -> Array:
    """Return what the ends of episodes are worth."""
    found = [
        reward.parked if outcome in DONE else reward.contact if contact else reward.otherwise
        for outcome, contact in zip(results.outcomes, results.contacts.tolist(), strict=True)
    ]
    return np.array(found)


def _compile(scenario: Scenario, count: int, measures: list[Measure]) -> CompiledEpisodes:
    access = Access(ACTIONS, (*OBSERVED, "controller.cost_to_go", *POSE), CONTACT)
    kept = [signal_to_record(item) for item in measures]
    faults = tuple(item.inputs for item in fault_receivers(scenario))
    task = EpisodeModels(dict(scenario.models), stop_condition_of(scenario), kept, access, faults)
    try:
        slices = study_slices(task.models, task.signals(), {})
        code = StudyCode(slices, find_compiler().options_for_this_machine())
        return CompiledEpisodes(count, task._replace(code=code))
    except RuntimeError as error:
        raise BadInput(f"{error}: the environments are compiled; install apa-cosim[native]") from error
