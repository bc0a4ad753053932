"""From a name or a file to a complete scenario: bases, car, ``--set`` values, limits, all merged and checked."""

from collections.abc import Iterable, Mapping, Sequence
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import ValidationError

from modelkit.model import Model
from modelkit.variables import Variable, variables
from orchestrator.inputs.scenario.car import CAR, Layer, vehicle_definition, with_said
from orchestrator.inputs.scenario.files import LIBRARY, find_file, library_names
from orchestrator.inputs.scenario.flat_names import flatten_layer, flatten_section, merge_flat, merge_nested
from orchestrator.inputs.scenario.models import MODELS, models_for
from orchestrator.inputs.scenario.obstacle_map import map_of
from orchestrator.inputs.scenario.requirements import read_requirements
from orchestrator.inputs.scenario.scenario import Parameter, Scenario, Target
from orchestrator.inputs.scenario.slot_layout import KEY, expand_layouts, layout_of
from orchestrator.inputs.scenario.target_point import as_rear_axle
from orchestrator.inputs.scenario.wiring.ssp import SUFFIX, ssp_scenario, ssp_system
from orchestrator.inputs.scenario.wiring.system_text import NO_FILE, SystemText
from orchestrator.inputs.text.errors import BadInput, format_value, suggestion, suggestion_or_choices, why_no_file
from orchestrator.inputs.text.quantities import text_or_scalar, unit_symbol
from orchestrator.inputs.text.yaml_file import explain, place_in, read_mapping, read_value

NOT_WRITTEN = ("file", "overrides", "unsupported_parameters", "texts")
FIELDS = [*(name for name in Scenario.model_fields if name not in NOT_WRITTEN), "scene"]
INHERITED_NOT = ("name", "title", "description", "extends")
MAX_EXTENDED = 40
"""Files that extend each other."""
SETS = "--set"
"""Key of the uppermost layer with the words it was made from."""
NOT_MERGED = (*MODELS, "scene", "car", SETS)
"""What is laid over each other name by name."""


More = Mapping[str, Sequence[Variable]]
"""Further parameters, by owner."""


KNOWN_SLOT = "slot."
"""Begins the parameters of a controller that knows its slot."""


class _Given(NamedTuple):
    """A raw value and the file it was written in, for error messages."""

    value: object
    file: object


def scenario_names() -> list[str]:
    """Return the names of the shipped scenarios, sorted."""
    return library_names("scenarios")


def load_scenario(name: str, sets: Iterable[str] = (), more: More | None = None) -> Scenario:
    """Return the scenario called ``name`` or written in the file ``name``. Raises ``BadInput``.

    ``more`` can be set besides the parameters of the models.
    """
    path, layers, merged = _read(name, list(sets))
    more = _in_declared_units(more or {}, _in(_in(merged, "system"), "components"))
    for key in INHERITED_NOT:
        if key not in layers[-2][0] and key not in layers[-1][0]:
            merged.pop(key, None)
    merged.setdefault("name", path.stem)
    car = vehicle_definition([(content.get("car"), file) for content, file in layers], path.parent)
    merged["car"] = car.name
    merged["requirements"] = requirements_of(merged.get("requirements", ["project"]), path.parent, path)
    seed = merged.get("seed", 1)
    for owner, model in models_for(_system_request(layers)).items():
        given = _parameters(owner, model, [*car.layers(owner), *layers], seed, more.get(owner, ()))
        merged[owner] = {key: value for key, value in given.items() if not isinstance(value, str)}
        texts = {key: value for key, value in given.items() if isinstance(value, str)}
        merged |= {"texts": {**merged.get("texts", {}), owner: texts}} if texts else {}
    overrides = dict(text.split("=", 1) for text in layers[-1][0].pop(SETS))
    try:
        merged["target"] = as_rear_axle(merged.get("target"), merged["vehicle"], _source_of("target", layers, path))
        scenario = Scenario(**merged, file=str(path), overrides=overrides)
    except ValidationError as error:
        raise explain(error, _source_of(place_in(error), layers, path), Scenario, FIELDS) from None
    return _with_parameters(scenario, more).model_copy(update={"controller": _target_parameters(scenario, more)})


