"""CommonRoad's three cars as parameters of our bodies, and their multi-body model at rest in a turn."""

import math
from typing import Any

import numpy as np
from scipy.optimize import root
from vehiclemodels.init_mb import init_mb
from vehiclemodels.parameters_vehicle1 import parameters_vehicle1
from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
from vehiclemodels.parameters_vehicle3 import parameters_vehicle3
from vehiclemodels.vehicle_dynamics_mb import vehicle_dynamics_mb

from vehicle_fmu.bodies.chassis import ChassisParams, Stance
from vehicle_fmu.bodies.double_track import DoubleTrackParams
from vehicle_fmu.bodies.loads import RollParams
from vehicle_fmu.bodies.single_track import SingleTrackParams
from vehicle_fmu.bodies.tires import TireParams
from vehicle_fmu.bodies.wheels import HubParams

CARS: tuple[Any, ...] = (parameters_vehicle1(), parameters_vehicle2(), parameters_vehicle3())


def roll_of_axle(spring: float, torsion: float, track: float, tire: float, camber: float) -> tuple[float, float]:
    """Return roll stiffness of suspension and tyres in series [N m/rad] and camber over roll angle."""
    suspension = 0.5 * track**2 * spring - torsion
    tires = 0.5 * track**2 * tire
    both = suspension * tires / (suspension + tires)
    return both, 1.0 + camber * track / 2.0 * both / suspension


def double_track_car(car: Any) -> tuple[Stance, ChassisParams, DoubleTrackParams]:
    """Return stance, chassis and four-wheel body with CommonRoad's numbers; no drag, parallel steering."""
    front, lean_front = roll_of_axle(car.K_sf, car.K_tsf, car.T_f, car.K_zt, car.D_f)
    rear, lean_rear = roll_of_axle(car.K_sr, car.K_tsr, car.T_r, car.K_zt, car.D_r)
    chassis = ChassisParams(car.m, car.I_z, car.h_cg, 0.0, 0.0, 0.0, car.T_se, car.T_sb)
    roll = RollParams(car.m_s * car.h_s / car.m, front, rear, lean_front, lean_rear, car.m_uf, car.m_ur)
    hub = HubParams(car.R_w, car.I_y_w)
    return Stance(car.a + car.b, car.b), chassis, DoubleTrackParams(car.T_f, car.T_r, 0.0, hub, roll, TireParams())


def single_track_car(car: Any) -> tuple[Stance, ChassisParams, SingleTrackParams]:
    """Return stance, chassis and the single track that is CommonRoad's ST."""
    wheelbase = car.a + car.b
    per_load = -car.tire.p_ky1 * 9.81 * car.m / wheelbase
    chassis = ChassisParams(car.m, car.I_z, car.h_s, 0.0, 0.0, 0.0, 0.0, 0.5)
    return (
        Stance(wheelbase, car.b),
        chassis,
        SingleTrackParams(per_load * car.b, per_load * car.a, car.h_s, 3.0, 0.3, True),
    )


def multi_body_yaw_rate(car: Any, speed: float, angle: float) -> float:
    """Return the steady yaw rate [rad/s] of CommonRoad's MB, by Newton's method along growing angles.

    Raises ``ValueError`` if the model has no steady state there.
    """
    unknown: Any = None
    for delta in np.linspace(angle / 10.0, angle, 10):
        if unknown is None:
            core = [0.0, 0.0, delta, speed, 0.0, speed * math.tan(delta) / (car.a + car.b), 0.0]
            unknown = np.append(np.array(init_mb(core, car), float)[5:], 0.0)
        unknown = root(_residual, unknown, (car, speed, delta), tol=1e-12).x
    if np.max(np.abs(_residual(unknown, car, speed, angle))) > 1e-6:
        raise ValueError(f"no steady state at {speed} m/s, {angle} rad")
    return float(unknown[0])


def _residual(unknown: Any, car: Any, speed: float, angle: float) -> Any:
    state = [0.0, 0.0, angle, speed, 0.0, *unknown[:-1]]
    rates = np.array(vehicle_dynamics_mb(state, [0.0, float(unknown[-1])], car))
    return np.append(rates[3], rates[5:])
