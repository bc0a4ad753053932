"""A model driven alone by stimuli: the recording of all its inputs and outputs."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from modelkit.model import Model
from modelkit.variables import Variable, variables
from orchestrator.inputs.scenario.flat_names import flatten_section
from orchestrator.inputs.scenario.models import MODELS, models_for
from orchestrator.inputs.scenario.scenario import Parameter
from orchestrator.inputs.text.errors import BadInput, suggestion_or_choices
from orchestrator.inputs.text.quantities import text_or_scalar
from orchestrator.presentation.log.read_log import log_file, read_log
from orchestrator.session.foreign import FOREIGN, ImportedFmus, fmu_of, parameters_of
from orchestrator.session.session import NOBODY
from orchestrator.session.trust import require_trust
from orchestrator.session.user_model_instance import is_model
from orchestrator.simulation.cosim.algorithm import CoSimulation, Interrupt, Observer, last_exchange
from orchestrator.simulation.cosim.fmu_files import fmu_beside, fmu_files
from orchestrator.simulation.cosim.fmu_instance import Array, FmuInstance
from orchestrator.simulation.cosim.local_instance import LocalInstance
from orchestrator.simulation.cosim.model_description import DESCRIPTION
from orchestrator.simulation.cosim.model_instance import ModelInstance
from orchestrator.simulation.cosim.recording import Recorder, Recording
from orchestrator.simulation.system.units import UnfitUnitsError, conversion
from orchestrator.testing.steptest.step_test import StepTest
from orchestrator.testing.steptest.stimuli import StimulatedInput, stimulus

FMU, MODEL_FILE, OTHER = ".fmu", ".py", "model"
"""How files of models end; the instance's name of a model that is none of ours."""


def drive(
    test: StepTest,
    kind: str,
    foreign: ImportedFmus = NOBODY,
    model: str = "",
    observers: tuple[Observer, ...] = (),
    interrupt: Interrupt | None = None,
) -> Recording:
    """Return the recording of a test.

    ``kind``: which FMU of ours, or ``none``; ``foreign``: FMUs of others in the place of ours; ``model``: this one in
    place of the test's. Signals are named as in a run: ``controller.prompt``. Raises ``BadInput``, ``RunError``.
    """
    instance = _instance(test, model or test.model, kind, foreign)
    is_ours = (model or test.model) in MODELS and (model or test.model) not in foreign.files
    used = {"name": "vehicle", "kind": kind if is_ours else FOREIGN}
    try:
        if test.stop_ns % test.step_ns and not instance.has_variable_step:
            text = f"{test.stop_time:.9g} s is no whole number of steps of {test.step:.9g} s, which the FMU needs"
            raise BadInput(text, file=test.file, key="stop_time")
        master = CoSimulation([instance], test.step_ns, test.stop_ns)
        player = _Player(instance, _inputs(test, instance))
        master.manipulators.append(player)
        recorder = Recorder([instance], last_exchange(test.step_ns, test.stop_ns) + 1)
        master.observers += [recorder, *observers]
        master.interrupt = interrupt or Interrupt()
        player.apply(0)
        master.initialize()
        end = master.run()
        master.finish(end)
        return recorder.recording({"end": {"reason": end.reason, "t_ns": end.t_ns}, "fmus": [used]})
    finally:
        instance.close()


class _Player:
    """Manipulator that plays inputs."""

    instance = 0

    def __init__(self, instance: FmuInstance, columns: Mapping[int, Array]) -> None:
        self._instance = instance
        self._places = np.array(list(columns), dtype=np.intp)
        self._rows = np.column_stack(list(columns.values())) if columns else np.empty((0, 0))
        self._row = 0
        self._last_ns = -1

    def apply(self, t_ns: int) -> None:
        """Write the inputs of this instant."""
        if not len(self._places):
            return
        if t_ns > self._last_ns >= 0:
            self._row += 1
        self._last_ns = t_ns
        self._instance.inputs.values[self._places] = self._rows[min(self._row, len(self._rows) - 1)]


def _inputs(test: StepTest, instance: FmuInstance) -> dict[int, Array]:
    """Return place -> values at every instant of the inputs that the test says."""
    count = last_exchange(test.step_ns, test.stop_ns) + 1
    t: Array = np.minimum(np.arange(count, dtype=np.float64) * test.step_ns, test.stop_ns) / 1e9
    ports, columns = instance.inputs, {}
    if test.replay:
        columns = _replay(test, instance, t)
    given = flatten_section({}, ports.names, file=test.file, key="inputs")
    for name, value in test.inputs.items():
        if name in ports.index or not isinstance(value, Mapping):
            given[name] = value
        else:
            given |= {f"{name}.{part}": item for part, item in value.items()}
    for name, value in given.items():
        if name not in ports.index:
            hint = suggestion_or_choices(name, ports.names)
            raise BadInput(f"no such input{hint}", file=test.file, key=f"inputs.{name}")
        place = ports.index[name]
        columns[place] = stimulus(value, StimulatedInput(ports.variables[place], test.file, f"inputs.{name}"), t)
    return columns


