"""What an FMU says of itself: its variables as ports, read without asking more of the file than a run needs."""

import io
import re
import zipfile
from collections import Counter
from enum import IntEnum
from functools import lru_cache
from pathlib import Path

from fmpy.model_description import ModelDescription, ModelVariable, read_model_description
from lxml import etree

from modelkit.model import Model
from modelkit.signal import Role, Signal
from modelkit.variables import Variable, variables
from orchestrator.inputs.text.errors import BadInput, excerpt, format_value, lacks_resources
from orchestrator.inputs.text.quantities import MOST_WHOLE
from orchestrator.simulation.cosim.declared import check_declared
from orchestrator.simulation.cosim.fmu_instance import Ports, Scale

WHOLE = ("Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64")
KINDS: dict[str, type] = {
    **{"Real": float, "Float64": float, "Float32": float, "Integer": int, "Enumeration": int, "Boolean": bool},
    **dict.fromkeys(WHOLE, int),
}
"""Type of an FMI variable -> the Python type it is kept as; others are not connected."""
NAMED = re.compile(r"(?:^|: )(-?\d+ \w+(?:, -?\d+ \w+)+)$")
"""How the description of a mode ends that is an integer; our own FMUs have it so."""
STRINGS = ("String",)
"""Types of FMI whose parameters are texts."""
DESCRIPTION = "modelDescription.xml"
PARAMETERS = ("parameter", "calculatedParameter")
NOT_SAID = "illegal combination of causality"
"""How FMPy refuses a variable whose variability does not fit; FMI 2.0 has all vary of which nothing is said."""
MAX_CACHED = 16
"""Descriptions of FMUs that are kept."""
BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


def read_description(path: Path) -> ModelDescription:
    """Return what the FMU says of itself. Raises ``BadInput`` if the file is no FMI 2.0 or 3.0 co-simulation FMU.

    An unchanged file is read once in a process: nobody may change what is returned.
    """
    try:
        state = path.stat()
        stamp = state.st_ino, state.st_size, state.st_mtime_ns
    except OSError:
        stamp = None
    return _read_description(path, stamp)


@lru_cache(maxsize=MAX_CACHED)
def _read_description(path: Path, _stamp: tuple[int, int, int] | None) -> ModelDescription:
    try:
        try:
            description = read_model_description(str(path), validate=False)
        except Exception as error:
            if NOT_SAID not in str(error):
                raise
            description = read_model_description(_with_fixed_parameters(path), validate=False)
    except UnicodeEncodeError as error:
        raise BadInput(
            "no FMU can be read while the name of the current folder has bytes that are not UTF-8; change to another"
        ) from error
    except IndexError as error:
        raise BadInput("its ModelStructure has an index, or a reference, of no variable", file=path) from error
    except Exception as error:
        if lacks_resources(error):
            raise
        raise BadInput(f"is not an FMU: {excerpt(error)}", file=path) from error
    names = Counter(item.name for item in description.modelVariables)
    twice = next((name for name, count in names.items() if count > 1), None)
    if twice is not None:
        raise BadInput(f"is not an FMU: it has {names[twice]} variables called {format_value(twice)}", file=path)
    version = str(description.fmiVersion)
    if not version.startswith(("2.", "3.")):
        raise BadInput(f"is FMI {excerpt(version)}; expected FMI 2.0 or 3.0", file=path)
    if description.coSimulation is None:
        other = "Model Exchange" if description.modelExchange is not None else "Scheduled Execution"
        raise BadInput(f"is an FMU for {other} only; export it for Co-Simulation", file=path)
    check_declared(description, path)
    return description


def _with_fixed_parameters(path: Path) -> io.BytesIO:
    """Return an archive with the description alone, in which parameters are fixed that are said to vary, or not said
    not to: so PythonFMU writes them by default."""
    with zipfile.ZipFile(path) as archive:
        tree = etree.fromstring(archive.read(DESCRIPTION), etree.XMLParser(resolve_entities=False))
    for item in tree.iter("ScalarVariable"):
        if item.get("causality") in PARAMETERS and item.get("variability", "continuous") == "continuous":
            item.set("variability", "fixed")
    repaired = io.BytesIO()
    with zipfile.ZipFile(repaired, "w") as archive:
        archive.writestr(DESCRIPTION, etree.tostring(tree))
    return repaired


