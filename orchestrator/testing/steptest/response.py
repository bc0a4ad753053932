"""The numbers of a step response, as control engineers have them.

``start`` is where the value is when the step comes, ``goal`` where it shall go; shares are of the way between.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array


class Response(NamedTuple):
    """A signal after a step: times from the step on [s], values, where it shall go, and the band called settled."""

    t: Array
    values: Array
    goal: float
    band: float
    """Fraction of the step."""

    @property
    def progress(self) -> Array:
        """Share of the way that is done."""
        way = self.goal - self.values[0]
        return (self.values - self.values[0]) / way if way != 0.0 else np.ones(len(self.values))


def rise_time(response: Response) -> float:
    """Return the time from 10 % to 90 % of the way [s], between samples by a straight line; infinite if it never is."""
    first, last = _crossing(response, 0.1), _crossing(response, 0.9)
    return last - first if np.isfinite(last) else np.inf


def settling_time(response: Response) -> float:
    """Return the time after which the value stays in the band around the goal [s]; infinite if it does not."""
    outside = np.flatnonzero(np.abs(response.progress - 1.0) > response.band)
    if len(outside) == 0:
        return 0.0
    after = int(outside[-1]) + 1
    return float(response.t[after] - response.t[0]) if after < len(response.t) else np.inf


def overshoot(response: Response) -> float:
    """Return how far the value goes beyond the goal, as a fraction of the step."""
    return max(0.0, float(np.max(response.progress)) - 1.0)


def steady_state_error(response: Response) -> float:
    """Return the distance from the goal over the last tenth of the time, on average [unit of the signal]."""
    tail = response.values[-max(1, len(response.values) // 10) :]
    return float(np.mean(tail) - response.goal)


def _crossing(response: Response, share: float) -> float:
    done, t = response.progress, response.t
    row = int(np.argmax(done >= share))
    if done[row] < share:
        return np.inf
    if row == 0:
        return float(t[0])
    part = (share - done[row - 1]) / (done[row] - done[row - 1])
    return float(t[row - 1] + part * (t[row] - t[row - 1]))


class ResponseMeasure(NamedTuple):
    """A number of a response: how it is found, its unit (empty: the signal's), what it is."""

    of: Callable[[Response], float]
    unit: str
    text: str


RESPONSES = {
    "rise_time": ResponseMeasure(rise_time, "s", "from 10 % to 90 % of the way"),
    "settling_time": ResponseMeasure(settling_time, "s", "until it stays in the band around the goal"),
    "overshoot": ResponseMeasure(overshoot, "1", "beyond the goal, share of the way"),
    "steady_state_error": ResponseMeasure(steady_state_error, "", "from the goal, mean of the last tenth of the time"),
}
"""Word -> number of a step response."""