def _replay(test: StepTest, instance: FmuInstance, t: Array) -> dict[int, Array]:
    path = log_file(str(test.near(test.replay)))
    recording = read_log(path)
    owner = _owner(recording, instance, path)
    at = np.clip(np.searchsorted(recording.t, t + 1e-9, side="right") - 1, 0, None)
    names = {place: f"{owner}.{name}" for place, name in enumerate(instance.inputs.names)}
    found = {}
    for place, name in names.items():
        if name in recording.signals:
            given, taken = recording.variables[name].signal.unit, instance.inputs.variables[place].signal.unit
            values = recording.signals[name][at]
            factor, offset = (1.0, 0.0) if given == taken else _conversion(given, taken, instance, name, path)
            found[place] = values if (factor, offset) == (1.0, 0.0) else values * factor + offset
    return found


def _conversion(given: str, taken: str, instance: FmuInstance, name: str, path: Path) -> tuple[float, float]:
    """Return (factor, offset) from the unit of a recorded signal into that of the input that it is played to."""
    if name.partition(".")[2] in instance.inputs.unsaid:
        return 1.0, 0.0
    try:
        return conversion(given, taken, {}, instance.inputs.scales)
    except UnfitUnitsError as error:
        raise BadInput(f"{name} is in {given}, the input in {taken}: {error}", file=path) from None


def _owner(recording: Recording, instance: FmuInstance, path: Path) -> str:
    """Return the instance of a log that has most of the inputs of this one."""
    owners = dict.fromkeys(name.split(".", 1)[0] for name in recording.signals)
    known = {owner: sum(f"{owner}.{name}" in recording.signals for name in instance.inputs.names) for owner in owners}
    best = max(known, key=lambda owner: known[owner], default="")
    if not best or not known[best]:
        raise BadInput(f"has none of the inputs of {instance.name}", file=path)
    return best


def _instance(test: StepTest, model: str, kind: str, foreign: ImportedFmus) -> FmuInstance:
    is_unzipped = model not in MODELS and (test.near(model) / DESCRIPTION).is_file()
    if model in foreign.files or model.endswith(FMU) or is_unzipped:
        if model not in foreign.files:
            require_trust(Path(test.file), [model])
        path = foreign.files.get(model) or fmu_of(str(test.near(model)))
        name = model if model in MODELS else OTHER
        known = parameters_of(path, name)
        ours = models_for(test.parameters).get(name)
        return foreign.make_instance(name, path, _parameters(test, known, name), lambda *said: None, ours)
    if model in MODELS:
        ours = models_for(test.parameters)[model]
        parameters = _parameters(test, variables(ours.params), model)
        if kind == "none":
            return ModelInstance(model, ours, parameters)
        file = fmu_files(kind)[model]
        file = file if ours is MODELS[model] else fmu_beside(file, ours)
        shown = {name: value for name, value in parameters.items() if ours.shows(name)}
        return LocalInstance(model, file, shown, lambda *said: None, ours)
    if MODEL_FILE in model or is_model(str(test.near(model))):
        require_trust(Path(test.file), [model])
        own = _own(str(test.near(model)))
        return ModelInstance(OTHER, own, _parameters(test, variables(own.params)))
    known_models = ", ".join(MODELS)
    raise BadInput(
        f"{model}: expected {known_models}, a file .fmu, its unzipped folder, or file.py:MODEL",
        file=test.file,
        key="model",
    )


def _own(text: str) -> Model:
    from fmus.user_model import BadModel, own_model

    try:
        return own_model(text)
    except BadModel as error:
        raise BadInput(str(error)) from error


def _parameters(test: StepTest, known: list[Variable], model: str = OTHER) -> dict[str, Parameter]:
    """Return what the test sets, above what the run had that is played."""
    named = {item.name: item for item in known}
    flat = flatten_section(test.parameters, named, file=test.file, key="parameters")
    given = {
        name: text_or_scalar(value, named[name]._replace(name=f"parameters.{name}"), file=test.file)
        for name, value in flat.items()
    }
    if not test.replay:
        return given
    had = read_log(log_file(str(test.near(test.replay)))).parameters_of(model)
    return {**{name: named[name].kind(value) for name, value in had.items() if name in named}, **given}
