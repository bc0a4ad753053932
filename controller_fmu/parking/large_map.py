"""The parking system for maps of many vertices: the same code with a longer map and longer columns of edges.

A controller of its own beside ``apa``, whose FMU has neither the variables nor the memory of this map.
"""

import sys
import typing
from typing import Annotated, Any, NamedTuple

from controller_fmu.parking.geometry.polygons import LOCAL_VERTICES, Vertex
from controller_fmu.parking.params import ParkingParams, ParkingSystem
from controller_fmu.parking.planning.work import PlanningWork
from controller_fmu.parking.standalone import MODEL as APA
from modelkit.composition import fields_of, make_named_tuple
from modelkit.model import Model, Variant
from modelkit.store import Column

LARGE_MAP_VERTICES = 2048
LARGE_VERTICES = LOCAL_VERTICES + LARGE_MAP_VERTICES
ITEMS_PER_EDGE = 64
"""Entries in the lists of edges by cell: an edge of 0.4 m is listed in some 20 cells of 2 m."""
COLUMN_LENGTHS = {
    **dict.fromkeys(("edge_x1", "edge_y1", "edge_x2", "edge_y2"), LARGE_VERTICES),
    **dict.fromkeys(("corner_x", "corner_y", "corner_of"), LARGE_VERTICES),
    "cell_edge": ITEMS_PER_EDGE * LARGE_VERTICES,
}
"""Column of the work arrays -> its length."""


def _with_defaults(own: type[Any], **defaults: Any) -> Any:
    """Return a type with the fields of ``own`` and other defaults, which say how long its tuples are.

    It counts as one of the module of ``own``, where its C struct is needed.
    """
    fields = {name: (field.hint, defaults.get(name, field.default)) for name, field in fields_of(own).items()}
    return make_named_tuple(f"Large{own.__name__}", own.__module__, str(own.__doc__), fields)


def _large_work() -> Any:
    hints = typing.get_type_hints(PlanningWork, include_extras=True)
    for name, length in COLUMN_LENGTHS.items():
        (column,) = (mark for mark in hints[name].__metadata__ if isinstance(mark, Column))
        hints[name] = Annotated[hints[name].__origin__, column._replace(length=length)]
    made: Any = NamedTuple("LargePlanningWork", list(hints.items()))  # type: ignore[misc]
    made.__module__, made.__doc__ = PlanningWork.__module__, PlanningWork.__doc__
    return made


LargeParkingParams = _with_defaults(ParkingParams, system=ParkingSystem.APA_LARGE, map=(Vertex(),) * LARGE_MAP_VERTICES)
LargePlanningWork = _large_work()
MODEL: Model[Any, Any, Any, Any] = APA._replace(
    name="Controller_apa_large",
    description=f"Parking with maps of up to {LARGE_MAP_VERTICES} vertices",
    package=sys.modules[__package__.rpartition(".")[0]],
    params=LargeParkingParams,
    store=LargePlanningWork,
    view=Variant((("system", int(ParkingSystem.APA_LARGE)),), frozenset({"system"})),
    substitutes=((ParkingParams, LargeParkingParams), (PlanningWork, LargePlanningWork)),
)
