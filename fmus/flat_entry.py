"""Source text of thin functions between flat arrays of doubles and a model's NamedTuples.

    model_initialize(s, p, y)         p -> s, y
    model_step(s, u, p, y, dt_ns)     s, u, p -> s, y: the state is replaced in place

Every scalar is a double; integers up to 2^53 and truth values pass through unchanged. The order is
that of ``modelkit.variables``. The step of a model with branches is one function for each, which reads
and writes the memory of its system only.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from modelkit.model import Branch, Branches, Model
from modelkit.variables import constructor, constructor_source, flatten, variables


class Entries(NamedTuple):
    """Plain Python functions over anything that can be indexed: lists, numpy arrays, C pointers."""

    initialize: Callable[..., None]
    step: Callable[..., None]
    branches: dict[str, Callable[..., None]]
    """What ``step`` chooses from, under the names by which it calls them."""


def entries(model: Model, see: Callable[[type[Any]], Callable[..., Any]] = constructor) -> Entries:
    """Return the two functions of ``model``; ``see(cls)`` makes the function from an array to a ``cls``."""
    scope: dict[str, Any] = {"initialize": model.initialize, "step": model.step}
    scope |= {"see_inputs": see(model.inputs), "see_params": see(model.params)}
    exec(initialize_source(model, scope), scope)
    exec(step_source(model, scope), scope)
    branches = {name: item for name, item in scope.items() if name.startswith("branch_")}
    return Entries(scope["model_initialize"], scope["model_step"], branches)


def sizes(model: Model) -> dict[str, int]:
    """Return the number of scalars of params, inputs, outputs and state."""
    groups = {"params": model.params, "inputs": model.inputs, "outputs": model.outputs, "state": model.state}
    return {name: len(variables(cls)) for name, cls in groups.items()}


def initialize_source(model: Model, scope: dict[str, Any]) -> str:
    """Return the text of ``model_initialize``; the names it needs are put into ``scope``."""
    call = "    state, outputs = initialize(see_params(p))"
    stores = [*_stores(model.state(), "state", "s"), *_stores(model.outputs(), "outputs", "y")]
    return "\n".join(["def model_initialize(s, p, y):", call, *stores, ""])


def step_source(model: Model, scope: dict[str, Any]) -> str:
    """Return the text of ``model_step``; the names it needs are put into ``scope``."""
    if model.branches:
        return _choice_source(model, model.branches, scope)
    given = (_build(model.state(), "s", scope), "see_inputs(u)", "see_params(p)")
    stores = [*_stores(model.state(), "state", "s"), *_stores(model.outputs(), "outputs", "y")]
    call = f"    state, outputs = step({', '.join(given)}, dt_ns)"
    return "\n".join(["def model_step(s, u, p, y, dt_ns):", call, *stores, ""])


def _choice_source(model: Model, branches: Branches, scope: dict[str, Any]) -> str:
    """Return the text of a function for each branch and of the ``model_step`` that chooses."""
    place = [item.name for item in variables(model.params)].index(branches.parameter)
    first, *others = branches.systems
    scope |= {"tick": branches.tick, "refused": branches.refused}
    lines = [line for branch in branches.systems for line in _branch_source(model, branches.clock, branch, scope)]
    lines += ["def model_step(s, u, p, y, dt_ns):", f"    chosen = int(p[{place}])"]
    for branch in others:
        values = tuple(int(value) for value in branch.values)
        lines += [f"    if chosen in {values}:", f"        branch_{branch.field}(s, u, p, y, dt_ns)", "        return"]
    return "\n".join([*lines, f"    branch_{first.field}(s, u, p, y, dt_ns)", ""])


def _branch_source(model: Model, clock: str, branch: Branch, scope: dict[str, Any]) -> list[str]:
    """Return the text of ``Branches.step`` for one system."""
    shape, field = model.state(), branch.field
    scope |= {f"sample_{field}": branch.sample, f"outputs_{field}": branch.outputs}
    before, own = getattr(shape, clock), getattr(shape, field)
    clock_at, own_at = _place(shape, clock), _place(shape, field)
    return [
        f"def branch_{field}(s, u, p, y, dt_ns):",
        "    inputs, params = see_inputs(u), see_params(p)",
        f"    clock, samples, period_ns = tick({_build(before, 's', scope, clock_at)}, params, dt_ns)",
        f"    own = {_build(own, 's', scope, own_at)}",
        "    for _ in range(samples):",
        f"        own = sample_{field}(own, inputs, params, period_ns)",
        f"    outputs = outputs_{field}(own, params) if clock.usable else refused()",
        *_stores(before, "clock", "s", clock_at),
        *_stores(own, "own", "s", own_at),
        *_stores(model.outputs(), "outputs", "y"),
    ]


def _place(shape: Any, field: str) -> int:
    """Return the index of the first scalar of ``field``."""
    return len(flatten(shape[: shape._fields.index(field)]))


def _build(shape: Any, array: str, scope: dict[str, Any], at: int = 0) -> str:
    def name_of(inner: type[Any]) -> str:
        known = {found: name for name, found in scope.items() if isinstance(found, type)}
        return known.get(inner) or _remember(inner, scope)

    expression, _ = constructor_source(shape, name_of, array, at)
    return expression


def _remember(cls: type[Any], scope: dict[str, Any]) -> str:
    name = f"T{len(scope)}_{cls.__name__}"
    scope[name] = cls
    return name


def _stores(shape: Any, name: str, array: str, at: int = 0) -> list[str]:
    return [f"    {array}[{place}] = {source}" for place, source in enumerate(scalars(shape, name), start=at)]


def scalars(shape: Any, source: str) -> list[str]:
    """Return the expression of every scalar of ``shape``, which is called ``source``, in the order of ``variables``."""
    if not isinstance(shape, tuple):
        return [source]
    fields = getattr(shape, "_fields", None)
    names = [f".{field}" for field in fields] if fields else [f"[{place}]" for place in range(len(shape))]
    return [scalar for name, item in zip(names, shape, strict=True) for scalar in scalars(item, source + name)]
