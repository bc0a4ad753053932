"""What the system recognised and which rule it followed, for the log."""

from typing import Annotated, NamedTuple

from controller_fmu.hsic.characteristic_states import Characteristic, HsicStage
from controller_fmu.hsic.rules import SpeedMode, SteerMode
from modelkit.signal import Signal


class HsicSignals(NamedTuple):
    """What the system recognised and which rule it followed."""

    characteristic: Annotated[int, Signal("1", "characteristic state", states=Characteristic)] = 0
    stage: Annotated[int, Signal("1", "stage of the parking manoeuvre", states=HsicStage)] = 0
    speed_mode: Annotated[int, Signal("1", "control mode of the speed", states=SpeedMode)] = 0
    steer_mode: Annotated[int, Signal("1", "control mode of the steering", states=SteerMode)] = 0
    distance: Annotated[float, Signal("m", "distance to the key point")] = 0.0
    tangent_error: Annotated[float, Signal("m", "distance to the left of the common tangent P2 P3, slot frame")] = 0.0
