"""Teaches numba what model code needs of NamedTuples.

Defaults: numba (0.68) accepts ``State()`` and ``State(mode=3)`` but leaves the missing fields out.
Here a missing field takes its default as a constant. Literal types of the arguments are widened, so
that ``State(0)`` and ``State(count)`` have one type.

Speed: whenever a variable comes or goes, numba takes its value apart to the last scalar in search of
references to count. For types of plain numbers, there are none: it need not look.
"""

import inspect
from importlib import import_module
from typing import Any

from fmus import compiled_views
from fmus.compiled_views import value_type

numba: Any = import_module("numba")  # untyped on purpose: what it says of its types changes with every version
templates: Any = import_module("numba.core.typing.templates")
collections: Any = import_module("numba.core.typing.collections")
runtime: Any = import_module("numba.core.runtime.context")
types = numba.types
HOLDS_REFERENCES: dict[Any, bool] = {}
count_references = runtime.NRTContext._call_incref_decref


def install() -> None:
    """Put constructor and reference counting in the place of numba's own, and add views; may be called twice."""
    if collections.NamedTupleClassAttribute.resolve___call__ is _constructor:
        return
    compiled_views.install()
    collections.NamedTupleClassAttribute.resolve___call__ = _constructor
    for kind in (types.NamedTuple, types.NamedUniTuple):
        kind.mangling_args = property(lambda named: (named.instance_class.__name__, ()))
    runtime.NRTContext._call_incref_decref = _count_references


def _count_references(context: Any, builder: Any, kind: Any, value: Any, name: str) -> None:
    """Emit the counting of all references in ``value``, if its type can hold any."""
    holds = HOLDS_REFERENCES.get(kind)
    if holds is None:
        holds = HOLDS_REFERENCES[kind] = context._context.data_model_manager[kind].contains_nrt_meminfo()
    if holds:
        count_references(context, builder, kind, value, name)


def _constructor(attribute: Any, class_type: Any) -> Any:
    """Return the numba type of a NamedTuple class when it is called."""
    cls = class_type.instance_class
    pysig = inspect.signature(cls)

    class Constructor(templates.AbstractTemplate):  # type: ignore[misc]
        key = attribute.key

        def apply(self, args: tuple[Any, ...], kws: Any) -> Any:
            given = pysig.bind(*args, **dict(kws)).arguments
            fields = tuple(
                value_type(types.unliteral(given[name])) if name in given else numba.typeof(parameter.default)
                for name, parameter in pysig.parameters.items()
            )
            return templates.signature(types.BaseTuple.from_types(fields, cls), *fields).replace(pysig=pysig)

        generic = apply

    return types.Function(Constructor)
