"""``slot_layout``: a slot with its neighbours, kerb and target from one key, so that they move together.

The road edge is a line through ``origin`` along the driving direction; the gap begins at ``origin`` and reaches
``length`` along that line. Positions are computed as (s, d): s along the road edge, d from it into the row [m].
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from modelkit.variables import variables
from orchestrator.inputs.scenario.flat_names import merge_nested
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.quantities import Metres, Radians
from orchestrator.inputs.text.yaml_file import explain

KEY = "slot_layout"
GENERATED = ("slot", "target")
"""Keys of a scenario that a layout generates besides boxes and kerbs of its scene."""
KERB_MARGIN = 10.0
"""The kerb reaches this far beyond the last car of the row [m]."""
POSITION_DECIMALS = 12
"""Positions are rounded to a picometre, so that sums of decimal numbers stay decimal."""
Positive = Annotated[Metres, Field(gt=0.0)]
NotNegative = Annotated[Metres, Field(ge=0.0)]


class _LayoutPart(BaseModel):
    model_config = ConfigDict(extra="forbid", populate_by_name=True)


class LayoutOrigin(_LayoutPart):
    """Start of the gap on the road edge, and the driving direction."""

    x: Metres = 0.0
    """x of the start of the gap [m]."""
    y: Metres = 0.0
    """y of the start of the gap [m]."""
    heading: Radians = 0.0
    """Driving direction [rad]."""


class Neighbours(_LayoutPart):
    """The parked cars on both sides of the gap."""

    which: Literal["both", "first", "second", "none"] = "both"
    """Side of the gap with parked cars; the vehicle passes the first side first."""
    length: Positive = 4.4
    """Length of each car [m]."""
    width: Positive = 1.8
    """Width of each car [m]."""
    setback: Metres = 0.0
    """Distance from the road edge to each car [m]."""


class LayoutKerb(_LayoutPart):
    """A kerb parallel to the road edge."""

    height: Positive = 0.12
    """Height of the kerb [m]."""
    distance: Metres | None = None
    """Distance from the road edge [m]; by default the depth of the slot."""
    begin: Metres | None = Field(default=None, alias="from")
    """Start of the kerb along the road edge [m]; by default 10 m before the row of cars."""
    end: Metres | None = Field(default=None, alias="to")
    """End of the kerb along the road edge [m]; by default 10 m behind the row of cars."""


class SlotLayout(_LayoutPart):
    """Generates slot, target, parked cars and kerb; lengths in m or with a unit, angles in rad or with a unit."""

    kind: Literal["parallel", "perpendicular", "angled"]
    """Kind of slot."""
    length: Positive
    """Length of the gap along the road edge [m]."""
    depth: Positive
    """Depth of the slot: width of a parallel slot, length of a perpendicular or angled slot [m]."""
    angle: Radians | None = None
    """angled: angle from the driving direction to a car with its nose to the road, 30 to 150 deg [rad]."""
    nose_in: bool = False
    """perpendicular, angled: if true, the nose of the target points away from the road."""
    side: Literal["right", "left"] = "right"
    """Side of the road with the slot, in the driving direction."""
    origin: LayoutOrigin = LayoutOrigin()
    """Start of the gap on the road edge, and driving direction."""
    neighbours: Neighbours = Neighbours()
    """Parked cars on both sides of the gap."""
    row: Annotated[int, Field(ge=0)] = 0
    """Number of further parked cars beyond each neighbour."""
    row_gap: NotNegative = 0.7
    """Gap between the cars of the row [m]."""
    kerb: LayoutKerb | None = None
    """Kerb parallel to the road edge; by default none."""

    @model_validator(mode="after")
    def _angles(self) -> "SlotLayout":
        if (self.kind == "angled") != (self.angle is not None):
            raise BadInput("is given for kind: angled, and only there", key="angle")
        if self.angle is not None and not math.radians(30.0) <= self.angle <= math.radians(150.0):
            raise BadInput(f"{math.degrees(self.angle):g} deg is out of range, expected 30 to 150 deg", key="angle")
        if self.nose_in and self.kind == "parallel":
            raise BadInput("is not for kind: parallel", key="nose_in")
        return self


class _RowAxis(NamedTuple):
    """Direction of the cars in the row: cosine and sine of the angle to the driving direction."""

    cos: float
    sin: float


def expand_layouts(layers: list[tuple[dict[str, Any], object]]) -> list[tuple[dict[str, Any], object]]:
    """Return the layers of a scenario, lowest first, with what their ``slot_layout`` generates.

    Layouts of several layers are merged; the uppermost layer that has one gets slot, target, boxes and kerbs, its own
    boxes and kerbs behind the generated ones. Raises ``BadInput`` where one layer gives a slot or target besides.
    """
    layout = layout_of(layers)
    if layout is None:
        return layers
    last = max(place for place, (content, _) in enumerate(layers) if content.get(KEY) is not None)
    content, file = layers[last]
    twice = [key for key in GENERATED if key in content]
    if twice:
        raise BadInput(f"is generated by {KEY}; give one of them", file=file, key=twice[0])
    generated = scene_of(layout)
    scene = dict(content.get("scene") or {})
    for array in ("boxes", "kerbs"):
        items = [*generated["scene"][array], *scene.get(array, [])]
        _check_capacity(array, len(items), file)
        scene[array] = items
    new = {name: item for name, item in content.items() if name != KEY} | generated | {"scene": scene}
    rest = [({name: item for name, item in below.items() if name != KEY}, at) for below, at in layers]
    return [*rest[:last], (new, file), *rest[last + 1 :]]


def layout_of(layers: Iterable[tuple[dict[str, Any], object]]) -> SlotLayout | None:
    """Return what the layers of a scenario, lowest first, say in ``slot_layout``; None if nothing.

    Raises ``BadInput`` with the uppermost layer that has one.
    """
    merged: dict[str, Any] = {}
    last: object = None
    for content, file in layers:
        given = content.get(KEY)
        if given is None:
            continue
        if not isinstance(given, Mapping):
            raise BadInput("expected a mapping of kind, length, depth, ...", file=file, key=KEY)
        for name, value in given.items():
            merged = merge_nested(merged, _nest(str(name), value))
        last = file
    if last is None:
        return None
    if "kind" not in merged:
        keys = ", ".join(SlotLayout.model_fields)
        text = f"the scenario has none, so its slot, neighbours and kerb are given one by one; a new one needs {keys}"
        raise BadInput(text, file=last, key=KEY)
    try:
        return SlotLayout.model_validate(merged)
    except ValidationError as error:
        raise explain(error, last, SlotLayout, section=KEY) from None


def _nest(name: str, value: object) -> dict[str, Any]:
    """Return ``{"origin": {"x": value}}`` for ``origin.x``."""
    first, dot, rest = name.partition(".")
    return {first: _nest(rest, value) if dot else value}


def scene_of(layout: SlotLayout) -> dict[str, Any]:
    """Return ``slot``, ``target`` and ``scene`` of a scenario for a layout; lengths in m, angles in rad."""
    cars = list(_row(layout))
    return {
        "slot": _slot(layout),
        "target": _target(layout),
        "scene": {"boxes": [_car(layout, s) for s in cars], "kerbs": list(_kerbs(layout, cars))},
    }


def _axis(layout: SlotLayout) -> _RowAxis:
    if layout.kind == "angled":
        assert layout.angle is not None
        return _RowAxis(math.cos(layout.angle), math.sin(layout.angle))
    return _RowAxis(0.0, 1.0) if layout.kind == "perpendicular" else _RowAxis(1.0, 0.0)


def _row(layout: SlotLayout) -> Iterator[float]:
    """Yield the middle of each parked car along the road edge [m]: before the gap, then behind it, nearest first."""
    cars = layout.neighbours
    extent = cars.length if layout.kind == "parallel" else cars.width / _axis(layout).sin
    for which, sign, edge in (("first", -1.0, 0.0), ("second", 1.0, layout.length)):
        if cars.which in ("both", which):
            for number in range(layout.row + 1):
                yield edge + sign * (0.5 * extent + number * (extent + layout.row_gap))


def _car(layout: SlotLayout, s: float) -> dict[str, float]:
    cars = layout.neighbours
    if layout.kind == "parallel":
        return {**_at(layout, s, cars.setback + 0.5 * cars.width), **_size(layout, cars.length, cars.width)}
    if layout.kind == "perpendicular":
        return {**_at(layout, s, cars.setback + 0.5 * cars.length), **_size(layout, cars.width, cars.length)}
    place = _along_axis(layout, s, cars.width, 0.5 * cars.length, cars.setback)
    return {**_at(layout, *place), "heading": _heading(layout), "length": cars.length, "width": cars.width}


def _size(layout: SlotLayout, length: float, width: float) -> dict[str, float]:
    return {"heading": layout.origin.heading, "length": length, "width": width}


def _slot(layout: SlotLayout) -> dict[str, float]:
    middle = 0.5 * layout.length
    if layout.kind != "angled":
        size = (layout.length, layout.depth) if layout.kind == "parallel" else (layout.depth, layout.length)
        place = _at(layout, middle, 0.5 * layout.depth)
        return {**place, "heading": _heading(layout), "length": size[0], "width": size[1]}
    width = layout.length * _axis(layout).sin
    place = _at(layout, *_along_axis(layout, middle, width, 0.5 * layout.depth, 0.0))
    return {**place, "heading": _heading(layout), "length": layout.depth, "width": width}


def _target(layout: SlotLayout) -> dict[str, Any]:
    """Return the target: the side or the front of the car at the road edge, in the middle of the gap."""
    middle = 0.5 * layout.length
    if layout.kind == "parallel":
        of = "left" if layout.side == "right" else "right"
        return {"reference_point": of, **_at(layout, middle, 0.0), "heading": _heading(layout)}
    turn = math.pi if layout.nose_in else 0.0
    place = (middle, 0.0)
    if layout.kind == "angled":
        place = _along_axis(layout, middle, layout.length * _axis(layout).sin, 0.0, 0.0)
    of = "rear" if layout.nose_in else "front"
    return {"reference_point": of, **_at(layout, *place), "heading": _heading(layout) + turn}


def _along_axis(layout: SlotLayout, s: float, width: float, inside: float, setback: float) -> tuple[float, float]:
    """Return (s, d) on the axis of a rectangle of ``width`` through s, ``inside`` behind the middle of its front.

    The front corner nearest to the road lies ``setback`` from the road edge.
    """
    axis = _axis(layout)
    behind = (0.5 * width * abs(axis.cos) + setback) / axis.sin + inside
    return s - axis.cos * behind, axis.sin * behind


def _kerbs(layout: SlotLayout, cars: list[float]) -> Iterator[dict[str, float]]:
    if layout.kerb is None:
        return
    kerb = layout.kerb
    begin = min([0.0, *cars]) - KERB_MARGIN if kerb.begin is None else kerb.begin
    end = max([layout.length, *cars]) + KERB_MARGIN if kerb.end is None else kerb.end
    d = layout.depth if kerb.distance is None else kerb.distance
    first, second = _at(layout, begin, d), _at(layout, end, d)
    yield {"x1": first["x"], "y1": first["y"], "x2": second["x"], "y2": second["y"], "height": kerb.height}


def _heading(layout: SlotLayout) -> float:
    """Return the direction of a car with its nose to the road [rad]; along the road for a parallel slot."""
    if layout.kind == "parallel":
        return layout.origin.heading
    angle = 0.5 * math.pi if layout.angle is None else layout.angle
    return layout.origin.heading + (angle if layout.side == "right" else -angle)


def _at(layout: SlotLayout, s: float, d: float) -> dict[str, float]:
    """Return the position of (s, d) in the world [m]."""
    left = -d if layout.side == "right" else d
    c, n = math.cos(layout.origin.heading), math.sin(layout.origin.heading)
    x, y = layout.origin.x + s * c - left * n, layout.origin.y + s * n + left * c
    return {"x": round(x, POSITION_DECIMALS), "y": round(y, POSITION_DECIMALS)}


def _check_capacity(array: str, count: int, file: object) -> None:
    names = {item.name.partition("]")[0] for item in variables(MODELS["vehicle"].params)}
    most = sum(name.startswith(f"scene.{array}[") for name in names)
    if count > most:
        raise BadInput(f"{count} {array} with those of the row, the scene holds {most}", file=file, key=KEY)
