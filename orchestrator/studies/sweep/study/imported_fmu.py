"""Third-party FMUs in a study: what of them can be varied and kept, and which they are."""

from collections.abc import Sequence
from pathlib import Path

from modelkit.signal import Signal
from modelkit.variables import Variable, variables
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.session.foreign import Files, ImportedFmus, parameters_of, sha256_of
from orchestrator.session.session import Messages, make_instances
from orchestrator.simulation.cosim.model_description import ports_of, read_description
from orchestrator.simulation.system.assemble import elaborate


def files_of(scenario: Scenario) -> Files:
    """Return instance -> third-party FMU in the system of ``scenario``. Raises ``BadInput``."""
    return ImportedFmus().with_system(scenario.system).files


def parameters_known(scenario: Scenario) -> dict[str, Sequence[Variable]]:
    """Return instance -> its parameters: of our models, and of the FMUs that are in their place or beside them."""
    ours = {owner: variables(model.params) for owner, model in scenario.models.items()}
    return {**ours, **{instance: parameters_of(path, instance) for instance, path in files_of(scenario).items()}}


def _own_output(scenario: Scenario, signal: str) -> Variable | None:
    owner, _, name = signal.partition(".")
    outputs = variables(scenario.models[owner].outputs) if owner in scenario.models else []
    return next((item for item in outputs if item.name == name), None)


def signals_of(scenario: Scenario) -> dict[str, Signal]:
    """Return name -> signal of all inputs and outputs of models and FMUs, and of what plays a role of theirs."""
    ours = {
        f"{owner}.{item.name}": item.signal
        for owner, model in scenario.models.items()
        for cls in (model.inputs, model.outputs)
        for item in variables(cls)
    }
    return {
        **ours,
        **{name: item for instance, path in files_of(scenario).items() for name, item in _fmu_signals(instance, path)},
    }


def declare_signals(scenario: Scenario, *signals: str) -> list[Variable | None]:
    """Return signals as system or models of ``scenario`` have them, states that an FMU or a role names included.

    None for one that it has not.
    """
    if scenario.system is None:
        return [_own_output(scenario, signal) for signal in signals]
    instances = make_instances(scenario, None, Messages())
    try:
        ports = {
            instance.name: (instance.outputs, instance.inputs) for instance in elaborate(scenario, instances).instances
        }
    finally:
        for instance in instances:
            instance.close()
    names = [(ports.get(signal.partition(".")[0], ()), signal.partition(".")[2]) for signal in signals]
    return [
        next((part.variables[part.index[name]] for part in of_instance if name in part.index), None)
        for of_instance, name in names
    ]


def hashes_of(scenario: Scenario) -> dict[str, str]:
    """Return instance -> SHA-256 of its FMU: runs with another are runs of another study."""
    return {instance: sha256_of(path) for instance, path in files_of(scenario).items()}


def _fmu_signals(instance: str, path: Path) -> list[tuple[str, Signal]]:
    description = read_description(path)
    ports = [ports_of(description, causality, MODELS.get(instance), path) for causality in ("input", "output")]
    return [(f"{instance}.{item.name}", item.signal) for part in ports for item in part.variables]
