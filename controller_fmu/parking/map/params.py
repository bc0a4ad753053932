"""Parameters of the map: sensor noise, odometry error, gates, confirmation and deletion; how cars stand in rows."""

from typing import Annotated, NamedTuple

from controller_fmu.common.params import HOUSE
from modelkit.signal import Signal

CAR_LENGTH = 4.4
CAR_LENGTH_SIGMA = 0.5
CAR_WIDTH = 1.8
CAR_WIDTH_SIGMA = 0.2
"""Passenger cars (ISO 16787 test vehicles and what is sold): length and width [m], standard deviations."""
BAY_WIDTH = 2.6
BAY_SIGMA = 0.3
"""Bays of car parks are 2.3 to 2.9 m wide, cars beside a road stand 0.4 to 1.2 m apart: mean, standard deviation."""


class MappingParams(NamedTuple):
    """What the estimator assumes about sensors and odometry."""

    range_noise: Annotated[float, Signal("m", "standard deviation of an echo", 1e-4, 1.0, HOUSE)] = 0.01
    distance_variance: Annotated[
        float, Signal("m", "odometry error along the path, variance per metre: 0.4 % over 10 m", 0.0, 1.0, HOUSE)
    ] = 1.6e-4
    heading_variance: Annotated[
        float, Signal("1/m", "odometry heading drift, variance per metre: 0.25 deg over 10 m", 0.0, 1.0, HOUSE)
    ] = 1.9e-6
    gate: Annotated[float, Signal("1", "innovation gate, chi-square of 1 degree of freedom", 1.0, 100.0, HOUSE)] = 9.0
    confirmations: Annotated[int, Signal("1", "updates that confirm a landmark", 1, 100, HOUSE)] = 5
    contradictions: Annotated[int, Signal("1", "missed echoes in a row that delete a landmark", 1, 100, HOUSE)] = 5
