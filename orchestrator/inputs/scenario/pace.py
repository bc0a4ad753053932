"""How long a run may take where its scenario does not say: longer than the controller allows the parking itself."""

import numpy as np
from numpy.typing import NDArray

from modelkit.variables import variables
from orchestrator.inputs.scenario.models import MODELS

Array = NDArray[np.float64]
DURATION = "limit.duration"
"""The controller's own limit on the time of a parking [s]; below ``TIMED_SPEED`` it counts by distance."""
TIMED_SPEED = 0.3
"""The controllers count slower driving by distance [m/s]."""
UNLIMITED = next(float(item.start) for item in variables(MODELS["controller"].params) if item.name == DURATION)
"""Taken for a controller without such a limit."""
STOPPING_TIME = 5.0
"""Time [s] for the vehicle to stop after the controller has failed."""
MAX_STOP_TIME = 3600.0
"""Most [s] for the slowest driver, unless the controller's limit is longer."""
SPEED_ERROR = "driver.speed_error"
NAMES = tuple(
    item.name
    for item in variables(MODELS["vehicle"].params)
    if item.name == SPEED_ERROR or (item.name.startswith("driver.profile[") and item.name.endswith(".speed"))
)
"""The parameters of our vehicle that say how fast the driver drives."""
DEFAULTS = {item.name: float(item.start) for item in variables(MODELS["vehicle"].params) if item.name in NAMES}


def stop_times(parameters: dict[str, Array], durations: Array) -> Array:
    """Return the stop time [s] of each run, (runs,).

    From the driver's speeds [m/s] by name (``NAMES``) and the controller's limits on the time of a parking [s], (runs,)
    each. A driver slower than ``TIMED_SPEED`` has as far to go as one at ``TIMED_SPEED``, as the controller counts it.
    """
    speeds = np.column_stack([values for name, values in parameters.items() if name != SPEED_ERROR])
    slowest = np.where(speeds > 0.0, speeds, np.inf).min(axis=1)
    slowest = slowest * (1.0 + np.minimum(0.0, parameters[SPEED_ERROR]))
    with np.errstate(divide="ignore"):
        times = np.where(slowest > 0.0, durations * np.maximum(1.0, TIMED_SPEED / slowest), durations)
    return np.minimum(times, np.maximum(MAX_STOP_TIME, durations)) + STOPPING_TIME
