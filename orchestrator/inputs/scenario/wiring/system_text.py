"""A system as a scenario states it: which instances, from which files, what feeds what, and what plays which role."""

import re
from collections.abc import Container, Iterator, Mapping
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.wiring.modes import ModeList
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.quantities import Metres, Radians, Whole, unit_symbol

TERM = re.compile(r"(?P<minus>-)?\s*(?P<name>[^\s-].*?)(?:\s+\[(?P<unit>[^\[\]]*)\])?")
QUOTED = re.compile(r'(?P<owner>[^."]*\.)?"(?P<name>[^"]*)"')
MAX_COMMAS = 8
"""No name has more of them."""
SLAVE = re.compile(r"^[A-Za-z_][A-Za-z0-9_]*$")
NO_FILE = "none"
"""Written for an instance that the system does not have."""
ROLES: dict[str, tuple[str, ...]] = {
    "pose": ("vehicle.pose.x", "vehicle.pose.y", "vehicle.pose.heading"),
    "speed": ("vehicle.speed",),
    "wheel": ("vehicle.steering_wheel_angle",),
    "clearance": ("vehicle.clearance",),
    "mode": ("controller.phase",),
    "reason": ("controller.reason",),
    "manoeuvres": ("controller.manoeuvres",),
    "request": ("controller.steering_wheel_request",),
    "prompt": ("controller.prompt",),
}
"""Short name of a role -> the signals that judge, log, page and figure look for."""


class Term(NamedTuple):
    """A signal as it is written: ``-controller.angle [deg]``."""

    name: str
    unit: str | None
    """What the number is in, if that is written."""
    minus: bool


def terms(text: str, known: Container[str] = ()) -> list[Term]:
    """Return the signals in ``text``, separated by commas. Raises ``BadInput`` if it is no such list.

    A name may have spaces; one with a comma is understood if it is ``known``, or stands in double quotes.
    """
    parts = list(_between_commas(text))
    found: list[Term] = []
    at = 0
    while at < len(parts):
        ends = range(min(len(parts), at + MAX_COMMAS), at, -1)
        tried = ((end, _term(",".join(parts[at:end]).strip(), known)) for end in ends)
        end, term = next(
            ((end, term) for end, term in tried if term is not None and term.name in known), (at + 1, None)
        )
        term = term or _term(parts[at].strip(), known)
        if term is None:
            raise BadInput(f"{parts[at].strip()!r} is no signal; expected the like of -controller.angle [deg]")
        found.append(term)
        at = end
    return found


def _term(text: str, known: Container[str]) -> Term | None:
    """Return one signal: the name as it is if it is known, else a name and its unit."""
    plain = text.removeprefix("-").strip()
    if plain in known:
        return Term(plain, None, plain != text)
    match = TERM.fullmatch(text)
    if match is None:
        return None
    quoted, unit = QUOTED.fullmatch(match["name"]), match["unit"]
    name = match["name"] if quoted is None else (quoted["owner"] or "") + quoted["name"]
    return Term(name, None if unit is None else unit_symbol(unit), match["minus"] is not None)


def _between_commas(text: str) -> Iterator[str]:
    """Yield what stands between the commas that are neither in brackets nor in double quotes."""
    begin, depth, is_quoted = 0, 0, False
    for place, letter in enumerate(text):
        if letter == '"':
            is_quoted = not is_quoted
        elif letter in "[]" and not is_quoted:
            depth = max(depth + (1 if letter == "[" else -1), 0)
        elif letter == "," and not is_quoted and depth == 0:
            yield text[begin:place]
            begin = place + 1
    yield text[begin:]


class _SystemPart(BaseModel):
    model_config = ConfigDict(extra="forbid", populate_by_name=True)


class InstanceEntry(_SystemPart):
    """One instance: the FMU, or model, it is, and its parameters."""

    file: str = ""
    """An .fmu or ``model.py:MODEL`` beside the scenario; empty: ours of this name; ``none``: there is none."""
    parameters: dict[str, Any] = {}
    """Parameters of its own; those of vehicle and controller may also stand in their own sections."""
    units: dict[str, str] = {}
    """Variables of which its FMU declares no unit -> what their numbers are in."""


class UnitEntry(_SystemPart):
    """A unit in SI base units: ``value * factor + offset``, as FMI defines it."""

    factor: float = 1.0
    offset: float = 0.0
    kg: int = 0
    m: int = 0
    s: int = 0
    A: int = 0
    K: int = 0
    mol: int = 0
    cd: int = 0
    rad: int = 0


class Origin(_SystemPart):
    """Where another frame has its origin in ours, and where its x axis points."""

    x: Metres = 0.0
    """[m]"""
    y: Metres = 0.0
    """[m]"""
    heading: Radians = 0.0
    """Direction of its x axis [rad]."""


class PoseFrame(_SystemPart):
    """Frame of the poses of a third-party FMU, relative to ISO 8855 at the midpoint of the rear axle."""

    origin: Origin = Origin()
    """Its origin in our frame."""
    y: Literal["left", "right"] = "left"
    """Where its y axis points, seen along x; ``right``: headings count clockwise."""
    ahead: Metres = 0.0
    """How far its reference point of the car lies ahead of the rear axle [m]."""


