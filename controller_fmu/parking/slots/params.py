"""Parameters of the slot search."""

from typing import Annotated, NamedTuple

from controller_fmu.common.external_slot import SlotKind
from controller_fmu.common.params import HOUSE
from modelkit.signal import Signal

GBT = "GB/T 41630"


class SlotParams(NamedTuple):
    """What a slot must be, and where the vehicle stands in it."""

    wanted: Annotated[
        int, Signal("1", "requested slot type; none: by the row, tail in unless the slot leads on", states=SlotKind)
    ] = SlotKind.NONE
    open_ended: Annotated[bool, Signal("1", "accepts a perpendicular slot with one neighbour, passed first")] = False
    room_along: Annotated[float, Signal("m", "parallel slot: length beyond the vehicle's", 0.2, 10.0, HOUSE)] = 0.5
    room_across: Annotated[float, Signal("m", "perpendicular slot: width beyond the vehicle's", 0.2, 10.0, HOUSE)] = 0.4
    stand_out: Annotated[float, Signal("m", "largest overhang beyond the neighbours' line", 0.0, 3.0, GBT)] = 0.15
    confidence: Annotated[
        float, Signal("1", "standard deviations of the slot by which a parked pose is within limits", 0.0, 6.0, HOUSE)
    ] = 2.0
    distance_behind: Annotated[
        float, Signal("m", "distance to a slot's end: the monitor's and two standard deviations", 0.05, 2.0, HOUSE)
    ] = 0.08
    least_behind: Annotated[float, Signal("m", "least distance to a slot's end: the monitor's", 0.0, 2.0, HOUSE)] = 0.04
    kerb_min: Annotated[
        float, Signal("m", "least distance to a kerb beside: 5 cm, and 5 cm for errors", 0.0, 1.0, GBT)
    ] = 0.1
    kerb_max: Annotated[
        float, Signal("m", "largest distance to a kerb beside: 35 cm, less 5 cm for errors", 0.0, 1.0, GBT)
    ] = 0.3
    speed: Annotated[float, Signal("m/s", "largest speed of the search", 0.1, 10.0, HOUSE)] = 10.0 / 3.6
    distance: Annotated[float, Signal("m", "longest distance searched", 1.0, 1000.0, HOUSE)] = 60.0
    confirm_time: Annotated[float, Signal("s", "longest wait for the confirmation", 0.1, 3600.0, HOUSE)] = 60.0
