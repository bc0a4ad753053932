"""How slot, target, neighbours and kerb of a page follow ``slot_layout``: values and derivatives of what it generates.

Seen from the origin of the layout, each generated value is affine in length and depth; the origin moves all rigidly.
"""

import math
from collections.abc import Iterator
from typing import Any

from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.scenario.slot_layout import KEY, LayoutOrigin, SlotLayout, scene_of
from orchestrator.inputs.scenario.target_point import as_rear_axle

SIZES = ("length", "depth")
LAYOUT_TOLERANCE = 1e-9
"""What differs more from what the layout generates was changed afterwards and does not follow it [m]."""
ENDS = (("x", "y"), ("x1", "y1"), ("x2", "y2"))


def layout_data(scenario: Scenario) -> dict[str, Any] | None:
    """Return what the page needs to follow the scenario's ``slot_layout``, None if it has none.

    ``start``: length, depth [m], x, y [m] and heading [rad] of the origin. ``points``: names of x, y and heading (or
    None) and, in the frame of the origin, x, y [m] with their derivatives by length and depth. ``sizes``: name, value
    [m] and its derivatives by length and depth.
    """
    layout = scenario.slot_layout
    if layout is None:
        return None
    here = layout.model_copy(update={"origin": LayoutOrigin()})
    value, *moved = [
        dict(_flat(scenario, item))
        for item in (here, *(here.model_copy(update={size: getattr(here, size) + 1.0}) for size in SIZES))
    ]
    slopes = {name: [round(other[name] - at, 9) for other in moved] for name, at in value.items()}
    actual = dict(_flat(scenario, layout))
    places = [names for names in _places(value) if all(_is_generated(scenario, n, actual[n]) for n in names if n)]
    taken = {name for names in places for name in names}
    return {
        "start": [layout.length, layout.depth, *(getattr(layout.origin, axis) for axis in ("x", "y", "heading"))],
        "points": [[*names, *([value[name], *slopes[name]] for name in names[:2])] for names in places],
        "sizes": [
            [name, at, *slopes[name]]
            for name, at in value.items()
            if name not in taken and any(slopes[name]) and _is_generated(scenario, name, actual[name])
        ],
        "names": [f"{KEY}.{name}" for name in (*SIZES, "origin.x", "origin.y", "origin.heading")],
    }


def _flat(scenario: Scenario, layout: SlotLayout) -> Iterator[tuple[str, float]]:
    """Yield each generated value by the name it has on the page, the target as the pose of the rear axle."""
    generated = scene_of(layout)
    target = as_rear_axle(generated["target"], scenario.vehicle, KEY)
    assert isinstance(target, dict)
    rows = {"slot": generated["slot"], "target": target}
    for array, items in generated["scene"].items():
        rows |= {f"vehicle.scene.{array}[{number}]": item for number, item in enumerate(items, start=1)}
    for owner, row in rows.items():
        yield from ((f"{owner}.{name}", float(item)) for name, item in row.items())


def _places(value: dict[str, float]) -> Iterator[tuple[str, str, str | None]]:
    """Yield the names of x, y and heading of each point; an end of a kerb has no heading."""
    for owner in dict.fromkeys(name.rpartition(".")[0] for name in value):
        for x, y in ENDS:
            if f"{owner}.{x}" in value:
                heading = f"{owner}.heading"
                yield f"{owner}.{x}", f"{owner}.{y}", heading if heading in value else None


def _is_generated(scenario: Scenario, name: str, value: float) -> bool:
    owner, _, rest = name.partition(".")
    if owner == "vehicle":
        given = scenario.vehicle.get(rest, 0.0)
    else:
        given = getattr(getattr(scenario, owner), rest, math.inf)
    return abs(float(given) - value) < LAYOUT_TOLERANCE
