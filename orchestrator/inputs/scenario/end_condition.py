"""The condition that ends a run before its stop time: the only module that names final states of the controller."""

from pydantic import BaseModel, ConfigDict, Field

from modelkit.variables import Variable, variables
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.text.errors import BadInput, suggestion_or_choices
from orchestrator.inputs.text.quantities import NS_PER_SECOND, Seconds, Whole

SPEED = "vehicle.speed"
"""Signal with the speed of the vehicle [m/s]."""
OPTIONAL = ("FAILED", "TAKEOVER")
"""Default final states; a third-party controller need not have them."""
State = str | Whole
"""A state of a mode by its name or by its number."""


class EndCondition(BaseModel):
    """A run ends when the controller is in a final state and the vehicle has stood still for a time."""

    model_config = ConfigDict(extra="forbid")

    signal: str = "controller.phase"
    """Output with the state of the controller."""
    succeeded: list[State] = Field(default=["PARKED"], min_length=1)
    """Final states that report success."""
    failed: list[State] = ["FAILED"]
    """Final states that report failure."""
    ended: list[State] = ["TAKEOVER"]
    """Final states that report neither success nor failure."""
    reason: str = "controller.reason"
    """Output with the reason of a failure."""
    still: float = Field(default=1e-3, gt=0.0, allow_inf_nan=False)
    """Largest speed that counts as standstill [m/s]."""
    standstill: Seconds = 0.5
    """Required duration of the standstill [s]."""

    @property
    def standstill_ns(self) -> int:
        """Return how long the car must stand [ns]."""
        return round(self.standstill * NS_PER_SECOND)

    def final(self, mode: Variable | None = None) -> tuple[int, ...]:
        """Return the values in which a run is over; ``mode`` is the signal as its FMU declares it."""
        return tuple(self.values((*self.succeeded, *self.failed, *self.ended), mode))

    def values(self, states: list[State] | tuple[State, ...], mode: Variable | None = None) -> list[int]:
        """Return the numbers of ``states``. Raises ``BadInput`` for a name that the signal has not.

        An FMU may declare its mode as a plain integer, without names: those of our own controller are meant then.
        """
        numbers = {name: number for number, name in states_of(self.signal, mode).items()}
        found = []
        for state in states:
            word = state_word(state) if isinstance(state, str) else state
            if word in OPTIONAL and word not in numbers:
                continue
            if isinstance(word, str) and word not in numbers:
                hint = suggestion_or_choices(word, list(numbers))
                raise BadInput(f"{state!r} is no state of {self.signal}{hint}", key="stop_condition")
            found.append(numbers[word] if isinstance(word, str) else word)
        return found

    def text(self, state: State, mode: Variable | None = None) -> str:
        """Return a state for people: ``PARKED (9)``."""
        (number,) = self.values([state], mode)
        name = states_of(self.signal, mode).get(number, "")
        return f"{name} ({number})" if name else str(number)


def state_word(written: str) -> str:
    """Return the name of a state as models have it, from how people may write it: ``to q2`` is ``TO_Q2``."""
    return written.upper().replace(" ", "_").replace("-", "_")


def states_of(signal: str, declared: Variable | None = None) -> dict[int, str]:
    """Return value -> name of the states of a signal: as it is ``declared``, else as our own models have it."""
    if declared is not None and declared.signal.states is not None:
        return _members(declared)
    owner, _, name = signal.partition(".")
    model = MODELS.get(owner)
    outputs = [] if model is None else variables(model.outputs)
    return next((_members(item) for item in outputs if item.name == name and item.signal.states is not None), {})


def _members(mode: Variable) -> dict[int, str]:
    return {int(state): state.name for state in mode.signal.states or ()}
