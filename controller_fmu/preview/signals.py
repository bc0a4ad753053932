"""What the preview system saw and chose, for the log."""

from typing import Annotated, NamedTuple

from controller_fmu.preview.stage import PreviewStage
from modelkit.signal import Signal


class PreviewSignals(NamedTuple):
    """What the preview system saw and chose."""

    s: Annotated[float, Signal("m", "arc length of the car along the road")] = 0.0
    stage: Annotated[int, Signal("1", "stage of the preview sequence", states=PreviewStage)] = 0
    l1: Annotated[float, Signal("m", "first preview distance")] = 0.0
    l2: Annotated[float, Signal("m", "second preview distance")] = 0.0
    kappa1: Annotated[float, Signal("1/m", "road curvature at the first preview point")] = 0.0
    kappa2: Annotated[float, Signal("1/m", "road curvature at the second preview point")] = 0.0
    y_l: Annotated[float, Signal("m", "lateral error at the first preview point, road to the left positive")] = 0.0
    eps_l: Annotated[float, Signal("rad", "heading error at the first preview point, road turning left positive")] = 0.0
    wanted_speed: Annotated[float, Signal("m/s", "speed set by the sequence")] = 0.0
