"""A counterexample as a scenario of its own, which runs again to the same bits; a folder of them is a corpus."""

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from fmus.files import write_whole
from orchestrator.evaluation.verdict.conditions import CONDITIONS
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.yaml_file import read_mapping
from orchestrator.studies.falsification.search import Seed
from orchestrator.studies.falsification.shrink import away
from orchestrator.studies.falsification.subject import Subject
from orchestrator.studies.sweep.batch import run_batch
from orchestrator.studies.sweep.job import Chunk, chunk_scenario, make_job, truths
from orchestrator.studies.sweep.rows import why_not_compiled
from orchestrator.studies.sweep.study.design import Design
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.verdict import OUTCOMES, judge, limit_value, values_in

NOTES = "counterexamples.json"
"""What the counterexamples of a folder came to when they were written."""
BITS = ("duration", "min_clearance", "final.x", "final.y", "final.heading", "steering_travel")
"""Numbers that tell whether a run is the same to the last bit."""


class Counterexample(NamedTuple):
    """A run that breaks the requirement, and the minimal counterexample it was shrunk to."""

    name: str
    run: Seed
    chance: float
    """Share of other seeds with which the same disturbances break it."""
    drawn: Seed
    """As it was met first."""


def factors_of(subject: Subject, counterexample: Counterexample) -> dict[str, dict[str, float | str]]:
    """Return the factors of a counterexample that are not nominal: value and nominal value, and the unit."""
    found: dict[str, dict[str, float | str]] = {}
    for number in away(subject.space, counterexample.run.shares):
        factor = subject.space.factors[number]
        value = float(factor.at(np.array([counterexample.run.shares[number]]))[0])
        if factor.choices:
            words = (factor.choices[int(value)], factor.choices[int(factor.nominal)])
            found[factor.name] = {"value": words[0], "nominal": words[1], "unit": factor.unit, "text": factor.text}
        else:
            said = {"unit": factor.unit, "text": factor.text}
            found[factor.name] = {"value": value, "nominal": factor.nominal, **said}
    return found


def write_counterexample(subject: Subject, counterexample: Counterexample, folder: Path) -> Path:
    """Write a counterexample as ``folder/NAME.yaml`` and its result into ``counterexamples.json``; return the path."""
    scenario = chunk_scenario(subject.job, subject.chunk(counterexample.run.shares, counterexample.run.seed), 0)
    limits = list(subject.objective.limits) or scenario.requirements
    own = {
        "name": counterexample.name,
        "title": f"Breaks: {subject.objective.text}",
        "description": _describe(subject, counterexample),
    }
    content = scenario.with_requirements(limits).model_copy(update={**own, "source": f"hunt in {subject.study.name}"})
    path = folder / f"{counterexample.name}.yaml"
    write_whole(path, _text(content))
    notes = read_notes(folder)
    notes[counterexample.name] = {"requirement": subject.objective.name, **_numbers(path)}
    write_whole(folder / NOTES, json.dumps(notes, indent=2, sort_keys=True) + "\n")
    return path


def _text(scenario: Scenario) -> str:
    text: str = yaml.safe_dump(scenario.as_written(), sort_keys=False, allow_unicode=True)
    return text


def _describe(subject: Subject, counterexample: Counterexample) -> str:
    parts = [
        f"{name} {item['value']:.4g} {item['unit']}" if isinstance(item["value"], float) else f"{name} {item['value']}"
        for name, item in factors_of(subject, counterexample).items()
    ]
    return f"{counterexample.run.words}. Not nominal: {', '.join(parts) or 'nothing'}; seed {counterexample.run.seed}."


def read_notes(folder: Path) -> dict[str, dict[str, Any]]:
    """Return what is noted of the counterexamples of a folder. Raises ``BadInput`` if that cannot be read."""
    path = folder / NOTES
    if not path.is_file():
        return {}
    try:
        notes = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise BadInput("is damaged", file=path) from error
    if not isinstance(notes, dict) or not all(isinstance(item, dict) for item in notes.values()):
        raise BadInput("is no list of counterexamples", file=path)
    return notes


class Again(NamedTuple):
    """A counterexample of a corpus run again."""

    name: str
    breaks: bool
    same: bool
    """To the last bit as when it was found."""
    words: str


def rerun_counterexamples(folder: Path) -> list[Again]:
    """Return the counterexamples of a folder as they run now. Raises ``BadInput`` if there is none."""
    files = sorted(folder.glob("*.yaml"))
    if not files:
        raise BadInput("no scenarios in this folder", file=folder)
    return [rerun_counterexample(path) for path in files]


def rerun_counterexample(path: Path) -> Again:
    """Return a counterexample as it runs now."""
    noted, now = read_notes(path.parent).get(path.stem, {}), _numbers(path)
    same = all(noted.get(name) == now[name] for name in now)
    return Again(path.stem, bool(now["breaks"]), same, f"{now['outcome']}: {now['reason']}")


def _numbers(path: Path) -> dict[str, Any]:
    """Return what a scenario comes to in the compiled batch.

    It breaks if it misses a limit of its file; one that is not about touching anything, only if it claims to be done.
    """
    scenario = load_scenario(str(path))
    own = read_mapping(path).get("requirements") or []
    asked = {str(item.get("id")) for item in own if isinstance(item, dict)} if isinstance(own, list) else set()
    if not asked:
        raise BadInput("is not a counterexample file: it has no limits of its own", file=path)
    if why_not_compiled(scenario):
        raise BadInput(f"is not a counterexample file: {why_not_compiled(scenario)}", file=path)
    design = Design([], np.empty((1, 0)), np.array([scenario.seed], dtype=np.int64))
    job = make_job(Study(scenario, design, {"name": scenario.name}))
    chunk = Chunk(0, 0, design.values, design.seeds)
    rows = run_batch(job, chunk)
    verdict = judge(job, truths(job, chunk), rows)
    found = dict(zip(job.measures, rows[:, 2:].T, strict=False))
    outcome = OUTCOMES[verdict.outcome[0]]
    breaks = False
    for limit in scenario.requirements:
        values = values_in(limit, verdict.numbers, found)
        missed = not CONDITIONS[limit.condition].margin(values, limit_value(limit))[0] >= 0.0
        breaks |= missed and limit.id in asked and (limit.id in TOUCHING or outcome == "not_parked")
    bits = {name: float(verdict.numbers[name][0]).hex() for name in BITS}
    return {"outcome": outcome, "reason": verdict.reason[0], "breaks": bool(breaks), "bits": bits}


TOUCHING = ("contact", "no contact")
"""Limits that hold however a run ends."""
