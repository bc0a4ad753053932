"""The text of a new scenario: a template, or the system of third-party FMUs with suggested connections."""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from modelkit.variables import Variable, variables
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.session.foreign import fmu_of
from orchestrator.simulation.cosim.fmu_instance import Ports
from orchestrator.simulation.cosim.model_description import ports_of, read_description
from orchestrator.simulation.imported.archive import check_archive
from orchestrator.simulation.system.diagnostics import SPARE
from orchestrator.simulation.system.signal_matching import Signals, Suggestion, match_signals, words

PLAIN = re.compile(r"-?[A-Za-z_][\w.()/ \[\]-]*")
"""A text that YAML takes as it is."""
REQUESTS = {
    "steering_active": "steering_wheel_request",
    "speed_control_active": "speed_request",
    "force_control_active": "force_request",
}
"""Boolean input of our vehicle -> the input that is used while it is true."""
FINAL_STATES = {
    "parked": frozenset(
        {"parked", "done", "finished", "finish", "complete", "completed", "success", "arrived", "there"}
    ),
    "failed": frozenset({"failed", "fail", "fault", "error", "abort", "aborted", "lost"}),
    "standby": frozenset({"standby", "idle", "init", "off", "ready", "wait", "waiting", "inactive", "none"}),
}
"""State of our controller -> words in the names of states that probably mean it."""
VEHICLE_ROLES = {"speed": "speed", "steering_wheel_angle": "wheel", "clearance": "clearance"}
"""Output of our vehicle -> its role."""
YAML = (".yaml", ".yml")
POSE = ("pose.x", "pose.y", "pose.heading")
UNKNOWN_STATES = "{0: standby, 1: path tracking, 2: parked}"
MAX_LISTED = 8
MARK = "# ?"


class NewScenario(NamedTuple):
    """A scenario file, and how much of it is suggested."""

    text: str
    suggestions: int
    """Lines that are to be checked."""
    open_lines: int
    """Of those, the ones that are commented out, as nothing says what is right."""
    open_signals: list[str]
    """Signals of the FMUs that nothing is suggested for."""


class _Side(NamedTuple):
    """Inputs and outputs of the vehicle or the controller."""

    inputs: Signals
    outputs: Signals
    is_third_party: bool


def scenario_of_fmus(name: str, base: str, files: Mapping[str, str], folder: Path) -> NewScenario:
    """Return a scenario in ``folder`` with third-party FMUs as vehicle, controller or both.

    ``files``: component -> .fmu, its unzipped folder, or ``model.py:MODEL``. Raises ``BadInput`` if one is no FMU.
    """
    sides = {owner: _side(owner, files.get(owner, "")) for owner in MODELS}
    lines: list[str] = []
    found: list[Suggestion] = []
    is_open: list[str] = []
    for owner, other in (("controller", "vehicle"), ("vehicle", "controller")):
        suggestions = match_signals(sides[owner].inputs, sides[other].outputs, is_unique=owner == "vehicle")
        found += suggestions
        lines += [line for item in suggestions for line in _connection(item)]
        lines += _active(owner, suggestions, sides)
        is_open += _open_inputs(sides[owner], suggestions, sides[other])
    roles = [*_controller_roles(sides["controller"], found), *_vehicle_roles(sides["vehicle"])]
    spare = _spare_outputs(sides, found, roles)
    components = ", ".join(f"{owner}: {_yaml(_relative(text, folder))}" for owner, text in files.items())
    head = [
        f"# {MARK!r} marks suggestions: check signal, unit and sign, then delete the mark.",
        f"name: {name}",
        f"extends: {_yaml(base if not base.endswith(YAML) else _relative(base, folder))}",
        "system:",
        f"  components: {{{components}}}",
    ]
    rest = [f"  # not connected: {item}" for item in is_open[:MAX_LISTED]]
    if spare:
        rest.append(f"  # no input takes {', '.join(spare[:MAX_LISTED])}{' ...' if len(spare) > MAX_LISTED else ''}")
    text = "\n".join([*head, *_section("connections", lines), *_section("roles", roles), *rest]) + "\n"
    marked = [line.strip() for line in text.splitlines()[1:] if MARK in line]
    return NewScenario(text, len(marked), sum(line.startswith("#") for line in marked), [*is_open, *spare])


