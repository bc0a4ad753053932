"""How long a run may take where its scenario does not say: a slow driver has as much time as the way needs."""

import numpy as np
from numpy.typing import NDArray

from modelkit.variables import variables
from orchestrator.scenario.models import MODELS

Array = NDArray[np.float64]
SHORTEST = 60.0
"""Stop time [s] for drivers of an ordinary pace."""
WAY = 30.0
"""Way [m] that the slowest speed of the driver's profile has time for: twice that of parking in three moves."""
LONGEST = 3600.0
SPEED_ERROR = "driver.speed_error"
NAMES = tuple(
    item.name
    for item in variables(MODELS["vehicle"].params)
    if item.name == SPEED_ERROR or (item.name.startswith("driver.profile[") and item.name.endswith(".speed"))
)
"""The parameters of our vehicle that say how fast the driver drives."""
DEFAULTS = {item.name: float(item.start) for item in variables(MODELS["vehicle"].params) if item.name in NAMES}


def stop_times(parameters: dict[str, Array]) -> Array:
    """Return the stop time [s] of each run from the driver's speeds [m/s] by name (``NAMES``), (runs,) each.

    Long enough for ``WAY`` at the slowest speed of the profile that is not zero, and at least ``SHORTEST``.
    """
    speeds = np.column_stack([values for name, values in parameters.items() if name != SPEED_ERROR])
    slowest = np.where(speeds > 0.0, speeds, np.inf).min(axis=1)
    slowest = slowest * (1.0 + np.minimum(0.0, parameters[SPEED_ERROR]))
    with np.errstate(divide="ignore"):
        return np.clip(np.where(slowest > 0.0, WAY / slowest, SHORTEST), SHORTEST, LONGEST)
