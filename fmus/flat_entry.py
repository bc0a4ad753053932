"""Source text of thin functions between flat arrays of doubles and a model's NamedTuples.

    model_initialize(s, p, y)         p -> s, y
    model_step(s, u, p, y, dt_ns)     s, u, p -> s, y: the state is replaced in place

Every scalar is a double; integers up to 2^53 and truth values pass through unchanged. The order is
that of ``modelkit.variables``.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from modelkit.model import Model
from modelkit.variables import constructor_source, variables


class Entries(NamedTuple):
    """Plain Python functions over anything that can be indexed: lists, numpy arrays, C pointers."""

    initialize: Callable[..., None]
    step: Callable[..., None]


def entries(model: Model) -> Entries:
    """Return the two functions of ``model``."""
    scope: dict[str, Any] = {"initialize": model.initialize, "step": model.step}
    exec(initialize_source(model, scope), scope)
    exec(step_source(model, scope), scope)
    return Entries(scope["model_initialize"], scope["model_step"])


def sizes(model: Model) -> dict[str, int]:
    """Return the number of scalars of params, inputs, outputs and state."""
    groups = {"params": model.params, "inputs": model.inputs, "outputs": model.outputs, "state": model.state}
    return {name: len(variables(cls)) for name, cls in groups.items()}


def initialize_source(model: Model, scope: dict[str, Any]) -> str:
    """Return the text of ``model_initialize``; the names it needs are put into ``scope``."""
    lines = ["def model_initialize(s, p, y):", f"    state, outputs = initialize({_build(model.params, 'p', scope)})"]
    return "\n".join(lines + _stores(model)) + "\n"


def step_source(model: Model, scope: dict[str, Any]) -> str:
    """Return the text of ``model_step``; the names it needs are put into ``scope``."""
    groups = ((model.state, "s"), (model.inputs, "u"), (model.params, "p"))
    arguments = [_build(cls, array, scope) for cls, array in groups]
    lines = ["def model_step(s, u, p, y, dt_ns):", f"    state, outputs = step({', '.join(arguments)}, dt_ns)"]
    return "\n".join(lines + _stores(model)) + "\n"


def _build(cls: type[Any], array: str, scope: dict[str, Any]) -> str:
    def name_of(inner: type[Any]) -> str:
        known = {found: name for name, found in scope.items() if isinstance(found, type)}
        return known.get(inner) or _remember(inner, scope)

    expression, _ = constructor_source(cls(), name_of, array)
    return expression


def _remember(cls: type[Any], scope: dict[str, Any]) -> str:
    name = f"T{len(scope)}_{cls.__name__}"
    scope[name] = cls
    return name


def _stores(model: Model) -> list[str]:
    groups = ((model.state, "state", "s"), (model.outputs, "outputs", "y"))
    return [
        f"    {array}[{place}] = {source}"
        for cls, name, array in groups
        for place, source in enumerate(scalars(cls(), name))
    ]


def scalars(shape: Any, source: str) -> list[str]:
    """Return the expression of every scalar of ``shape``, which is called ``source``, in the order of ``variables``."""
    if not isinstance(shape, tuple):
        return [source]
    fields = getattr(shape, "_fields", None)
    names = [f".{field}" for field in fields] if fields else [f"[{place}]" for place in range(len(shape))]
    return [scalar for name, item in zip(names, shape, strict=True) for scalar in scalars(item, source + name)]