def load_system(name: str, sets: Iterable[str] = ()) -> SystemText | None:
    """Return the system of a scenario, before its FMUs are known; None if it is ours. Raises ``BadInput``."""
    path, _, merged = _read(name, list(sets))
    if merged.get("system") is None:
        return None
    try:
        return SystemText.model_validate(merged["system"])
    except ValidationError as error:
        raise explain(error, path, SystemText, section="system") from None


def _read(name: str, sets: list[str]) -> tuple[Path, list[Layer], dict[str, Any]]:
    """Return (file, what it, its bases and ``sets`` say, lowest first, all of that merged but for parameters)."""
    path = find_file(name, "scenarios", "scenario", Path.cwd())
    layers = _layers(path, ())
    instances = [str(instance) for content, _ in layers for instance in _in(_in(content, "system"), "components")]
    layers.append((_set_layer(sets, instances), "--set"))
    for content, file in layers:
        _check_keys([key for key in content if key != SETS], file)
    layout = layout_of(layers)
    layers = expand_layouts(layers)
    merged: dict[str, Any] = {}
    for content, _ in layers:
        merged = merge_nested(merged, {key: _as_mapping(key, content[key]) for key in content if key not in NOT_MERGED})
    return path, layers, merged if layout is None else merged | {KEY: layout}


