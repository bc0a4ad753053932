"""One study bound to its scenario: from a line of the design to parameter arrays, or to a scenario of its own.

A job is plain data, so that it can be sent to another process or machine.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from modelkit.variables import flatten, variables, with_values
from orchestrator.evaluation.verdict.measures import Instants, Measure
from orchestrator.evaluation.verdict.truth import TRUE_KEYS, GroundTruth, join_truths, truth_of
from orchestrator.inputs.scenario.models import MODELS, models_for
from orchestrator.inputs.scenario.pace import DURATION, NAMES, UNLIMITED, stop_times
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.quantities import NS_PER_SECOND
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.fields import TRUE_OWNERS
from orchestrator.studies.sweep.rows import measures_for
from orchestrator.studies.sweep.study.design import Design
from orchestrator.studies.sweep.study.study import Study

Times = NDArray[np.int64]


class Job(NamedTuple):
    """Everything a run needs beside its line of the design."""

    scenario: dict[str, Any]
    """The scenario all runs share, as plain data."""
    keys: list[str]
    """Columns of the design."""
    owners: list[str]
    names: list[str]
    places: list[int]
    seeded: list[tuple[str, str, int]]
    """(model, parameter, place) of the parameters that take the run's seed."""
    measures: list[Measure]
    runs: int = 0
    """How many runs the study has; 0 if that is not known."""


class Chunk(NamedTuple):
    """Some neighbouring runs."""

    number: int
    first: int
    """Row of the first one in the table, from 0."""
    values: Array
    seeds: NDArray[np.int64]


def make_job(study: Study) -> Job:
    """Return the job of ``study``. Raises ``BadInput`` for a limit or measure of an unknown signal."""
    fields = study.design.fields
    limits = [limit for items in study.within.values() for limit in items]
    return Job(
        {**study.scenario.model_dump(mode="python"), "file": study.scenario.name},
        [field.key for field in fields],
        [field.owner for field in fields],
        [field.name for field in fields],
        [field.place for field in fields],
        list(study.seeded),
        measures_for(study.scenario, limits, study.measures.values()),
        len(study.design.seeds),
    )


def chunk_scenario(job: Job, chunk: Chunk, number: int) -> Scenario:
    """Return the complete scenario of one run of ``chunk``, for the ordinary ``apa run``."""
    data = {**job.scenario, **{owner: dict(job.scenario[owner]) for owner in MODELS}}
    data["decimation"] = dict(data["decimation"])
    data["faults"] = [dict(fault) for fault in data["faults"]]
    data["seed"] = int(chunk.seeds[number])
    models = models_for(job.scenario["controller"])
    theirs = _theirs(data)
    kinds = {owner: [item.kind for item in variables(model.params)] for owner, model in models.items()}
    values = chunk.values[number].tolist()
    for name, value in _controller_targets(job, values):
        data["controller"][name] = value
    for owner, name, place, value in zip(job.owners, job.names, job.places, values, strict=True):
        if owner in theirs:
            theirs[owner][name] = value
        elif owner in MODELS:
            data[owner][name] = kinds[owner][place](value)
        elif owner == "faults":
            data["faults"][place][name] = value
        elif owner in TRUE_OWNERS:
            data[owner] = {**data[owner], name: value}
        elif name.startswith("decimation."):
            data["decimation"][name.removeprefix("decimation.")] = int(value)
        else:
            data[name] = int(value) if name == "seed" else value
    for owner, name, _ in job.seeded:
        data[owner][name] = data["seed"]
    return Scenario(**data)