def _spare_outputs(sides: Mapping[str, _Side], found: Sequence[Suggestion], roles: Sequence[str]) -> list[str]:
    """Return the outputs of the FMUs that neither an input nor a role, the verdict or the log takes."""
    taken = [item.source.lstrip("-") for item in found if item.is_sure] + " ".join(roles).split()
    return [
        f"{owner}.{name}"
        for owner, side in sides.items()
        if side.is_third_party
        for name in side.outputs.ports.names
        if not any(f"{owner}.{name}" in word for word in taken) and name not in _log_outputs(owner)
    ]


def _log_outputs(owner: str) -> set[str]:
    """Return the outputs that verdict and log read under these names and no input takes."""
    taken = {item.name for model in MODELS.values() for item in variables(model.inputs)}
    return {item.name for item in variables(MODELS[owner].outputs)} - taken


def _side(owner: str, text: str) -> _Side:
    model, other = MODELS[owner], next(model for name, model in MODELS.items() if name != owner)
    usual_inputs = frozenset(item.name for item in variables(other.inputs))
    if not text:
        own = [item for item in variables(model.inputs) if not item.name.startswith(SPARE)]
        outputs = [item for item in variables(model.outputs) if item.name in usual_inputs or owner == "vehicle"]
        return _Side(Signals(owner, Ports(own)), Signals(owner, Ports(outputs), usual_inputs), False)
    path = fmu_of(text)
    check_archive(path)
    description = read_description(path)
    ports = [ports_of(description, causality, None, path) for causality in ("input", "output")]
    return _Side(Signals(owner, ports[0]), Signals(owner, ports[1], usual_inputs), True)


def _connection(item: Suggestion) -> Iterator[str]:
    """Yield the line of a suggested connection; none where equal names and known units connect it anyway."""
    if item.is_plain:
        return
    written = _feed(item)
    notes = [f"{item.score:.0%} alike", *item.notes, *(f"or {other}" for other in item.others)]
    yield f"{'' if item.is_sure else '# '}{written}  {MARK} {'; '.join(notes)}"


def _feed(item: Suggestion) -> str:
    target = f"{_signal(item.target)}{f' [{item.target_unit}]' if item.target_unit else ''}"
    return f"{_yaml(target)}: {_yaml(_source(item))}"


def _source(item: Suggestion) -> str:
    return f"{_signal(item.source)}{f' [{item.source_unit}]' if item.source_unit else ''}"


def _active(owner: str, suggestions: Sequence[Suggestion], sides: Mapping[str, _Side]) -> Iterator[str]:
    """Yield constants for the inputs of our vehicle without which it does not follow a request that is connected."""
    if owner != "vehicle" or sides["vehicle"].is_third_party:
        return
    fed = {item.target.partition(".")[2] for item in suggestions if item.is_sure}
    needed = {name for name, request in REQUESTS.items() if request in fed}
    if "force_control_active" in needed:
        needed.add("speed_control_active")
    for name in REQUESTS:
        if name in needed - fed:
            yield f"vehicle.{name}: true  {MARK} no output of controller is like it"


def _open_inputs(side: _Side, suggestions: Sequence[Suggestion], other: _Side) -> list[str]:
    sure = {item.target for item in suggestions if item.is_sure}
    names = [f"{side.inputs.owner}.{item.name}" for item in side.inputs.variables]
    if not side.is_third_party:
        needed = {item.target.partition(".")[2] for item in suggestions} | {"steering_wheel_request"}
        names = [name for name in names if name.partition(".")[2] in needed]
    listing = "" if other.is_third_party else f" (apa list signals {other.outputs.owner}.)"
    return [name + listing for name in names if name not in sure and name.partition(".")[2] not in REQUESTS]


def _controller_roles(side: _Side, found: Sequence[Suggestion]) -> list[str]:
    """Return the roles of a third-party controller: what says its mode, and what the log shows."""
    if not side.is_third_party:
        return []
    ours = {item.name: item for item in variables(MODELS["controller"].outputs)}
    names = set(side.outputs.ports.names)
    lines = [] if "phase" in names else _mode(side.outputs)
    request = next((item for item in found if item.target == "vehicle.steering_wheel_request"), None)
    if request is not None and request.is_sure and "steering_wheel_request" not in names:
        lines.append(f"request: {_yaml(_source(request))}  {MARK}")
    for name in ("manoeuvres", "prompt"):
        if name not in names:
            wanted = Signals("controller", Ports([ours[name]]))
            lines += [
                f"{name}: {_yaml(_source(item))}  {MARK}"
                for item in match_signals(wanted, side.outputs, is_unique=True)
                if item.is_sure
            ]
    return lines


