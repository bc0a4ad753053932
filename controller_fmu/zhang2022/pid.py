"""Drive force by PID on speed, equation (8) of Zhang 2022."""

from typing import NamedTuple

from controller_fmu.zhang2022.params import PidParams
from modelkit.maths import clamp


class PidState(NamedTuple):
    """Integral of the error, the last error, and the force that holds."""

    integral: float = 0.0
    last_error: float = 0.0
    started: bool = False
    force: float = 0.0


def pid(state: PidState, error: float, params: PidParams, dt: float) -> PidState:
    """Return the force u = Kp e + Ki int e + Kd de/dt [N], held to the limit, from e = v_e - v [m/s].

    The integral grows only while the force is inside its limit or the error drives it back there
    (conditional integration), so it does not wind up.
    """
    rate = (error - state.last_error) / dt if state.started else 0.0
    integral = state.integral + error * dt
    wanted = params.proportional * error + params.integral * integral + params.derivative * rate
    force = clamp(wanted, -params.limit, params.limit)
    if force != wanted and wanted * error > 0.0:
        integral = state.integral
        wanted = params.proportional * error + params.integral * integral + params.derivative * rate
        force = clamp(wanted, -params.limit, params.limit)
    return PidState(integral, error, True, force)
