"""What should be known of a system before it runs: inputs that nothing feeds, units not said, loops, no verdict."""

from collections.abc import Iterator, Sequence

from modelkit.variables import variables
from orchestrator.inputs.scenario.end_condition import EndCondition
from orchestrator.inputs.scenario.models import MODELS, apart_models
from orchestrator.inputs.text.errors import BadInput, suggestion
from orchestrator.simulation.cosim.fmu_instance import FmuInstance
from orchestrator.simulation.system.assemble import ElaboratedSystem
from orchestrator.simulation.system.units import scale_of

NEEDED = {
    "controller": {"manoeuvres": "limits on the number of manoeuvres are not evaluated"},
    "vehicle": {
        "pose.x": "the final position is not evaluated",
        "pose.y": "the final position is not evaluated",
        "pose.heading": "the final heading is not evaluated",
        "speed": "standstill does not end the run, and limits on speed are not evaluated",
    },
}
"""FmuInstance -> output that a verdict needs -> what is lost without it."""
NEEDED_INPUTS = {"vehicle": ("steering_wheel_request", "steering_active")}
"""Inputs without which an instance of this name cannot be driven at all."""
NOTE = "note: "
"""Begins a line that is no warning."""
SPARE = ("manual.", "external_slot.", "driver_selection.")
"""Inputs of these groups need no source: their start values mean no driver action and no external slot."""
MAX_NAMES = 12
"""A line that names more is not read."""
MAX_LETTERS = 100
"""Of a name in a line."""
Node = tuple[int, str]
"""An instance and an output of it."""


def remarks(system: ElaboratedSystem, ending: EndCondition | None, ignored: Sequence[str] = ()) -> list[str]:
    """Return one sentence for each thing that is allowed but hardly meant in a run that ends so; None: by its time."""
    instances = system.instances
    found = [
        text
        for number, instance in enumerate(instances)
        for text in (
            *_units(number, system),
            *_type_remarks(instance),
            *_open_inputs(number, system),
            *_unread_outputs(number, system),
            *_missing(instance.name, instance, ending),
        )
    ]
    names = [instance.name for instance in instances]
    absent = [text for name in MODELS if name not in names for text in _missing(name, None, ending)]
    of_ssp = [f"the .ssp has a value that is ignored: {text}" for text in ignored]
    return [*found, *absent, *loops(system), *of_ssp]


def missing_for_the_verdict(name: str, instance: FmuInstance | None, ending: EndCondition) -> dict[str, str]:
    """Return output -> what is lost as ``instance``, called ``name``, does not have it."""
    has = (
        {}
        if instance is None
        else {**instance.outputs.index, **dict.fromkeys(instance.inputs.names[instance.inputs.own :])}
    )
    owner, _, mode = ending.signal.partition(".")
    needed = dict(NEEDED.get(name, {}))
    if name == owner and mode not in has:
        needed = {
            mode: f"{_success_text(ending)} of it says that the task is done and, once the car stands, ends the run"
        } | needed
    return {item: loss for item, loss in needed.items() if item not in has}


def _success_text(ending: EndCondition) -> str:
    try:
        return ending.text(ending.succeeded[0])
    except BadInput:
        return str(ending.succeeded[0])


def _missing(name: str, instance: FmuInstance | None, ending: EndCondition | None) -> list[str]:
    if ending is None:
        return []
    who = (
        name
        if instance is not None and instance.identity
        else f"no instance is called {name}, nor plays its roles: {name}"
    )
    found = missing_for_the_verdict(name, instance, ending)
    return [f"{who} has no output {item}: {loss}" for item, loss in found.items()]


def unsaid(instance: FmuInstance) -> list[str]:
    """Return the inputs and outputs of which the FMU says no unit."""
    return [name for ports in (instance.inputs, instance.outputs) for name in ports.names if name in ports.unsaid]


def _units(number: int, system: ElaboratedSystem) -> list[str]:
    """Return what becomes of the numbers of which an FMU declares no unit: they are passed on as they are."""
    instance = system.instances[number]
    others = {name: text for name, text in _others_units(number, system).items() if name in unsaid(instance)}
    names = [name for name in unsaid(instance) if name not in others]
    found = [
        f"{instance.name} says no unit of {name}, connected with {other}: its number is taken as it is; if it is in"
        f" another unit, write {instance.name}.{name} [unit] in the connection"
        for name, other in others.items()
    ]
    return [*found, *([f"{instance.name} says no unit of {_few(names)}: taken in SI"] if names else [])]


def _others_units(number: int, system: ElaboratedSystem) -> dict[str, str]:
    """Return input or output of an instance -> the signal at its other end and its unit, if that is not one of SI."""
    found = {}
    for link in system.connections:
        source, target = system.instances[link.source], system.instances[link.target]
        for out, into in zip(link.source_places.tolist(), link.target_places.tolist(), strict=True):
            ends = (source.outputs, out, source.name), (target.inputs, into, target.name)
            own, (ports, place, owner) = ends if link.source == number else ends[::-1]
            unit, name = ports.variables[place].signal.unit, ports.names[place]
            scale = scale_of(unit, ports.scales)
            is_si = scale is None or (scale.factor, scale.offset) == (1.0, 0.0)
            if number in (link.source, link.target) and name not in ports.unsaid and not is_si:
                found[own[0].names[own[1]]] = f"{owner}.{name} [{unit}]"
    return found