def _mode(outputs: Signals) -> list[str]:
    """Return the line of the role ``mode``, commented out where the values of the mode are not declared."""
    found = [(item, _state_map(item)) for item in outputs.variables if item.kind is not float]
    final = [(item, states) for item, states in found if "parked" in states.values()]
    final.sort(key=lambda pair: (pair[0].kind is bool, "phase" not in words(pair[0].name)))
    for item, states in final[:1]:
        pairs = ", ".join(f"{value}: {state}" for value, state in states.items())
        return [f"mode: {{from: {_yaml(_signal(f'{outputs.owner}.{item.name}'))}, map: {{{pairs}}}}}  {MARK}"]
    unnamed = [item for item, _ in found if "phase" in words(item.name) and item.kind is int]
    if not unnamed:
        return [f"# mode: {{from: {outputs.owner}.OUTPUT, map: {UNKNOWN_STATES}}}  {MARK} which output reports parked?"]
    signal = _yaml(_signal(f"{outputs.owner}.{unnamed[0].name}"))
    return [f"# mode: {{from: {signal}, map: {UNKNOWN_STATES}}}  {MARK} its FMU names no values: which means parked?"]


def _state_map(item: Variable) -> dict[int | str, str]:
    """Return value of a mode -> the state of our controller that it probably is."""
    if item.kind is bool:
        meaning = next((state for state, terms in FINAL_STATES.items() if words(item.name) & terms), "")
        return {0: "path tracking", 1: meaning} if meaning == "parked" else {}
    states = item.signal.states
    found: dict[int | str, str] = {}
    for state in states or ():
        parts = words(state.name.title().replace("_", ""))
        found[int(state)] = next((ours for ours, terms in FINAL_STATES.items() if parts & terms), "path tracking")
    return found


def _vehicle_roles(side: _Side) -> list[str]:
    """Return the roles of a third-party vehicle, of which the verdict needs pose and speed."""
    if not side.is_third_party:
        return []
    ours = {item.name: item for item in variables(MODELS["vehicle"].outputs)}
    names = set(side.outputs.ports.names)
    lines = []
    missing = [name for name in POSE if name not in names]
    if missing:
        pose = match_signals(Signals("vehicle", Ports([ours[name] for name in POSE])), side.outputs, is_unique=True)
        if [item.target.removeprefix("vehicle.") for item in pose] == list(POSE):
            parts = ", ".join(map(_source, pose))
            lines.append(f"pose: {_yaml(parts, is_list=True)}  {MARK} rear-axle midpoint, heading counter-clockwise?")
        else:
            lines.append(f"# pose: vehicle.X, vehicle.Y, vehicle.HEADING  {MARK} which outputs are the pose?")
    for name, role in VEHICLE_ROLES.items():
        if name not in names:
            wanted = Signals("vehicle", Ports([ours[name]]))
            for item in match_signals(wanted, side.outputs, is_unique=True):
                lines += [f"{role}: {_yaml(_source(item))}  {MARK}"] if item.is_sure else []
    return lines


def _section(key: str, lines: Sequence[str]) -> list[str]:
    """Return a section of the system; it is commented out if all of its lines are."""
    if not lines:
        return []
    head = f"  # {key}:" if all(line.startswith("#") for line in lines) else f"  {key}:"
    return [head, *(f"    {line}" for line in lines)]


def _signal(full: str) -> str:
    """Return a signal as a system has it: a name with a comma or a bracket stands in double quotes."""
    sign, plain = ("-", full[1:]) if full.startswith("-") else ("", full)
    owner, _, name = plain.partition(".")
    return f'{sign}{owner}."{name}"' if re.search(r",|\[(?!\d+(?:,\d+)?\])|^\s|\s$", name) else full


def _yaml(text: str, *, is_list: bool = False) -> str:
    """Return a text as YAML has it, in quotes where it needs them."""
    is_plain = PLAIN.fullmatch(text.replace(", ", "_") if is_list else text) and not text.endswith(" ")
    return text if is_plain else "'" + text.replace("'", "''") + "'"


def _relative(text: str, folder: Path) -> str:
    """Return the place of a file, or of a model ``law.py:MODEL``, seen from the scenario's folder."""
    place, colon, model = text.rpartition(":")
    has_model = bool(colon) and model.isidentifier() and not Path(text).exists()
    path = os.path.relpath(place if has_model else text, folder)
    return Path(path).as_posix() + (f":{model}" if has_model else "")
