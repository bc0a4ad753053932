"""Looks on while charts decide: which guards held in which state, at every sample of models run in process."""

import inspect
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from types import ModuleType
from typing import Any

from modelkit.model import Chart

Seen = Counter[tuple[int, int]]
"""(state, guards as bits) -> samples at which the chart decided on it."""
GUARDS = "guards"
"""Parameter of the function that decides; its first one is the state."""


def name_of(chart: Chart) -> str:
    """Return the module in which a chart is written: its name."""
    return chart.guards.__module__


@contextmanager
def tracing(charts: list[Chart]) -> Iterator[dict[str, Seen]]:
    """Yield name of a chart -> what it decides on, filled while models run in this process."""
    seen: dict[str, Seen] = {name_of(chart): Counter() for chart in charts}
    changed: list[tuple[ModuleType, str, Any]] = []
    try:
        for chart in charts:
            function = decider(chart)
            looking = _looking(function, seen[name_of(chart)])
            package = function.__module__.split(".")[0]
            for module in [item for name, item in sys.modules.items() if name.split(".")[0] == package]:
                for name in [key for key, value in vars(module).items() if value is function]:
                    changed.append((module, name, function))
                    setattr(module, name, looking)
        yield seen
    finally:
        for module, name, function in changed:
            setattr(module, name, function)


def decider(chart: Chart) -> Callable[..., Any]:
    """Return the function of a chart's module that decides: the one that takes ``guards``."""
    module = sys.modules[name_of(chart)]
    functions = [
        item for item in vars(module).values() if inspect.isfunction(item) and item.__module__ == module.__name__
    ]
    found = [item for item in functions if GUARDS in inspect.signature(item).parameters]
    assert len(found) == 1, f"{module.__name__} has {len(found)} functions that take {GUARDS}"
    return found[0]


def _looking(function: Callable[..., Any], seen: Seen) -> Callable[..., Any]:
    place = list(inspect.signature(function).parameters).index(GUARDS)

    @wraps(function)
    def looking(*arguments: Any) -> Any:
        seen[int(arguments[0]), int(arguments[place])] += 1
        return function(*arguments)

    return looking
