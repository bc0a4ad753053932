"""A fault as a scenario states it: which signal is disturbed, how, and from when to when."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from orchestrator.text.errors import BadInput
from orchestrator.text.quantities import Seconds, Until

Kind = Literal["stuck_at_last", "override", "dropout", "delay", "noise"]
NEEDS: dict[str, tuple[str, ...]] = {
    "stuck_at_last": (),
    "override": ("value",),
    "dropout": ("probability",),
    "delay": ("delay",),
    "noise": ("sigma",),
}


class Fault(BaseModel):
    """One disturbance of one signal, or of a group of signals such as ``vehicle.odometry``."""

    model_config = ConfigDict(extra="forbid")

    signal: str
    """``slave.name`` of an output (its receivers are disturbed) or of an input."""
    kind: Kind
    """What the receiver sees instead: an old value, a given one, a late one, a noisy one, now and then none."""
    start: Seconds = 0.0
    """From this time on [s]."""
    stop: Until = float("inf")
    """Until before this time [s]."""
    value: float | str | bool | None = None
    """override: the value seen instead; a number, ``nan``, a quantity or the name of a state."""
    delay: Seconds | None = None
    """delay: age of the value seen [s]."""
    sigma: float | str | None = None
    """noise: standard deviation, in the unit of the signal or with its own."""
    probability: float = Field(default=1.0, ge=0.0, le=1.0)
    """dropout: chance that an exchange is lost; the receiver keeps the value before."""

    def check(self, file: object, key: str) -> None:
        """Raise ``BadInput`` if what its kind needs is missing, or its time is empty."""
        for need in NEEDS[self.kind]:
            if getattr(self, need) is None:
                raise BadInput(f"kind {self.kind} needs {need}", file=file, key=key)
        if self.stop <= self.start:
            raise BadInput(f"stop {self.stop:g} s is not after start {self.start:g} s", file=file, key=key)
