"""What is result: a requirement whose margin says how far a run is from breaking it."""

from collections.abc import Sequence

import numpy as np

from orchestrator.evaluation.verdict.numbers import NUMBERS
from orchestrator.inputs.scenario.requirements import REQUIREMENT_SETS, Requirement, library_requirements
from orchestrator.inputs.text.errors import BadInput, suggestion_or_choices
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.rows import measure_of
from orchestrator.studies.sweep.study.study import Objective, Study

CONTACT = Requirement(id="contact", signal="vehicle.clearance", min=1e-9, source="nothing is touched")


def objective_of(study: Study, name: str | None) -> Objective:
    """Return what ``name`` means: an objective of the study, a requirement of its scenario, or a shipped one or set.

    No name: the study's first objective, or contact. Raises ``BadInput``.
    """
    own = {objective.name: objective for objective in study.goals}
    if name is None:
        return study.goals[0] if study.goals else _limits("contact", [CONTACT])
    if name in own:
        return own[name]
    known: dict[str, Sequence[Requirement]] = {"contact": [CONTACT]}
    for path in sorted(REQUIREMENT_SETS.glob("*.yaml")):
        items = library_requirements(path.stem)
        known |= {path.stem: items} | {f"{path.stem}: {item.id}": [item] for item in items}
    known |= {f"within {key}": items for key, items in study.within.items()}
    known |= {item.id: [item] for item in study.scenario.requirements}
    if name not in known:
        hint = suggestion_or_choices(name, [*own, *known])
        raise BadInput(f"no requirement of this name{hint}", key=f"--requirement: {name}")
    return _limits(name, known[name])


def _limits(name: str, limits: Sequence[Requirement]) -> Objective:
    for limit in limits:
        if limit.signal not in NUMBERS and measure_of(limit) is None:
            raise BadInput(
                "takes the whole run; a search needs a limit without such a window", key=f"limit: {limit.id}"
            )
    return Objective(name, ", ".join(item.id for item in limits), limits)


def smallest(margins: Sequence[Array]) -> Array:
    """Return the least of several margins of each run; what was not measured is met by nothing."""
    return np.asarray(np.nan_to_num(np.min(np.array(margins), axis=0), nan=-1.0))