def _in(content: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    """Return a section of what a file says, empty if it is none."""
    section = content.get(key)
    return section if isinstance(section, Mapping) else {}


def _in_declared_units(more: More, instances: Mapping[str, Any]) -> More:
    """Return parameters of which an FMU declares no unit in those that the system says of them."""
    found = {}
    for instance, items in more.items():
        units = _in(_in(instances, instance), "units")
        found[instance] = [
            item._replace(signal=item.signal._replace(unit=unit_symbol(str(units[item.name]))))
            if item.name in units and item.kind is float and item.signal.unit == "1"
            else item
            for item in items
        ]
    return found


def _with_parameters(scenario: Scenario, more: More) -> Scenario:
    """Return the scenario with the parameters of further instances by flat name, checked where the FMU is known."""
    if scenario.system is None:
        return scenario
    entries = {}
    for name, entry in scenario.system.components.items():
        known = [*(variables(MODELS[name].params) if name in MODELS else ()), *more.get(name, ())]
        given = entry.parameters
        if given and (name in MODELS or name in more):
            flat = flatten_section(given, [item.name for item in known], file=scenario.file, key=name)
            by_name = {item.name: item for item in known}
            given = {key: _value(by_name[key], _Given(value, scenario.file), name) for key, value in flat.items()}
        entries[name] = entry.model_copy(update={"parameters": given})
    return scenario.model_copy(update={"system": scenario.system.model_copy(update={"components": entries})})


def _source_of(key: str, layers: list[Layer], path: Path) -> object:
    """Return the file, or ``--set``, that determines a key of the scenario."""
    top = key.partition(".")[0].partition("[")[0]
    return next((file for content, file in reversed(layers) if top in content), path)


def _target_parameters(scenario: Scenario, more: More) -> dict[str, float | int | bool]:
    """Return the controller's parameters with target and slot: the scenario's, unless they say others."""
    own = _with_slot(scenario, more)
    if scenario.target is None:
        if any(name.startswith("target.") for name in own):
            text = (
                "the scenario has no target; write target: {x: .., y: .., heading: ..}, which the controller receives"
            )
            raise BadInput(
                f"{text}; controller.target is for telling it something else",
                file=scenario.file,
                key="controller.target",
            )
        return own
    true = {f"target.{name}": float(value) for name, value in scenario.target.model_dump().items()}
    return {**own, **{name: value for name, value in (true | map_of(scenario)).items() if name not in own}}


def _with_slot(scenario: Scenario, more: More) -> dict[str, float | int | bool]:
    """Return the controller's parameters with the slot, if it has parameters for one that nobody has set."""
    own, slot = scenario.controller, scenario.slot
    known = {item.name for item in (*variables(scenario.models["controller"].params), *more.get("controller", ()))}
    given = {} if slot is None else {f"{KNOWN_SLOT}{name}": float(value) for name, value in slot.model_dump().items()}
    return {**{name: value for name, value in given.items() if name in known}, **own} if given.keys() <= known else own


def _layers(path: Path, seen: tuple[Path, ...]) -> list[Layer]:
    """Return the file at ``path`` below it its bases, lowest first."""
    if path in seen:
        raise BadInput(
            f"inherits from itself by way of {', '.join(item.stem for item in seen)}", file=path, key="extends"
        )
    if len(seen) >= MAX_EXTENDED:
        raise BadInput(f"a chain of more than {MAX_EXTENDED} files", file=seen[0], key="extends")
    content = _resolve_files(_content_of(path), path)
    base = content.get("extends")
    if base is None:
        return [(content, path)]
    below = find_file(str(base), "scenarios", "scenario", path.parent, file=path, key="extends")
    return [*_layers(below, (*seen, path)), (content, path)]


def _content_of(path: Path) -> dict[str, Any]:
    if path.suffix == SUFFIX:
        return ssp_scenario(path)
    return deepcopy(_shipped_content(path)) if path.is_relative_to(LIBRARY) else read_mapping(path)


_shipped_content = cache(read_mapping)
"""Of a file that does not change while this process lives."""


def _resolve_files(content: dict[str, Any], path: Path) -> dict[str, Any]:
    """Return what a file says, with the FMUs of its system where they are, seen from the file."""
    system = _in(content, "system")
    if not system:
        return content
    made = dict(system)
    instances = _in(system, "components")
    if instances:
        made["components"] = {str(name): _entry_beside(item, path.parent) for name, item in instances.items()}
    if isinstance(system.get("ssp"), str):
        file = path.parent / str(system["ssp"])
        if not file.is_file():
            raise BadInput(why_no_file(file), file=path, key=f"system.ssp: {file}", at="system.ssp")
        made = merge_nested(ssp_system(file), {**made, "ssp": str(file)})
    return {**content, "system": made}


def _entry_beside(entry: object, folder: Path) -> object:
    given = {"file": NO_FILE if entry is None else entry} if entry is None or isinstance(entry, str) else entry
    if not isinstance(given, Mapping) or given.get("file", "") in ("", NO_FILE):
        return given
    return {**given, "file": str(folder / str(given["file"]))}


def _system_request(layers: list[Layer]) -> dict[str, object]:
    """Return ``controller.system`` of the topmost layer that has it."""
    sections = [content.get("controller") for content, _ in layers]
    asked = [section["system"] for section in sections if isinstance(section, Mapping) and "system" in section]
    return {"system": asked[-1]} if asked else {}


def _parameters(
    owner: str, model: Model, layers: list[Layer], seed: object, more: Sequence[Variable]
) -> dict[str, Any]:
    ours = variables(model.params)
    own = {variable.name for variable in ours}
    known = ours + [variable for variable in more if variable.name not in own]
    names = [variable.name for variable in known]
    given: dict[str, object] = {}
    for content, file in layers:
        section = content.get(owner) or {}
        if not isinstance(section, Mapping):
            raise BadInput(f"{format_value(section)}: expected a mapping of parameters", file=file, key=owner)
        if owner == "vehicle" and content.get("scene") is not None:
            section = {"scene": content["scene"], **section}
        flat, arrays = flatten_layer(section, names, file=file, key=owner)
        given = merge_flat(given, {name: _Given(value, file) for name, value in flat.items()}, arrays)
    result: dict[str, Any] = {
        variable.name: _value(variable, given[variable.name], owner) for variable in known if variable.name in given
    }
    for variable in ours:
        if f".{variable.name}".endswith(".seed") and variable.name not in result:
            result[variable.name] = seed
    return result


def _value(variable: Variable, given: object, owner: str) -> Parameter:
    assert isinstance(given, _Given)
    named = variable._replace(name=f"{owner}.{variable.name}")
    return text_or_scalar(given.value, named, file=given.file)


def requirements_of(
    given: object, folder: Path, file: object = None, key: str = "requirements"
) -> list[dict[str, Any]]:
    """Return limits with the names of sets, or of files in ``folder``, replaced by their content."""
    if not isinstance(given, list):
        raise BadInput(f"{format_value(given)}: expected a list", file=file, key=key)
    result: list[dict[str, Any]] = []
    for item in given:
        if isinstance(item, str):
            found = find_file(item, "requirements", "set of requirements", folder, file=file, key=key)
            result += [*_shipped_entries(found)] if found.is_relative_to(LIBRARY) else _entries_in(found)
        else:
            result.append(item)
    return result


def _entries_in(file: Path) -> list[dict[str, Any]]:
    return [entry.model_dump(by_alias=True, exclude_none=True) for entry in read_requirements(file)]


_shipped_entries = cache(_entries_in)
"""Of a set that does not change while this process lives; nobody changes its entries."""


def _set_layer(sets: list[str], instances: Iterable[str]) -> dict[str, Any]:
    """Return what ``--set`` says as a layer: a parameter of an instance that is neither of ours goes to the system."""
    layer: dict[str, Any] = {SETS: sets}
    others = [instance for instance in instances if instance not in MODELS]
    for text in sets:
        key, equals, value = text.partition("=")
        if not equals or not key:
            raise BadInput(f"{format_value(text)}: expected KEY=VALUE, for example car.wheelbase=2.7", file="--set")
        parsed = read_value(value, key)
        owner, dot, name = key.partition(".")
        if dot and owner in (*MODELS, "target", "slot", "scene", "decimation", KEY):
            section = layer.setdefault(owner, {})
            if not isinstance(section, dict):
                raise BadInput(f"{owner} is set as a whole and in parts", file="--set", key=key)
            section[name] = parsed
        elif key == "car" or (dot and owner == "car"):
            layer["car"] = with_said(layer.get("car"), name, parsed)
        elif dot and owner in others:
            instance = layer.setdefault("system", {}).setdefault("components", {}).setdefault(owner, {})
            instance.setdefault("parameters", {})[name] = parsed
        else:
            layer[key] = parsed
    return layer


def _check_keys(keys: Iterable[str], file: object) -> None:
    for key in keys:
        if key not in FIELDS:
            hint = suggestion(key, _parameters_called(key)) or suggestion_or_choices(key, FIELDS)
            if key.partition("[")[0] in FIELDS:
                hint = f"; set the whole list: {key.partition('[')[0]}=[...]"
            raise BadInput(f"unknown{hint}", file=file, key=key)


def _parameters_called(key: str) -> list[str]:
    """Return the parameters ``owner.name`` whose name is ``key`` or ends with ``.key``."""
    owners = {"car": CAR, **{owner: variables(model.params) for owner, model in MODELS.items()}}
    names = {f"{owner}.{item.name}" for owner, known in owners.items() for item in known}
    return sorted(name for name in names if name.endswith(f".{key}"))


def _as_mapping(key: str, value: object) -> object:
    """Return a target written as a list of x, y, heading as a mapping; anything else as it is."""
    is_list = key == "target" and isinstance(value, list) and len(value) <= len(Target.model_fields)
    return dict(zip(Target.model_fields, value, strict=False)) if is_list and isinstance(value, list) else value