def ports_of(description: ModelDescription, causality: str, model: Model | None, path: Path) -> Ports:
    """Return the variables of one causality; states, and units it does not say, are those of ``model``.

    With the outputs come the local variables that ``model`` has too: they are read and logged, not connected. What
    the model has is in its order. An array of FMI 3 becomes its elements: ``x[1]``, ``x[2]``, ``y[2,1]``.

    Raises ``BadInput`` if a start value has no meaning.
    """
    found, unsaid = _variables_with(description, causality, model, path)
    ports = Ports(list(found), unsaid, _scales(description))
    ports.unsupported = variables_of_other_types(description, causality)
    if causality == "output":
        ports.direct = dependencies(description)
    return ports


@lru_cache(maxsize=4 * MAX_CACHED)
def _variables_with(
    description: ModelDescription, causality: str, model: Model | None, path: Path
) -> tuple[tuple[Variable, ...], frozenset[str]]:
    """Return the variables of one causality, and the names of those whose unit is not said."""
    known = {} if model is None else _variables_of(model)
    place = {name: number for number, name in enumerate(known)}
    chosen = [
        item
        for item in description.modelVariables
        if item.type in KINDS and (item.causality == causality or (_is_seen(item, known) and causality == "output"))
    ]
    chosen.sort(key=lambda item: place.get(item.name, len(place)))
    found = tuple(element for item in chosen for element in _elements(item, known.get(item.name), path))
    unsaid = frozenset(
        name for item in chosen if KINDS[item.type] is float and _unit(item) is None for name in element_names(item)
    )
    return found, unsaid


def has_variable_step(description: ModelDescription) -> bool:
    """Return whether an FMU may be stepped by different lengths."""
    return bool(description.coSimulation.canHandleVariableCommunicationStepSize)


def text_parameters(description: ModelDescription) -> list[Variable]:
    """Return the parameters that are texts: a file's name, a choice by word. They are set, and no part of the ports."""
    return [
        Variable(name, str, Signal("1", item.description or ""), str(text or ""))
        for item in description.modelVariables
        if item.causality == "parameter" and item.type in STRINGS
        for name, text in zip(element_names(item), _texts(item), strict=True)
    ]


def _texts(scalar: ModelVariable) -> list[object]:
    """Return the start values of a text, or of the elements of an array of texts."""
    names = element_names(scalar)
    given = list(scalar.start) if isinstance(scalar.start, list | tuple) else [scalar.start]
    return [*given, *[None] * len(names)][: len(names)]


def variables_of_other_types(description: ModelDescription, *causalities: str) -> list[str]:
    """Return the variables of types that are not supported here: ``name (Binary)``, ``name (Clock)``."""
    return [
        f"{item.name} ({item.type})"
        for item in description.modelVariables
        if item.causality in causalities
        and item.type not in KINDS
        and not (item.causality == "parameter" and item.type in STRINGS)
    ]


def element_names(variable: ModelVariable) -> list[str]:
    """Return the names of the scalars that a variable stands for: its own, or one for each element of an array."""
    shape = shape_of(variable)
    if not shape:
        return [variable.name]
    names = [""]
    for size in shape:
        names = [f"{name},{index + 1}" if name else str(index + 1) for name in names for index in range(size)]
    return [f"{variable.name}[{name}]" for name in names]


def shape_of(variable: ModelVariable) -> tuple[int, ...]:
    """Return the sizes of an array of FMI 3 as they are at the start; empty for a scalar."""
    sizes = []
    for dimension in variable.dimensions or ():
        written = dimension.start if dimension.start is not None else getattr(dimension.variable, "start", None)
        sizes.append(int(str(written or 1)))
    return tuple(sizes)


def dependencies(description: ModelDescription) -> dict[str, set[str]]:
    """Return output -> inputs on which it depends directly, for the outputs that declare them."""
    inputs = {item.name for item in description.modelVariables if item.causality == "input"}
    return {
        item.variable.name: {other.name for other in item.dependencies} & inputs
        for item in description.outputs
        if item.variable is not None and item.dependencies is not None
    }


