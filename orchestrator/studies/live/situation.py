"""A scenario as the page has it: what is given to the models, what is true, what ends a run and what judges it."""

import math
from typing import Any

import numpy as np

from fmus.compiled_batch import FAULTS
from orchestrator.evaluation.verdict.conditions import CONDITIONS
from orchestrator.evaluation.verdict.limit_text import requirement_text
from orchestrator.evaluation.verdict.measures import Measure
from orchestrator.evaluation.verdict.numbers import NUMBERS, OF_WHOLE_RUNS, STANDING
from orchestrator.inputs.scenario.end_condition import SPEED
from orchestrator.inputs.scenario.fault import Fault
from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.inputs.scenario.models import models_for
from orchestrator.inputs.scenario.obstacle_map import map_of
from orchestrator.inputs.scenario.requirements import Requirement
from orchestrator.inputs.scenario.scenario import MISSED, SUCCESS, Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.live.layout import layout_data
from orchestrator.studies.sweep.disturbed import fault_receivers, numbers_for
from orchestrator.studies.sweep.rows import measure_of, measures_for, measures_of
from orchestrator.studies.sweep.verdict import limit_value

FIRST = "guo2015-case4"


def why_not(scenario: Scenario) -> str:
    """Return why a scenario cannot be run on a page, empty if it can: a page has our models."""
    return "" if scenario.system is None else "its system has FMUs that the page has not"


def page_scenarios(system: str = "") -> list[Scenario]:
    """Return the shipped scenarios of one page, one with much to see first: of our models, or a controller apart."""
    names = [FIRST, *(name for name in scenario_names() if name != FIRST)]
    scenarios = [scenario for scenario in map(load_scenario, names) if not why_not(scenario)]
    models = models_for({"system": system})
    return [scenario for scenario in scenarios if scenario.models == models]


def situation(scenario: Scenario) -> dict[str, Any]:
    """Return the scenario for the page. Raises ``BadInput`` if it cannot be run there, or limits an unknown signal."""
    reason = why_not(scenario)
    if reason:
        raise BadInput(f"cannot be driven on a page: {reason}", file=scenario.name)
    measures = measures_for(scenario)
    ending = scenario.stop_condition
    return {
        **{key: getattr(scenario, key) for key in ("name", "title", "description", "task", "seed")},
        "source": scenario.file and _name_of_shipped(scenario),
        "overrides": scenario.overrides,
        "times": [
            scenario.step_ns,
            scenario.stop_ns,
            scenario.decimation.get("vehicle", 1),
            scenario.decimation.get("controller", 1),
        ],
        **{owner: getattr(scenario, owner) for owner in ("vehicle", "controller")},
        "target": scenario.target.model_dump() if scenario.target else None,
        "slot": scenario.slot.model_dump() if scenario.slot else None,
        "layout": layout_data(scenario),
        "obstacles": scenario.obstacles,
        "maps": map_of(scenario).items() <= scenario.controller.items(),
        "faults": _faults(scenario),
        "success": SUCCESS[scenario.task],
        "missed": MISSED[scenario.task],
        "ending": {
            **{"mode": ending.signal, "reason": ending.reason, "speed": SPEED, "still": ending.still},
            **{name: ending.values(getattr(ending, name)) for name in ("succeeded", "failed", "ended")},
            **{
                "standstill_ns": ending.standstill_ns,
                "final": list(ending.final()),
                "word": ending.text(ending.succeeded[0]),
            },
        },
        "measures": [_measure(item) for item in measures],
        "limits": [_limit(item, measures) for item in scenario.requirements],
    }


def _faults(scenario: Scenario) -> dict[str, Any]:
    """Return what disturbs the run: in words, which inputs of which model, and the numbers of each receiver."""
    numbers = numbers_for(scenario, np.array([scenario.seed]))[0].tolist()
    return {
        "said": [_fault_text(fault) for fault in scenario.faults],
        "when": [[fault.start, fault.stop] for fault in scenario.faults],
        "receivers": [
            [FAULTS.index(kind), model, *places]
            for kind, model, places in (x.inputs for x in fault_receivers(scenario))
        ],
        "numbers": numbers,
    }


def _fault_text(fault: Fault) -> str:
    until = f" to {fault.stop:g} s" if math.isfinite(fault.stop) else " s on"
    return f"{fault.kind} {fault.signal}, {fault.start:g}{until}"


def numbers_data() -> dict[str, dict[str, Any]]:
    """Return the numbers of a summary: unit, meaning, and what each is made from."""
    return {
        name: {
            **{"unit": item.unit, "text": item.text, "unsigned": item.unsigned, "standing": name in STANDING},
            "measure": None if item.measure is None else [item.measure.how, item.measure.signal],
        }
        for name, item in NUMBERS.items()
    }


def _name_of_shipped(scenario: Scenario) -> str:
    """Return what a scenario that is written from the page has as its base."""
    return scenario.name if scenario.file.endswith(f"scenarios/{scenario.name}.yaml") else scenario.file


def _measure(item: Measure) -> list[Any]:
    """Return how, signal, and for a part of the run the mode and its values."""
    return [item.how, item.signal, *([] if item.when is None else [item.when.signal, list(item.when.values)])]


def _limit(item: Requirement, measures: list[Measure]) -> dict[str, Any]:
    """Return a requirement; ``measure`` is the place of what decides, -1 if that takes the whole run."""
    is_number = item.signal in NUMBERS and item.signal not in OF_WHOLE_RUNS
    found = None if item.signal in NUMBERS else measure_of(item)
    first = measures_of(item)[1:] if found is not None and item.window is not None else []
    return {
        **{"id": item.id, "signal": item.signal, "condition": item.condition, "limit": limit_value(item)},
        **{"source": item.source, "required": item.required, "where": item.where, "text": requirement_text(item)},
        "sign": CONDITIONS[item.condition].sign,
        "number": is_number,
        "measure": measures.index(found) if found is not None else -1,
        "first": measures.index(first[0]) if first else -1,
        "ifNever": "fail" if item.window is None else item.window.if_never,
    }
