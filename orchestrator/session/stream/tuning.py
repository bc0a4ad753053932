"""Parameters changed from outside while a run goes on: tunable ones, within their range, between two steps."""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol, runtime_checkable

from modelkit.model import Model
from modelkit.signal import Role
from modelkit.variables import Variable, limits_of, variables
from orchestrator.simulation.cosim.algorithm import Termination
from orchestrator.simulation.cosim.fmu_instance import FmuInstance
from orchestrator.simulation.cosim.mode_changes import INFO


@runtime_checkable
class TakesValues(Protocol):
    """An instance whose tunable parameters can be changed between two steps."""

    def tune(self, name: str, value: float) -> None:
        """Give a parameter another value. Raises ``RunError`` if the model refuses."""


class _Wish(NamedTuple):
    name: str
    value: float
    by: str
    """Who wants it."""


class Tuning:
    """Observer that gives the models the values requested since the last exchange, and logs them."""

    def __init__(
        self, instances: Sequence[FmuInstance], models: Mapping[str, Model], say: Callable[[int, int, str, str], None]
    ) -> None:
        self._say = say
        self._wishes: deque[_Wish] = deque()
        self._known: dict[str, tuple[FmuInstance, Variable]] = {}
        self.reported: list[dict[str, Any]] = []
        """What was changed, and when."""
        for instance in instances:
            model = models.get(instance.name)
            if model is not None and isinstance(instance, TakesValues):
                shown = [item for item in variables(model.params) if item.name in instance.parameters.index]
                tunable = [item for item in shown if Role.TUNABLE in item.roles]
                self._known |= {f"{instance.name}.{item.name}": (instance, item) for item in tunable}

    def values(self) -> dict[str, float | int | bool]:
        """Return all that can be changed with its value now, or as it will be at the next exchange."""
        asked = {wish.name: wish.value for wish in list(self._wishes)}
        return {
            name: item.kind(asked.get(name, instance.parameters.values[instance.parameters.index[item.name]]))
            for name, (instance, item) in self._known.items()
        }

    def ask(self, name: str, value: object, by: str) -> str:
        """Note a wish, from any thread; return why it is refused, empty if it is not."""
        if name not in self._known:
            return f"{name} cannot be changed during a run"
        _, item = self._known[name]
        low, high = limits_of(item.signal)
        if not isinstance(value, int | float) or not low <= float(value) <= high:
            unit = "" if item.signal.unit == "1" else f" {item.signal.unit}"
            return f"{name}: {value} is not within {low:g} to {high:g}{unit}"
        if item.kind is not float and float(value) != int(value):
            return f"{name}: {value} is no whole number"
        self._wishes.append(_Wish(name, float(value), by))
        return ""

    def on_communication_point(self, t_ns: int) -> None:
        """Change what was asked for; it holds from the step after this exchange on."""
        while self._wishes:
            wish = self._wishes.popleft()
            instance, item = self._known[wish.name]
            assert isinstance(instance, TakesValues)
            instance.tune(item.name, wish.value)
            instance.parameters.values[instance.parameters.index[item.name]] = wish.value
            self.reported.append({"t": t_ns / 1e9, "name": wish.name, "value": wish.value, "by": wish.by})
            self._say(t_ns, INFO, "tuning", f"{wish.name} = {wish.value:g} from here on, set by {wish.by}")

    def on_terminate(self, end: Termination) -> None:
        """Nothing to close."""
