"""Suggested connections for a third-party FMU: signals alike in name, description, unit and type, best first."""

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

from modelkit.variables import Variable
from orchestrator.simulation.cosim.fmu_instance import Ports
from orchestrator.simulation.system.units import scale_of

PART = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
"""A part of a name: ``StrWhlAng_deg2`` has Str, Whl, Ang, deg, 2."""
UNIT_IN_TEXT = re.compile(r"[\[(](deg|rad|m/s|km/h|kph|mph|cm|mm|m|deg/s|rad/s)[\])]")
UNIT_SUFFIX = re.compile(r"_(deg|rad|mps|kmh|kph|mph|cm|mm|m)$", re.IGNORECASE)
MIRRORED = re.compile(
    r"(?<!counter-)(?<!counter)(?<!anti-)\bclockwise|right (?:is )?positive|positive (?:to the )?right|\bsouth|\bwest",
    re.I,
)
"""How a description says that a signal counts the other way round than ISO 8855."""
FIELD_TERMS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("str", "strg", "steer", "stw"), ("steering",)),
    **dict.fromkeys(("swa", "sas"), ("steering", "wheel", "angle")),
    **dict.fromkeys(("sw", "handwheel"), ("steering", "wheel")),
    **dict.fromkeys(("delta", "rwa"), ("front", "wheel", "angle")),
    **dict.fromkeys(("whl",), ("wheel",)),
    **dict.fromkeys(("ang",), ("angle",)),
    **dict.fromkeys(("spd", "vel", "velocity", "v"), ("speed",)),
    **dict.fromkeys(("vx",), ("speed",)),
    **dict.fromkeys(
        ("req", "cmd", "command", "commanded", "demand", "dmd", "des", "desired", "setpoint"), ("request",)
    ),
    **dict.fromkeys(("requested", "wanted", "set", "asked"), ("request",)),
    **dict.fromkeys(("yaw", "psi", "theta", "hdg", "course", "azimuth"), ("heading",)),
    **dict.fromkeys(("meas", "act", "actual"), ("measured",)),
    **dict.fromkeys(("position", "pos"), ("pose",)),
    **dict.fromkeys(("east", "easting", "west", "westing"), ("x",)),
    **dict.fromkeys(("north", "northing", "south", "southing"), ("y",)),
    **dict.fromkeys(("dist", "travel", "mileage"), ("distance",)),
    **dict.fromkeys(("uss", "sonar", "ultrasound", "pdc"), ("ultrasonic",)),
    **dict.fromkeys(("brk", "braking"), ("brake",)),
    **dict.fromkeys(("frc",), ("force",)),
    **dict.fromkeys(("en", "enable", "enabled", "activate", "engaged", "on"), ("active",)),
    **dict.fromkeys(("moves", "maneuvers", "shifts", "strokes", "maneuver", "manoeuvre"), ("manoeuvres",)),
    **dict.fromkeys(("state", "mode", "status", "stage"), ("phase",)),
    **dict.fromkeys(("hmi", "hint", "instruction"), ("prompt",)),
    **dict.fromkeys(("confirmation", "ok"), ("confirm",)),
}
"""Part of a name as others write it -> the words of our signals."""
FILLER = frozenset(
    (
        *("a", "an", "and", "as", "at", "by", "for", "from", "in", "is", "it", "its", "of", "off", "or", "out", "the"),
        *("to", "with", "vehicle", "veh", "car", "ego", "host", "controller", "input", "output", "signal", "sig"),
        *("value", "val", "u", "deg", "rad", "mps", "kmh", "kph", "mph", "counter", "clockwise", "counterclockwise"),
        *("left", "right", "positive", "negative", "axis"),
    )
)
"""Parts of names and descriptions that say nothing of the quantity."""
OTHER_QUANTITY = frozenset(
    ("brake", "error", "rate", "acceleration", "jerk", "curvature", "torque", "limit", "max", "min")
)
"""Words that make another quantity of a name: the error of a heading is no heading."""
OTHER_QUANTITY_FACTOR = 0.7
"""On the likeness of two names of which one alone has such a word."""
MIN_SCORE, SURE_SCORE = 0.45, 0.6
"""Signals less alike are not suggested; signals at least so alike are connected."""
MAX_OTHERS = 2
"""Further signals that a suggestion names."""
REQUEST = "request"
"""Every input of a vehicle is one, whatever its name."""
NAME_SHARE = 0.7
"""Weight of the names against that of the descriptions."""
USUAL_BONUS = 0.05
"""Of a signal that our own model takes too, over one of the same likeness."""


class Signals(NamedTuple):
    """The inputs or the outputs of one component."""

    owner: str
    ports: Ports
    usual: frozenset[str] = frozenset()
    """Names that our own model of the other side takes."""

    @property
    def variables(self) -> Sequence[Variable]:
        """Return the variables of the component itself, without those that stand for roles."""
        return self.ports.variables[: self.ports.own]


class Suggestion(NamedTuple):
    """An input and the output that probably feeds it."""

    target: str
    """Input, with its component."""
    source: str
    """Output, with its component; ``-`` before it where descriptions count in opposite directions."""
    score: float
    """0 to 1."""
    others: tuple[str, ...]
    """Further outputs that are alike, best first."""
    notes: tuple[str, ...]
    """What to check besides."""
    target_unit: str = ""
    """Unit to write beside the input, of which the FMU declares none."""
    source_unit: str = ""
    """Unit to write beside the output, of which the FMU declares none."""
    is_plain: bool = False
    """Whether equal names connect the two anyway: same type, same declared unit."""

    @property
    def is_sure(self) -> bool:
        """Return whether it is alike enough to be connected."""
        return self.score >= SURE_SCORE