def _is_seen(scalar: ModelVariable, known: dict[str, Variable]) -> bool:
    return scalar.causality == "local" and scalar.name in known


def _variables_of(model: Model) -> dict[str, Variable]:
    groups = (variables(model.inputs), variables(model.outputs), variables(model.params))
    return {variable.name: variable for group in groups for variable in group}


def _elements(scalar: ModelVariable, known: Variable | None, path: Path) -> list[Variable]:
    names = element_names(scalar)
    texts = str(scalar.start if scalar.start is not None else "0").split() if shape_of(scalar) else [scalar.start]
    texts = texts * len(names) if len(texts) == 1 else texts
    texts += [None] * (len(names) - len(texts))
    return [_variable(scalar, name, text, known, path) for name, text in zip(names, texts, strict=False)]


def _variable(scalar: ModelVariable, name: str, written: object, known: Variable | None, path: Path) -> Variable:
    kind = KINDS[str(scalar.type)]
    text = str(written if written is not None else "0")
    try:
        start = kind(float({"true": "1", "false": "0"}.get(text.lower(), text)))
    except (ValueError, OverflowError):
        raise BadInput(f"{format_value(text)} is no start value of type {scalar.type}", file=path, key=name) from None
    if kind is int and not -MOST_WHOLE <= start < MOST_WHOLE:
        raise BadInput(f"start value {format_value(text)} is beyond 32-bit integers", file=path, key=name)
    unit = _unit(scalar) or ("1" if known is None else known.signal.unit)
    states = _states(scalar, known if known is not None and known.kind is kind else None)
    roles = frozenset({Role.LOCAL} if scalar.causality == "local" else ())
    return Variable(name, kind, Signal(unit, scalar.description or "", states=states), start, roles)


def _states(scalar: ModelVariable, known: Variable | None) -> type[IntEnum] | None:
    """Return the names of a mode's values: those of the FMU, unless our model has the same, or the FMU has none."""
    items, ours = _items(scalar), None if known is None else known.signal.states
    if items is None or (ours is not None and _members(items) == _members(ours)):
        return ours
    return items


def _members(states: type[IntEnum]) -> dict[str, int]:
    return {state.name: int(state) for state in states}


def _items(scalar: ModelVariable) -> type[IntEnum] | None:
    """Return the names of the values of an enumeration, or of an integer whose description ends ``0 OFF, 1 ON``."""
    kind, described = scalar.declaredType, NAMED.search(scalar.description or "")
    if KINDS[str(scalar.type)] is not int:
        return None
    pairs = [(str(item.name), item.value or place) for place, item in enumerate(kind.items if kind else (), start=1)]
    if not pairs and described is not None:
        pairs = [(name, value) for value, name in (part.split() for part in described[1].split(","))]
    members = {re.sub(r"[^A-Za-z0-9_]", "_", name).upper(): int(str(value)) for name, value in pairs}
    if not members or len(members) < len(pairs) or not all(name.isidentifier() for name in members):
        return None
    return states_called(re.sub(r"[^A-Za-z0-9_]", "_", str(kind.name if kind else scalar.name).title()), members)


def states_called(name: str, members: dict[str, int]) -> type[IntEnum]:
    """Return an enumeration made at run time, of name -> value."""
    return IntEnum(name, members)  # type: ignore[return-value]


def _scales(description: ModelDescription) -> dict[str, Scale]:
    found = {}
    for item in description.unitDefinitions:
        base = item.baseUnit
        if base is not None:
            exponents = tuple(int(getattr(base, name) or 0) for name in BASE)
            found[str(item.name)] = Scale(float(base.factor), float(base.offset), exponents)
    return found


def _unit(scalar: ModelVariable) -> str | None:
    """Return the unit that an FMU declares of a variable, ``1`` for a dash; None if it declares none."""
    unit = scalar.unit or (scalar.declaredType.unit if scalar.declaredType is not None else None) or None
    return "1" if unit is not None and unit.strip() == "-" else unit
