"""Teaches numba the defaults of NamedTuples: ``State()`` and ``State(mode=3)`` mean in compiled code what they say.

Numba (0.68) accepts such calls but leaves the missing fields out. Here a missing field takes its
default as a constant. Literal types of the arguments are widened, so that ``State(0)`` and
``State(count)`` have one type.
"""

import inspect
from importlib import import_module
from typing import Any

numba: Any = import_module("numba")  # untyped on purpose: what it says of its types changes with every version
templates: Any = import_module("numba.core.typing.templates")
collections: Any = import_module("numba.core.typing.collections")
types = numba.types


def install() -> None:
    """Put the constructor with defaults in the place of numba's own; may be called twice."""
    collections.NamedTupleClassAttribute.resolve___call__ = _constructor


def _constructor(attribute: Any, class_type: Any) -> Any:
    """Return the numba type of a NamedTuple class when it is called."""
    cls = class_type.instance_class
    pysig = inspect.signature(cls)

    class Constructor(templates.AbstractTemplate):  # type: ignore[misc]
        key = attribute.key

        def apply(self, args: tuple[Any, ...], kws: Any) -> Any:
            given = pysig.bind(*args, **dict(kws)).arguments
            fields = tuple(
                types.unliteral(given[name]) if name in given else numba.typeof(parameter.default)
                for name, parameter in pysig.parameters.items()
            )
            return templates.signature(types.BaseTuple.from_types(fields, cls), *fields).replace(pysig=pysig)

        generic = apply

    return types.Function(Constructor)
