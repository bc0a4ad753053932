"""What a study may vary, as factors: a point of the unit cube stands for the values of a run."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from modelkit.signal import Signal
from orchestrator.simulation.cosim.fmu_instance import Array

Seeds = NDArray[np.int64]


class Factor(NamedTuple):
    """One thing that may differ from run to run, evenly spread over its range or over its choices."""

    name: str
    unit: str
    low: float
    nominal: float
    """The value that disturbs least."""
    high: float
    text: str
    choices: Sequence[str] = ()
    """Names of the values 0, 1, 2 ..., if it has but these."""

    @property
    def signal(self) -> Signal:
        """Return unit, meaning and range."""
        return Signal(self.unit, self.text, self.low, self.high)

    def mild(self) -> "Factor":
        """Return the factor with half the range, about its nominal value; choices stay."""
        if self.choices:
            return self
        low, high = (self.nominal + 0.5 * (end - self.nominal) for end in (self.low, self.high))
        return self._replace(low=low, high=high)

    def at(self, share: Array) -> Array:
        """Return the values at ``share`` (0 to 1) of the range."""
        if self.choices:
            return np.minimum(np.floor(share * len(self.choices)), len(self.choices) - 1)
        return self.low + share * (self.high - self.low)

    def share(self, value: float) -> float:
        """Return where in its range a value is, 0 to 1: what :meth:`at` takes."""
        if self.choices:
            return (value + 0.5) / len(self.choices)
        return (value - self.low) / (self.high - self.low)


class Space(NamedTuple):
    """All factors of a study, and what they mean."""

    factors: Sequence[Factor]
    place: Callable[[Mapping[str, Array], Seeds], Array]
    """(values of the factors by name, seeds of the runs) -> a line of the design for each run."""

    def values(self, shares: Array, seeds: Seeds) -> Array:
        """Return the lines of a design at points (n, factors) of the unit cube."""
        return self.place(self.values_by_name(shares), seeds)

    def values_by_name(self, shares: Array) -> dict[str, Array]:
        """Return the values of the factors at points of the unit cube, by name."""
        return {factor.name: factor.at(column) for factor, column in zip(self.factors, shares.T, strict=True)}

    def with_fixed(self, shares: Array, values: Mapping[str, float]) -> Array:
        """Return points (n, factors) of the unit cube at which the factors named have the ``values``."""
        places = {factor.name: place for place, factor in enumerate(self.factors)}
        fixed = shares.copy()
        for name, value in values.items():
            fixed[:, places[name]] = self.factors[places[name]].share(value)
        return fixed

    def nominal(self) -> Array:
        """Return the point of the unit cube at which nothing is disturbed."""
        return np.array([factor.share(factor.nominal) for factor in self.factors])
