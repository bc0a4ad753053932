"""A scenario as a system for other tools: what can be written for them, and what cannot."""

from collections.abc import Iterable
from pathlib import Path

from fmus.contents.variables import visible_variables
from fmus.systems.parking import of_one_system, parking_system
from fmus.systems.system import FmuPart, FmuSystem
from modelkit.model import Model
from orchestrator.inputs.scenario.models import MODELS, models_for
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.patterns import matching


def parts_of(scenario: Scenario) -> dict[str, Model]:
    """Return vehicle and controller, which start with the parameters of ``scenario``.

    Raises ``BadInput`` if the scenario has what no such file can say: decimation or faults.
    """
    if any(every != 1 for every in scenario.decimation.values()):
        raise BadInput(
            "a system file has one communication step for all; leave out", file=scenario.file, key="decimation"
        )
    if scenario.system is not None:
        raise BadInput("exports are of our vehicle and controller; leave out", file=scenario.file, key="system")
    if scenario.faults:
        raise BadInput("faults live in apa's own master; leave them out to export", file=scenario.file, key="faults")
    given = {name: scenario.parameters_for(name) for name in MODELS}
    models = models_for(scenario.controller)
    return {name: of_one_system(model, given[name]).with_start_values(given[name]) for name, model in models.items()}


def system_of(scenario: Scenario, folder: Path, kind: str, platforms: Iterable[str] = ()) -> FmuSystem:
    """Return the system of ``scenario`` with FMUs of ``kind``, built into ``folder``. Raises as :func:`parts_of`."""
    from orchestrator.simulation.cosim.fmu_files import build_into

    models = parts_of(scenario)
    built = {item.name: item.path for item in build_into(folder, kind, platforms, models=models.values())}
    parts = tuple(FmuPart(name, model, built[model.name]) for name, model in models.items())
    return FmuSystem(scenario.name, scenario.title, parts, scenario.step, scenario.longest)


def one_model(
    scenario: Scenario,
    parameters: Iterable[str] | None = None,
    inputs: Iterable[str] = (),
    outputs: Iterable[str] | None = None,
) -> Model:
    """Return the system of ``scenario`` as one model. Raises as :func:`parts_of`, or for a pattern that fits nothing.

    Of parameters and outputs those are shown that fit a pattern, by default all. The inputs that fit one are left to
    others, beside those that no part feeds.
    """
    parts = parts_of(scenario)
    inside = [(name, item) for name, part in parts.items() for item in visible_variables(part)]
    known = [f"{name}.{item.name}" for name, item in inside if item.causality == "input"]
    opened = matching(known, inputs)
    model = parking_system(scenario.name, scenario.title or scenario.name, parts, scenario.step_ns, opened)
    shown = visible_variables(model)
    hidden = set(model.view.hidden)
    for causality, patterns in (("parameter", parameters), ("output", outputs)):
        names = [item.name for item in shown if item.causality == causality]
        hidden |= {*names} - {*matching(names, patterns)}
    view = model.view._replace(hidden=frozenset(hidden))
    return model._replace(stop_time=scenario.longest, view=view)
