"""Parameters of the collision monitor."""

from typing import Annotated, NamedTuple

from controller_fmu.common.params import HOUSE
from modelkit.signal import Signal


class MonitorParams(NamedTuple):
    """What the collision monitor keeps."""

    map_distance: Annotated[float, Signal("m", "distance to a mapped obstacle at standstill", 0.0, 1.0, HOUSE)] = 0.04
    echo_distance: Annotated[float, Signal("m", "distance to an unexplained echo at standstill", 0.0, 2.0, HOUSE)] = 0.3
    brake_delay: Annotated[float, Signal("s", "longest delay of the brake", 0.0, 2.0, HOUSE)] = 0.3
    brake_deceleration: Annotated[float, Signal("m/s2", "least deceleration of the brake", 0.1, 10.0, HOUSE)] = 1.5
    unexplained: Annotated[
        float, Signal("m", "an echo nearer than expected by this is unexplained", 0.01, 2.0, HOUSE)
    ] = 0.2
    corridor: Annotated[float, Signal("m", "lateral error above which it stops and replans", 0.01, 5.0, HOUSE)] = 0.1
    corridor_heading: Annotated[float, Signal("rad", "heading error above which it does so", 0.01, 1.5, HOUSE)] = 0.12
    over_speed: Annotated[float, Signal("m/s", "largest speed while parking: 5 km/h", 0.1, 10.0, HOUSE)] = 5.0 / 3.6
    over_speed_time: Annotated[float, Signal("s", "time above over_speed that is a fault", 0.0, 10.0, HOUSE)] = 0.3
    wait: Annotated[float, Signal("s", "time for which it waits for an obstacle to leave", 0.0, 600.0, HOUSE)] = 10.0
