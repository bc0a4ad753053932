"""What a car that parks may plausibly be given: beyond it a number is allowed, but said.

Each parameter has a hard range, outside which it is refused (``Signal.low``, ``Signal.high``). Beside that stands what
is plausible: by its unit, widened where the default itself is large.
"""

import math
from collections.abc import Iterator, Mapping

from modelkit.variables import Variable, variables
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.obstacle_map import items_of, static_obstacles
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput, format_value
from orchestrator.inputs.text.quantities import number

LARGEST: Mapping[str, float] = {
    "m": 10e3,
    "rad": 100.0,
    "s": 36e3,
    "m/s": 60.0,
    "rad/s": 100.0,
    "m/s2": 100.0,
    "kg": 60e3,
    "N": 200e3,
}
"""Unit -> the largest size that anything here plausibly has."""
GAP_TOLERANCE = 0.05
"""Obstacles that reach farther into the slot [m] contradict it."""
MAX_EXTRA_GAP = 1.0
"""A gap longer than the slot by more [m] contradicts it: cars in marked bays leave half a metre on each side."""
MAX_GAP_RATIO = 2.0
"""Obstacles farther apart than this many slot lengths do not bound the slot."""
FULL_TURN = 2.0 * math.pi
"""A heading beyond one turn [rad] is more likely one in degrees."""
HEADINGS = ("heading", "yaw")
"""Parameters that are the direction of something."""
UNITS = {"x": "m", "y": "m", "length": "m", "width": "m", "heading": "rad"}
"""Of the numbers of target and slot."""


def plausible(variable: Variable) -> tuple[float, float]:
    """Return the plausible range of a parameter, in SI: within its hard one."""
    low, high = variable.signal.low, variable.signal.high
    most = LARGEST.get(variable.signal.unit, math.inf)
    if variable.kind is float and most < math.inf:
        most = max(most, 10.0 * abs(variable.start))
    return max(low, -most), min(high, most)


def implausible(scenario: Scenario) -> list[str]:
    """Return a sentence for each number of a scenario that is allowed but hardly meant."""
    checks = (_parameters, _places, _sizes, _gaps, _faults)
    return [sentence for check in checks for sentence in check(scenario)]


def is_implausible(value: float, variable: Variable) -> str:
    """Return what is said of a parameter's value, empty if it is plausible."""
    low, high = plausible(variable)
    if low <= value <= high or value == variable.start:
        return ""
    return _sentence(variable.name, value, low, high, variable.signal.unit)


def _parameters(scenario: Scenario) -> Iterator[str]:
    for owner, model in MODELS.items():
        given = getattr(scenario, owner)
        for variable in variables(model.params):
            if variable.name in given:
                value = float(given[variable.name])
                text = is_implausible(value, variable)
                if variable.name.rpartition(".")[2] in HEADINGS and abs(value) > FULL_TURN and value != variable.start:
                    text = _heading_sentence(variable.name, value)
                if text:
                    yield f"{owner}.{text}"


def _places(scenario: Scenario) -> Iterator[str]:
    for name in ("target", "slot"):
        part = getattr(scenario, name)
        for key, value in (part.model_dump() if part is not None else {}).items():
            unit = UNITS.get(key, "")
            if key == "heading" and abs(value) > FULL_TURN:
                yield _heading_sentence(f"{name}.{key}", value)
            elif unit and abs(value) > LARGEST[unit]:
                yield _sentence(f"{name}.{key}", value, -LARGEST[unit], LARGEST[unit], unit)


def _sizes(scenario: Scenario) -> Iterator[str]:
    """Yield which parts of the scene lack the size without which they do not exist."""
    for array, size in {"scene.boxes": "length", "scene.kerbs": "height"}.items():
        for place, fields in items_of(scenario.vehicle, array).items():
            if size not in fields:
                yield f"{array}[{place}] has no {size} and is therefore not in the scene"


def _gaps(scenario: Scenario) -> Iterator[str]:
    """Yield how the slot contradicts what stands on both sides of it."""
    slot = scenario.slot
    if slot is None:
        return
    for name, size, free in zip(("length", "width"), (slot.length, slot.width), free_extents(scenario), strict=True):
        if not -GAP_TOLERANCE <= free - size <= MAX_EXTRA_GAP and free < MAX_GAP_RATIO * size:
            yield (
                f"slot.{name} = {size:g} m, but {free:.2f} m lie between the obstacles on both sides of the slot; "
                "slot_layout moves slot, target, neighbours and kerb together"
            )


def free_extents(scenario: Scenario) -> tuple[float, float]:
    """Return the free distance through the middle of the slot, along its length and across it [m].

    Between static obstacles (boxes and polygons) on both sides; infinite where one side is free.
    """
    slot = scenario.slot
    assert slot is not None
    c, s = math.cos(slot.heading), math.sin(slot.heading)
    extents = []
    for across, half in ((0, 0.5 * slot.width), (1, 0.5 * slot.length)):
        ahead, behind = math.inf, math.inf
        for points in static_obstacles(scenario):
            local = [((x - slot.x) * c + (y - slot.y) * s, (y - slot.y) * c - (x - slot.x) * s) for x, y in points]
            along, aside = ([point[across] for point in local], [point[1 - across] for point in local])
            if min(aside) < 0.5 * half and max(aside) > -0.5 * half:
                ahead = min(ahead, min(along)) if min(along) > 0.0 else ahead
                behind = min(behind, -max(along)) if max(along) < 0.0 else behind
        extents.append(ahead + behind)
    return extents[0], extents[1]


def _faults(scenario: Scenario) -> Iterator[str]:
    for place, fault in enumerate(scenario.faults, start=1):
        unit = _unit_of(fault.signal)
        for key in ("value", "sigma"):
            given = getattr(fault, key)
            try:
                size = abs(number(given, unit, any_value=True)) if given is not None else 0.0
            except BadInput:
                continue
            if math.isfinite(size) and size > LARGEST.get(unit, math.inf):
                fault_value = f"faults[{place}].{key} = {format_value(given)}"
                yield f"{fault_value} is beyond what is plausible for a signal in {unit}"


def _unit_of(signal: str) -> str:
    owner, _, name = signal.partition(".")
    if owner not in MODELS:
        return "1"
    known = [*variables(MODELS[owner].outputs), *variables(MODELS[owner].inputs)]
    return next((item.signal.unit for item in known if item.name.startswith(name)), "1")


def _heading_sentence(name: str, value: float) -> str:
    return f"{name} = {value:g} rad is more than one turn; write '{value:g} deg' if degrees are meant"


def _sentence(name: str, value: float, low: float, high: float, unit: str) -> str:
    return f"{name} = {value:g} {unit} is beyond what is plausible, {low:g} to {high:g} {unit}"
