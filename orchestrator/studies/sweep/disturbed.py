"""Faults as the compiled batch takes them: which inputs they disturb, and their numbers in each run of a study."""

import json
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fmus.compiled_batch import FAULT_NUMBERS, FaultInputs
from modelkit.variables import Variable
from orchestrator.inputs.scenario.fault import Fault
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.quantities import NS_PER_SECOND, number, scalar
from orchestrator.session.session import Messages, make_instances
from orchestrator.simulation.cosim.algorithm import CoSimulation
from orchestrator.simulation.cosim.faults import SEED_STRIDE, receivers
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.system.assemble import elaborate
from orchestrator.studies.sweep.job import Chunk, Job

SYSTEM = "system"
"""The controller's parameter that says which model it is, and so which inputs there are."""
NEVER_NS = float(1 << 62)
NEVER_TIME = 1e9
"""A stop later than this [s] never comes."""


class Receiver(NamedTuple):
    """One receiver of one fault."""

    fault: int
    """Its number, from 0."""
    inputs: FaultInputs
    first: Variable
    """The first of them, by which its numbers are read."""


def fault_receivers(scenario: Scenario) -> tuple[Receiver, ...]:
    """Return who hears the faults of ``scenario``, in the order in which they act. Raises ``BadInput``."""
    if not scenario.faults:
        return ()
    faults = [item.model_dump(mode="json") for item in scenario.faults]
    chosen = {key: value for key, value in scenario.controller.items() if key == SYSTEM}
    return _receivers(json.dumps(faults), tuple(chosen.items()), scenario.file)


@lru_cache
def _receivers(faults: str, chosen: tuple[tuple[str, Any], ...], file: str) -> tuple[Receiver, ...]:
    given = [Fault(**item) for item in json.loads(faults)]
    scenario = Scenario(name="faults", faults=given, file=file, controller=dict(chosen))
    system = elaborate(scenario, instances := make_instances(scenario, None, Messages()))
    master = CoSimulation(system.instances, 1, 1, {}, system.connections)
    return tuple(
        Receiver(
            count,
            FaultInputs(given[count].kind, instance, tuple(places)),
            instances[instance].inputs.variables[places[0]],
        )
        for count, instance, places in receivers(given, master, file)
    )


def fault_numbers(job: Job, chunk: Chunk, scenario: Scenario) -> Array:
    """Return the numbers of all receivers of all faults in each run of ``chunk``: see ``FAULT_NUMBERS``."""
    varied = {(place, name): chunk.values[:, column] for column, (place, name) in _columns(job)}
    return numbers_for(scenario, chunk.seeds, varied)


def numbers_for(
    scenario: Scenario, seeds: NDArray[Any], varied: Mapping[tuple[int, str], Array] | None = None
) -> Array:
    """Return a line for each run: ``FAULT_NUMBERS`` of each receiver of the faults of ``scenario``.

    ``seeds``: of the runs; ``varied``: fault and key -> its values in the runs.
    """
    hearers, varied = fault_receivers(scenario), varied or {}
    found = np.empty((len(seeds), len(hearers), FAULT_NUMBERS))
    for count, item in enumerate(hearers):
        fault = scenario.faults[item.fault]
        start, stop = (varied.get((item.fault, name), getattr(fault, name)) for name in ("start", "stop"))
        found[:, count, 0] = np.round(np.asarray(start) * NS_PER_SECOND)
        found[:, count, 1] = np.where(
            np.asarray(stop) > NEVER_TIME, NEVER_NS, np.round(np.asarray(stop) * NS_PER_SECOND)
        )
        name = AMOUNT[fault.kind]
        amount = varied.get((item.fault, name), _amount(fault, item.first)) if name else 0.0
        found[:, count, 2] = np.round(np.asarray(amount) * NS_PER_SECOND) if fault.kind == "delay" else amount
        found[:, count, 3] = seeds * SEED_STRIDE + count
    return np.ascontiguousarray(found.reshape(len(seeds), -1))


AMOUNT = {"override": "value", "stuck_at_last": "", "dropout": "probability", "delay": "delay", "noise": "sigma"}
"""Kind -> the number that it needs."""


def _columns(job: Job) -> list[tuple[int, tuple[int, str]]]:
    owners = enumerate(zip(job.owners, job.names, job.places, strict=True))
    return [(column, (place, name)) for column, (owner, name, place) in owners if owner == "faults"]


def _amount(fault: Fault, first: Variable) -> float:
    if fault.kind == "override":
        if first.kind is not float:
            return float(scalar(fault.value, first))
        return number(fault.value, first.signal.unit, any_value=True)
    if fault.kind == "noise":
        return number(fault.sigma, first.signal.unit)
    return float(getattr(fault, AMOUNT[fault.kind] or "start"))