def _type_remarks(instance: FmuInstance) -> list[str]:
    """Return which variables are of types that are not supported here."""
    names = [name for ports in (instance.inputs, instance.outputs, instance.parameters) for name in ports.unsupported]
    return [f"{instance.name} has variables of types that are not supported here: {_few(names)}"] if names else []


def _few(names: Sequence[str]) -> str:
    more = f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    listed = (name if len(name) <= MAX_LETTERS else f"{name[:MAX_LETTERS]}..." for name in names[:MAX_NAMES])
    return ", ".join(listed) + more


def not_fed(number: int, system: ElaboratedSystem) -> dict[str, str]:
    """Return input of one instance that nothing feeds -> which signal may be meant, ``; did you mean``, or nothing."""
    instance = system.instances[number]
    others = [other for other in system.instances if other is not instance]
    used = {(link.source, int(place)) for link in system.connections for place in link.source_places}
    spare = [
        name
        for other_number, other in enumerate(system.instances)
        if other in others
        for place, name in enumerate(other.outputs.names)
        if (other_number, place) not in used
    ]
    own = instance.inputs.names[: instance.inputs.own]
    unfed = [name for place, name in enumerate(own) if (number, place) not in system.fed and not name.startswith(SPARE)]
    return {name: suggestion(name, spare) for name in unfed}


def _open_inputs(number: int, system: ElaboratedSystem) -> list[str]:
    """Return one line on the inputs that nothing feeds; a note where all of them are optional inputs of our models."""
    instance, names = system.instances[number], not_fed(number, system)
    if not names:
        return []
    is_optional = (
        instance.name in MODELS
        and not any(names.values())
        and not set(names) & set(NEEDED_INPUTS.get(instance.name, ()))
    )
    known = {item.name for item in variables(MODELS[instance.name].inputs)} if instance.name in MODELS else set()
    kind = NOTE if is_optional and set(names) <= known else ""
    listed = _few([f"{name} ({meant.removeprefix('; ')})" if meant else name for name, meant in names.items()])
    return [f"{kind}unconnected inputs of {instance.name} (start values are used): {listed}"]


def without_consumer(number: int, system: ElaboratedSystem) -> list[str]:
    """Return the outputs of an instance that no input takes although one should: those that our models connect, and
    those that no model of ours has. Outputs that the verdict or the log reads alone are not among them.
    """
    instance = system.instances[number]
    used = {int(place) for link in system.connections if link.source == number for place in link.source_places}
    used |= set(instance.outputs.used)
    own = instance.outputs.names[: instance.outputs.own]
    names = [name for place, name in enumerate(own) if place not in used]
    if instance.name not in MODELS:
        return names
    ours = {item.name for item in variables(MODELS[instance.name].outputs)}
    if instance.name == "controller" and not set(names) <= ours:
        ours |= {item.name for model in apart_models().values() for item in variables(model.outputs)}
    taken = {item.name for other, model in MODELS.items() if other != instance.name for item in variables(model.inputs)}
    return [name for name in names if name not in ours or name in taken]


def _unread_outputs(number: int, system: ElaboratedSystem) -> list[str]:
    """Return one line on the outputs that no input takes; a note for what a vehicle measures, which few take whole.

    Nothing is said of our own models, which offer several ways to command and to sense.
    """
    instance, names = system.instances[number], without_consumer(number, system)
    ours = {item.name for item in variables(MODELS[instance.name].outputs)} if instance.name in MODELS else set()
    if not names or (ours and ours <= set(instance.outputs.names)):
        return []
    kind = NOTE if instance.name == "vehicle" and set(names) <= ours else ""
    return [f"{kind}outputs of {instance.name} that no input takes: {_few(names)}"]


def loops(system: ElaboratedSystem) -> list[str]:
    """Return a sentence for each algebraic loop: outputs that depend directly on inputs that they feed themselves."""
    ahead: dict[Node, list[Node]] = {}
    for link in system.connections:
        source, target = system.instances[link.source], system.instances[link.target]
        for out, into in zip(link.source_places.tolist(), link.target_places.tolist(), strict=True):
            taken = target.inputs.names[into]
            reached = [(link.target, name) for name, direct in target.outputs.direct.items() if taken in direct]
            ahead.setdefault((link.source, source.outputs.names[out]), []).extend(reached)
    cycles = {frozenset(cycle): cycle for start in ahead for cycle in _cycles(start, ahead)}
    return [_loop(cycle, system.instances) for cycle in cycles.values()]


def _cycles(start: Node, ahead: dict[Node, list[Node]]) -> Iterator[list[Node]]:
    """Yield the first route from an output back to itself, if there is one."""
    routes, seen = [[start]], {start}
    while routes:
        route = routes.pop()
        for following in ahead.get(route[-1], ()):
            if following == start:
                yield route
                return
            if following not in seen:
                seen.add(following)
                routes.append([*route, following])


def _loop(cycle: list[Node], instances: Sequence[FmuInstance]) -> str:
    names = [f"{instances[number].name}.{name}" for number, name in (*cycle, cycle[0])]
    return f"algebraic loop: {' -> '.join(names)}; each goes round one communication step late"