MAX_PAIRS = 200_000
"""Pairs of an input and an output that are compared; of an FMU with more outputs the first ones, and equal names."""


def match_signals(targets: Signals, sources: Signals, *, is_unique: bool) -> list[Suggestion]:
    """Return a suggestion for each input that has one, in the order of the inputs.

    ``is_unique``: an output feeds one input at most, the one that is most alike.
    """
    compared = MAX_PAIRS // max(1, len(targets.variables))
    places = {source.name: place for place, source in enumerate(sources.variables)}
    scored = [
        (likeness(target, targets, sources.variables[place], sources), number, place)
        for number, target in enumerate(targets.variables)
        for place in _places_to_compare(target.name, places, min(compared, len(sources.variables)))
    ]
    ranked = sorted((item for item in scored if item[0] >= MIN_SCORE), key=lambda item: (-item[0], *item[1:]))
    chosen: dict[int, tuple[float, int]] = {}
    for score, number, place in ranked:
        is_taken = is_unique and any(place == other for _, other in chosen.values())
        if number not in chosen and not is_taken:
            chosen[number] = (score, place)
    return [
        _suggestion(targets, number, sources, *chosen[number], [item[2] for item in ranked if item[1] == number])
        for number in sorted(chosen)
    ]


def _places_to_compare(name: str, places: Mapping[str, int], first: int) -> list[int]:
    """Return the places of the first signals, and that of the signal of this name."""
    own = places.get(name, -1)
    return [*range(first), *([own] if own >= first else [])]


def likeness(target: Variable, targets: Signals, source: Variable, sources: Signals) -> float:
    """Return how alike two signals are, 0 to 1; 0 if unit or type do not fit."""
    if not _units_fit(target, targets.ports, source, sources.ports):
        return 0.0
    if target.name == source.name:
        return 1.0
    if target.kind is not source.kind:
        return 0.0
    implied = frozenset() if REQUEST in words(target.name) & words(source.name) else frozenset({REQUEST})
    names = _share(words(target.name) - implied, words(source.name) - implied)
    texts = _share(_all_words(target) - implied, _all_words(source) - implied)
    score = max(names, NAME_SHARE * names + (1.0 - NAME_SHARE) * texts, 0.9 * texts)
    if (words(target.name) ^ words(source.name)) & OTHER_QUANTITY:
        score *= OTHER_QUANTITY_FACTOR
    return min(score + (USUAL_BONUS if source.name in sources.usual or target.name in targets.usual else 0.0), 0.99)


@lru_cache(maxsize=1 << 14)
def words(name: str) -> frozenset[str]:
    """Return the field terms of a name: ``StrWhlAngReq`` has steering, wheel, angle, request."""
    parts = [part.lower() for part in PART.findall(name)]
    found = [term for part in parts for term in FIELD_TERMS.get(part, (part,))]
    return frozenset(found) - FILLER


def unit_of(variable: Variable, ports: Ports) -> str:
    """Return the unit of a variable: its FMU's, else what its name or its description ends with; empty: not known."""
    if variable.kind is not float:
        return "1"
    if variable.name not in ports.unsaid:
        return variable.signal.unit
    in_text = UNIT_IN_TEXT.search(variable.signal.text) or UNIT_SUFFIX.search(variable.name)
    return "" if in_text is None else {"mps": "m/s", "kmh": "km/h", "kph": "km/h"}.get(in_text[1].lower(), in_text[1])


def _units_fit(target: Variable, targets: Ports, source: Variable, sources: Ports) -> bool:
    wanted, given = unit_of(target, targets), unit_of(source, sources)
    if not wanted or not given or (target.kind is not float and source.kind is not float):
        return True
    first, second = scale_of(wanted, targets.scales), scale_of(given, sources.scales)
    return first is not None and second is not None and first.exponents == second.exponents


def _all_words(variable: Variable) -> frozenset[str]:
    return words(variable.name) | words(variable.signal.text.partition(":")[0])


def _share(first: frozenset[str], second: frozenset[str]) -> float:
    """Return the share of common words (Dice coefficient)."""
    return 2.0 * len(first & second) / (len(first) + len(second)) if first and second else 0.0


def _suggestion(
    targets: Signals, number: int, sources: Signals, score: float, place: int, alike: Iterable[int]
) -> Suggestion:
    target, source = targets.variables[number], sources.variables[place]
    mirrored = [bool(MIRRORED.search(f"{item.name} {item.signal.text}")) for item in (target, source)]
    notes: list[str] = []
    units: list[str] = []
    for item, side, other, its in ((target, targets, source, sources), (source, sources, target, targets)):
        is_open = item.kind is float and item.name in side.ports.unsaid
        unit = unit_of(item, side.ports) or unit_of(other, its.ports)
        units.append(unit if is_open and unit not in ("", "1") else "")
        if is_open and not unit_of(item, side.ports):
            notes.append(f"no unit is declared, {unit or 'SI'} is assumed")
    if mirrored[0] != mirrored[1]:
        notes.append("it counts the other way round, as it says")
    sign = "-" if mirrored[0] != mirrored[1] else ""
    others = [f"{sources.owner}.{sources.variables[item].name}" for item in alike if item != place][:MAX_OTHERS]
    full = f"{targets.owner}.{target.name}", f"{sign}{sources.owner}.{source.name}"
    same_unit = target.kind is not float or target.signal.unit == source.signal.unit
    is_plain = target.name == source.name and target.kind is source.kind and same_unit and not any((*units, sign))
    return Suggestion(*full, score, tuple(others), tuple(dict.fromkeys(notes)), units[0], units[1], is_plain)
