"""The valet for scenes of many corners: the same code, with a longer map and longer columns of edges in its store.

A controller of its own beside ``valet``, whose FMU has neither the variables nor the memory of this map.
"""

import sys
import typing
from typing import Annotated, Any, NamedTuple

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.planning.task import CORNERS, Corner
from controller_fmu.valet.params import MAP_CORNERS, ValetParams, ValetSystem
from controller_fmu.valet.standalone import MODEL as VALET
from modelkit.composition import fields_of, make_named_tuple
from modelkit.model import Model, Variant
from modelkit.store import Column

LARGE_MAP_CORNERS = 2048
LARGE_CORNERS = LARGE_MAP_CORNERS + CORNERS - MAP_CORNERS
"""Those of the map, and as many as the valet has for obstacles that are in no map."""
NEAR_ITEMS_PER_EDGE = 64
"""Entries in the lists of edges by cell: an edge of 0.4 m is listed in some 20 cells of 2 m."""
LARGE_NEAR_ITEMS = NEAR_ITEMS_PER_EDGE * LARGE_CORNERS
LENGTHS = {
    **dict.fromkeys(("edge_x1", "edge_y1", "edge_x2", "edge_y2"), LARGE_CORNERS),
    **dict.fromkeys(("corner_x", "corner_y", "corner_of", "around_x", "around_y", "around_of"), LARGE_CORNERS),
    "near_edge": LARGE_NEAR_ITEMS,
}
"""Column of the store -> its length."""


def _with_defaults(own: type[Any], **defaults: Any) -> Any:
    """Return a type with the fields of ``own`` and other defaults, which tell how long its tuples are.

    It counts as one of the module of ``own``, where its C struct is needed.
    """
    fields = {name: (field.hint, defaults.get(name, field.default)) for name, field in fields_of(own).items()}
    return make_named_tuple(f"Large{own.__name__}", own.__module__, str(own.__doc__), fields)


def _store() -> Any:
    hints = typing.get_type_hints(PlanStore, include_extras=True)
    for name, length in LENGTHS.items():
        (column,) = (mark for mark in hints[name].__metadata__ if isinstance(mark, Column))
        hints[name] = Annotated[hints[name].__origin__, column._replace(length=length)]
    made: Any = NamedTuple("LargePlanStore", list(hints.items()))  # type: ignore[misc]
    made.__module__, made.__doc__ = PlanStore.__module__, PlanStore.__doc__
    return made


LargeValetParams = _with_defaults(ValetParams, system=ValetSystem.VALET_LARGE, map=(Corner(),) * LARGE_MAP_CORNERS)
LargePlanStore = _store()
MODEL: Model[Any, Any, Any, Any] = VALET._replace(
    name="Controller_valet_large",
    description=f"Valet for scenes of up to {LARGE_MAP_CORNERS} corners",
    package=sys.modules[__package__.rpartition(".")[0]],
    params=LargeValetParams,
    store=LargePlanStore,
    view=Variant((("system", int(ValetSystem.VALET_LARGE)),), frozenset({"system"})),
    substitutes=((ValetParams, LargeValetParams), (PlanStore, LargePlanStore)),
)