def _theirs(data: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Return instance -> where a scenario, as plain data, has the parameters of its FMU, for third-party ones."""
    if data["system"] is None:
        return {}
    instances = {
        name: {**item, "parameters": dict(item["parameters"])} for name, item in data["system"]["components"].items()
    }
    data["system"] = {**data["system"], "components": instances}
    return {
        name: data[name] if name in MODELS else item["parameters"] for name, item in instances.items() if item["file"]
    }


def _controller_targets(job: Job, values: list[Any]) -> list[tuple[str, Any]]:
    """Return (parameter, value) of the controller that follow a target which differs from run to run.

    A controller with another target than the scenario's keeps to that.
    """
    reported, true = job.scenario["controller"], job.scenario["target"]
    return [
        (f"target.{name}", value)
        for owner, name, value in zip(job.owners, job.names, values, strict=True)
        if owner == "target" and reported.get(f"target.{name}") == true[name]
    ]


def truths(job: Job, chunk: Chunk) -> GroundTruth:
    """Return what is true in each run of ``chunk``."""
    scenario = Scenario(**job.scenario)
    vehicle = {item.name: float(item.start) for item in variables(MODELS["vehicle"].params)} | scenario.vehicle
    same = truth_of(scenario, vehicle)
    keys = list(zip(job.owners, job.names, strict=True))
    if not any(f"{owner}.{name}".startswith(TRUE_KEYS) for owner, name in keys):
        return same.repeat(len(chunk.seeds))
    found = []
    for values in chunk.values.tolist():
        given = list(zip(keys, values, strict=True))
        own = {owner: {name: value for (other, name), value in given if other == owner} for owner in TRUE_OWNERS}
        moved = {owner: getattr(scenario, owner).model_copy(update=new) for owner, new in own.items() if new}
        car = {name: value for (owner, name), value in given if owner == "vehicle"}
        found.append(truth_of(scenario.model_copy(update=moved), {**vehicle, **car}))
    return join_truths(found)


def arrays(job: Job, chunk: Chunk) -> tuple[Array, Times]:
    """Return (parameters, times) of every run of ``chunk`` as the compiled batch takes them."""
    scenario = Scenario(**job.scenario)
    count = len(chunk.seeds)
    base = [flatten(with_values(model.params, getattr(scenario, owner))) for owner, model in scenario.models.items()]
    starts = dict(zip(MODELS, np.cumsum([0, *map(len, base)]).tolist(), strict=False))
    parameters = np.tile(np.array([float(item) for part in base for item in part]), (count, 1))
    seeds, steps, stops = chunk.seeds.copy(), np.full(count, scenario.step), np.full(count, scenario.longest)
    every = {owner: np.full(count, scenario.decimation.get(owner, 1), dtype=np.int64) for owner in MODELS}
    controls = {item.name: place for place, item in enumerate(variables(scenario.models["controller"].params))}
    for name, values in _controller_targets(job, list(chunk.values.T)):
        parameters[:, starts["controller"] + controls[name]] = values
    is_given = scenario.stop_time is not None or "stop_time" in job.names
    for column, (owner, name, place) in enumerate(zip(job.owners, job.names, job.places, strict=True)):
        values = chunk.values[:, column]
        if owner in MODELS:
            parameters[:, starts[owner] + place] = values
        elif name == "seed":
            seeds = values.astype(np.int64)
        elif name == "step":
            steps = values
        elif name == "stop_time":
            stops = values
        elif name.startswith("decimation."):
            every[name.removeprefix("decimation.")] = values.astype(np.int64)
    for owner, _, place in job.seeded:
        parameters[:, starts[owner] + place] = seeds
    if not is_given:
        limit = controls.get(DURATION)
        durations = np.full(count, UNLIMITED) if limit is None else parameters[:, starts["controller"] + limit]
        stops = stop_times(_driver_speeds(scenario, parameters), durations)
    step_ns = np.round(steps * NS_PER_SECOND).astype(np.int64)
    stop_ns = np.round(stops * NS_PER_SECOND).astype(np.int64)
    return parameters, np.column_stack([step_ns, stop_ns, *every.values()])


def _driver_speeds(scenario: Scenario, parameters: Array) -> dict[str, Array]:
    """Return the driver's speeds of every run by name."""
    places = {item.name: place for place, item in enumerate(variables(scenario.models["vehicle"].params))}
    return {name: parameters[:, places[name]] for name in NAMES}


def chunks(design: Design, size: int) -> Iterator[Chunk]:
    """Yield a design in chunks of ``size`` runs."""
    for number, first in enumerate(range(0, len(design.seeds), size)):
        yield Chunk(number, first, design.values[first : first + size], design.seeds[first : first + size])


def job_from(data: dict[str, Any]) -> Job:
    """Return the job of this plain data, its parameters placed as the models have them now.

    ``KeyError`` for a scenario without target, as earlier versions wrote.
    """
    if "target" not in data["scenario"]:
        raise KeyError("target")
    named = _places_by_name(data["scenario"])
    fields = zip(data["owners"], data["names"], data["places"], strict=True)
    places = [named[owner][name] if owner in named else int(place) for owner, name, place in fields]
    seeded = [(owner, name, named[owner][name]) for owner, name, _ in data["seeded"]]
    measures = [_measure(*item) for item in data["measures"]]
    return Job(**{**data, "places": places, "seeded": seeded, "measures": measures})


def _places_by_name(scenario: dict[str, Any]) -> dict[str, dict[str, int]]:
    """Return model -> parameter -> its place, of the models that are ours: another version may have had others."""
    system = scenario.get("system")
    theirs = {name for name, item in system["components"].items() if item["file"]} if system else set()
    models = models_for(scenario["controller"])
    ours = {owner: model for owner, model in models.items() if owner not in theirs}
    return {owner: {item.name: at for at, item in enumerate(variables(model.params))} for owner, model in ours.items()}


def _measure(how: Any, signal: str, when: list[Any] | None) -> Measure:
    return Measure(how, signal, None if when is None else Instants(when[0], tuple(when[1])))
