"""What the quintic, MPC and PID system found, for the log."""

from typing import Annotated, NamedTuple

from controller_fmu.zhang2022.path import PathStatus
from controller_fmu.zhang2022.qp import Status
from modelkit.signal import Signal


class ZhangSignals(NamedTuple):
    """What the system found."""

    path_status: Annotated[int, Signal("1", "whether there is a quintic path", states=PathStatus)] = 0
    largest_curvature: Annotated[float, Signal("1/m", "largest curvature of the path, or of the best one refused")] = (
        0.0
    )
    solver_status: Annotated[int, Signal("1", "how the QP solver ended", states=Status)] = 0
    iterations: Annotated[int, Signal("1", "iterations of the QP solver")] = 0
    reference_angle: Annotated[float, Signal("rad", "front-wheel angle of the path's curvature, left positive")] = 0.0
    set_speed: Annotated[float, Signal("m/s", "speed the PID holds, reverse negative")] = 0.0
