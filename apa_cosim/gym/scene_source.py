"""Where episodes begin: a scene of a random seed, as numbers for the compiled models, as truth for the verdict, and as
a scenario for a log. The same seed is the same scene, whatever was drawn before.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from modelkit.variables import variables
from orchestrator.evaluation.verdict.polygons import Polygons
from orchestrator.evaluation.verdict.truth import CAR_KEYS, GroundTruth
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.world.factors import FACTORS
from orchestrator.studies.sweep.disturbed import numbers_for
from orchestrator.studies.sweep.fields import find_field
from orchestrator.studies.sweep.job import Chunk, Job, Times, arrays, chunk_scenario, make_job
from orchestrator.studies.sweep.study.design import Design
from orchestrator.studies.sweep.study.space import Factor, Space
from orchestrator.studies.sweep.study.study import Study

Seeds = NDArray[np.int64]
TARGET = ("x", "y", "heading")
SLOT = ("x", "y", "heading", "length", "width")
Place = Callable[[dict[str, Array], Seeds], dict[str, Array]]
"""(values of all factors, seeds) -> columns by the names of a study's fields."""


class Scenes(NamedTuple):
    """Scenes of some seeds, a line for each."""

    parameters: Array
    times: Times
    faults: Array
    truth: GroundTruth


class SceneSource(Protocol):
    """Where episodes begin."""

    scenario: Scenario
    """What all scenes share."""

    def scenes(self, seeds: Seeds) -> Scenes:
        """Return the scenes of ``seeds``."""

    def scenario_of(self, seed: int) -> Scenario:
        """Return the scene of a seed as a complete scenario."""

    def obstacles(self, seed: int) -> Polygons:
        """Return the polygons of the scene of a seed."""


class SampledScenes:
    """Scenes drawn from factors, as a study's runs are."""

    def __init__(self, scenario: Scenario, factors: Sequence[Factor], fixed: Mapping[str, float], place: Place) -> None:
        self.scenario = scenario
        self._space = Space(factors, lambda values, seeds: np.column_stack(list(self._columns(values, seeds).values())))
        self._fixed = {factor.name: factor.nominal for factor in FACTORS} | dict(fixed)
        self._place = place
        one = np.array([1])
        names = list(self._columns(self._space.values_by_name(self._space.nominal()[None]), one))
        fields = [find_field(name, scenario) for name in names]
        values = self._space.values(self._space.nominal()[None], one)
        seeded = [("vehicle", "ultrasonic.seed", find_field("vehicle.ultrasonic.seed", scenario).place)]
        self.job: Job = make_job(Study(scenario, Design(fields, values, one), {"name": scenario.name}, seeded))
        first, self._times = arrays(self.job, self._chunk(values, one))
        self._first = first[0]
        self._column = {name: number for number, name in enumerate(names)}
        widths = [len(variables(model.params)) for model in scenario.models.values()]
        starts = dict(zip(scenario.models, np.cumsum([0, *widths]).tolist(), strict=False))
        models = [(column, field) for column, field in enumerate(fields) if field.owner in starts]
        self._from = [column for column, _ in models]
        self._to = [starts[field.owner] + field.place for _, field in models]
        self._seed_place = starts["vehicle"] + seeded[0][2]
        self._varied = {
            (field.place, field.name): column for column, field in enumerate(fields) if field.owner == "faults"
        }

    def scenes(self, seeds: Seeds) -> Scenes:
        """Return the scenes of ``seeds``."""
        values = self._values(seeds)
        lines = np.tile(self._first, (len(seeds), 1))
        lines[:, self._to] = values[:, self._from]
        lines[:, self._seed_place] = seeds
        times = np.tile(self._times[0], (len(seeds), 1))
        if "step" in self._column:
            times[:, 0] = np.round(values[:, self._column["step"]] * 1e9)
        varied = {key: values[:, column] for key, column in self._varied.items()}
        return Scenes(lines, times, numbers_for(self.scenario, seeds, varied), self._truth(values))

    def scenario_of(self, seed: int) -> Scenario:
        """Return the scene of a seed as a complete scenario."""
        seeds = np.array([seed])
        found = chunk_scenario(self.job, self._chunk(self._values(seeds), seeds), 0)
        return found.model_copy(update={"name": f"{found.name}-{seed}"})

    def obstacles(self, seed: int) -> Polygons:
        """Return that there are no polygons."""
        return ()

    def _values(self, seeds: Seeds) -> Array:
        count = len(self._space.factors)
        shares = np.array([np.random.default_rng([seed, 0]).random(count) for seed in seeds.tolist()])
        return self._space.values(shares, seeds)

    def _columns(self, values: Mapping[str, Array], seeds: Seeds) -> dict[str, Array]:
        count = len(seeds)
        complete = {name: np.full(count, float(value)) for name, value in self._fixed.items()} | dict(values)
        found = self._place(complete, seeds)
        given = {f"controller.target.{name}": found[f"target.{name}"] for name in TARGET}
        return found | given | {f"controller.slot.{name}": found[f"slot.{name}"] for name in SLOT}

    def _truth(self, values: Array) -> GroundTruth:
        wheelbase, front, rear, width = (values[:, self._column[key]] for key in CAR_KEYS)
        return GroundTruth(
            values[:, [self._column[f"target.{name}"] for name in TARGET]],
            values[:, [self._column[f"slot.{name}"] for name in SLOT]],
            np.empty((len(values), 0, 4)),
            np.column_stack([wheelbase + front, rear, 0.5 * width, wheelbase]),
        )

    @staticmethod
    def _chunk(values: Array, seeds: Seeds) -> Chunk:
        return Chunk(0, 0, values, seeds)
