"""Which parameters can be identified, and how accurately each has to be known to be of use."""

from collections.abc import Mapping
from typing import NamedTuple

from modelkit.variables import Variable
from orchestrator.inputs.text.errors import BadInput, suggestion_or_choices
from orchestrator.studies.identification.compiled_vehicle import PARAMETERS

PRIOR_RANGE = 20.0
"""Standard deviation of a parameter before the drive, in useful accuracies: it keeps the solution finite."""
RELATIVE_ACCURACY = 0.05
"""Useful accuracy of a parameter without one of its own, relative to its value."""
ABSOLUTE_ACCURACY = {
    "steering.dead_time": 0.02,
    "steering.lag": 0.02,
    "steering.backlash": 0.03,
    "drive.drive_lag": 0.02,
    "drive.brake_lag": 0.02,
    "odometry.radius_error": 0.005,
    "odometry.steering_offset": 0.003,
}
"""Parameter -> half width of the 95 % interval at which it counts as identified [its unit]."""
STEERING_ACTUATOR = ("steering.dead_time", "steering.lag")
ODOMETRY = ("odometry.radius_error", "odometry.steering_offset")
GEOMETRY = ("car.wheelbase", "car.steering.ratio")
DRIVE = ("drive.drive_lag",)
"""Of a body with mass."""


class FitParameter(NamedTuple):
    """A parameter to identify."""

    variable: Variable
    start: float
    """Value to start the search from."""
    accuracy: float
    """Half width of the 95 % interval at which it counts as identified [its unit]."""

    @property
    def name(self) -> str:
        """Return its name."""
        return self.variable.name

    @property
    def bounds(self) -> tuple[float, float]:
        """Return the smallest and the largest value the model allows."""
        return self.variable.signal.low, self.variable.signal.high


def candidate(name: str, values: Mapping[str, float]) -> FitParameter:
    """Return a parameter to identify, starting from ``values`` or the default. Raises ``BadInput``."""
    variable = PARAMETERS.get(name.removeprefix("vehicle."))
    if variable is None:
        raise BadInput(f"no such parameter of the vehicle{suggestion_or_choices(name, PARAMETERS)}", key="--fit")
    if variable.kind is not float:
        raise BadInput(f"{variable.name} is no real number, so it cannot be identified", key="--fit")
    start = float(values.get(variable.name, variable.start))
    low, high = variable.signal.low, variable.signal.high
    accuracy = ABSOLUTE_ACCURACY.get(variable.name, RELATIVE_ACCURACY * abs(start))
    if accuracy == 0.0:
        accuracy = RELATIVE_ACCURACY * (min(high, 1.0) - max(low, -1.0))
    if start <= low:
        start = low + accuracy  # at the bound the search would begin with one-sided differences
    return FitParameter(variable, start, accuracy)