class Feed(_SystemPart):
    """What feeds inputs, or a role: signals, or a constant."""

    from_: Annotated[str, Field(alias="from")] = ""
    """Signals, as many as there are inputs: ``-controller.angle [deg]``."""
    value: float | str | bool | None = None
    """A constant instead: a number with or without unit, true or false, the name of a state."""
    factor: float = 1.0
    """The signal times this..."""
    offset: float = 0.0
    """...plus this, in the unit of the signal, before it is brought into that of the input."""
    units: bool = True
    """Bring the number from the unit of one side into that of the other."""
    map: dict[Whole | str, float | Whole | str | bool] | None = None
    """Value of the signal -> value of the input, by number or by name of a state."""
    otherwise: Annotated[float | Whole | str | bool | None, Field(alias="else")] = None
    """Value of the input for all that is not in the map (its start value)."""
    states: dict[str, Whole] | None = None
    """Names of the values, for a mode whose FMU does not name them."""
    into: str | None = None
    """Three signals are a pose of ours, brought into this frame."""
    out_of: str | None = None
    """Three signals are a pose in this frame, brought into ours."""

    @model_validator(mode="after")
    def _one_source(self) -> "Feed":
        if bool(self.from_) == (self.value is not None):
            raise BadInput("expected a signal (from) or a constant (value)")
        if self.from_:
            terms(self.from_)
        return self


def _feeds(written: Any, instances: frozenset[str]) -> Any:
    """Return what is written as a mapping for :class:`Feed`: a text that names an instance is a signal."""
    if isinstance(written, Mapping):
        given = dict(written)
        if isinstance(given.get("from"), list):
            given["from"] = ", ".join(map(str, given["from"]))
        return given
    if isinstance(written, list):
        return {"from": ", ".join(map(str, written))}
    is_signal = isinstance(written, str) and written.strip(' -"').partition(".")[0] in instances
    return {"from": written} if is_signal else {"value": written}


def _entry(written: Any) -> Any:
    if written is None:
        return {"file": NO_FILE}
    return {"file": written} if isinstance(written, str) else written


Entry = Annotated[InstanceEntry, BeforeValidator(_entry)]


class SystemText(_SystemPart):
    """Instances, and what is connected; outputs and inputs of the same name are connected without a word."""

    ssp: str = ""
    """A system made elsewhere, whose instances, connections and parameters are taken over."""
    components: dict[str, Entry] = {}
    """Name -> FMU. ``vehicle`` and ``controller`` are ours if nothing else is said."""
    connections: dict[str, Feed] = {}
    """Inputs -> what feeds them."""
    roles: dict[str, Feed] = {}
    """What judge, log, page and figure look for -> the signal that it is."""
    modes: dict[str, ModeList] = {}
    """Outputs that tell a mode -> its states and transitions, for ``apa test --coverage``."""
    units: dict[str, UnitEntry] = {}
    """Units that the FMUs do not define, by the name used in connections."""
    ignored: list[str] = []
    """Elements of an .ssp that are ignored; a message before the run names them."""
    by_name: bool = True
    """Connect outputs and inputs of the same name of which nothing else is said."""
    frames: dict[str, PoseFrame] = {}
    """Frames of others, by the name that ``into`` and ``out_of`` give them."""

    @model_validator(mode="before")
    @classmethod
    def _normalise(cls, given: Any) -> Any:
        if not isinstance(given, Mapping):
            return given
        instances = given.get("components")
        names = frozenset({*MODELS, *(map(str, instances) if isinstance(instances, Mapping) else ())})
        made = dict(given)
        for key in ("connections", "roles"):
            section = made.get(key)
            if isinstance(section, Mapping):
                made[key] = {str(name): _feeds(item, names) for name, item in section.items()}
        return made

    @model_validator(mode="after")
    def _names(self) -> "SystemText":
        for name in self.components:
            if SLAVE.match(name) is None:
                raise BadInput("is no name for an instance: write letters, digits and _", key=f"components.{name}")
        if not self.places:
            raise BadInput("there is no instance left", key="components")
        for feed in (*self.connections.values(), *self.roles.values()):
            for frame in (feed.into, feed.out_of):
                if frame is not None and frame not in self.frames:
                    known = ", ".join(self.frames) or "none"
                    raise BadInput(f"{frame!r} is none of the frames; there are {known}", key="system")
        return self

    def files(self) -> dict[str, str]:
        """Return instance -> what its file is called, for those that are not ours."""
        return {name: item.file for name, item in self.components.items() if item.file and item.file != NO_FILE}

    @property
    def places(self) -> list[str]:
        """Return the names of the instances in their order: vehicle and controller first, as far as they are there."""
        gone = {name for name, item in self.components.items() if item.file == NO_FILE}
        return [name for name in dict.fromkeys([*MODELS, *self.components]) if name not in gone]
