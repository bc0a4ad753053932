"""A fault as a scenario states it: which signal is disturbed, how, and from when to when."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.quantities import Seconds, Until

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
    """``component.name`` of an input, or of an output: then all receivers get the disturbed value."""
    kind: Kind
    """Kind of disturbance; the page *Write a scenario* gives the received value of each."""
    start: Seconds = 0.0
    """Start of the fault [s]."""
    stop: Until = float("inf")
    """End of the fault [s], exclusive."""
    value: float | str | bool | None = None
    """override: received value; a number, ``nan``, a number with unit or the name of a state."""
    delay: Seconds | None = None
    """delay: age of the received value [s]."""
    sigma: float | str | None = None
    """noise: standard deviation, in the unit of the signal or with a unit."""
    probability: float = Field(default=1.0, ge=0.0, le=1.0)
    """dropout: probability that a sample is lost; the receiver keeps the previous value."""

    def check(self, file: object, key: str) -> None:
        """Raise ``BadInput`` if what its kind needs is missing, or its time is empty."""
        for need in NEEDS[self.kind]:
            if getattr(self, need) is None:
                raise BadInput(f"kind {self.kind} needs {need}", file=file, key=key)
        if self.stop <= self.start:
            raise BadInput(f"stop {self.stop:g} s is not after start {self.start:g} s", file=file, key=key)
