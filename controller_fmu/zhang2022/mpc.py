"""Front-wheel angle by linear time-varying MPC on the kinematic error model (Zhang 2022, section 3.1)."""

import math
from typing import NamedTuple

from controller_fmu.zhang2022.params import MpcParams
from controller_fmu.zhang2022.path import QuinticPath, Reference, at
from controller_fmu.zhang2022.qp import MAX_STAGES, Initial, Stages, Status, solve
from controller_fmu.zhang2022.qp_stage import HorizonStage, Weights
from modelkit.maths import clamp, is_finite

NO_STAGE = HorizonStage(0.0, 0.0, 0.0, 0.0, 0.0)
MIN_PREDICTION_SPEED = 0.2
"""Speed assumed where the car stands [m/s]: without motion nothing can be predicted."""


class FrontAxle(NamedTuple):
    """What the MPC knows of the car."""

    wheelbase: float
    angle_limit: float
    """Largest front-wheel angle [rad]."""
    rate_limit: float
    """Largest front-wheel rate [rad/s]."""


class FrontWheels(NamedTuple):
    """The front-wheel angle and where it is going."""

    angle: float = 0.0
    rate: float = 0.0
    """Held until the next solution [rad/s]."""
    status: int = 0
    iterations: int = 0


def steer(
    steering: FrontWheels, path: QuinticPath, reference: Reference, speed: float, car: FrontAxle, p: MpcParams
) -> FrontWheels:
    """Return the rate of the front-wheel angle until the next solution.

    The first increment of the optimal sequence, spread over a prediction step. Where the solver does
    not end well, the rate found last stays (within the limit) and the status says why.
    """
    angle = clamp(steering.angle, -car.angle_limit, car.angle_limit)
    stages = prediction(path, reference, speed, car, p)
    now = Initial(reference.lateral_error, reference.heading_error, angle)
    found = solve(now, stages, weights(car, p), p.tolerance, p.max_iterations)
    solved = found.status == Status.SOLVED and is_finite(found.nodes[0].u)
    rate = found.nodes[0].u / p.step_time if solved else steering.rate
    return FrontWheels(angle, clamp(rate, -car.rate_limit, car.rate_limit), found.status, found.iterations)


def turn_wheels(steering: FrontWheels, car: FrontAxle, dt: float) -> FrontWheels:
    """Return the steering ``dt`` [s] later at its present rate."""
    angle = clamp(steering.angle + steering.rate * dt, -car.angle_limit, car.angle_limit)
    return steering._replace(angle=angle)


def prediction(path: QuinticPath, reference: Reference, speed: float, car: FrontAxle, p: MpcParams) -> Stages:
    """Return the stages of the horizon, linearised where the car will be on the path at this speed (reverse)."""
    step = -max(MIN_PREDICTION_SPEED, -speed) * p.step_time
    x = reference.pose.x
    stages: Stages = (NO_STAGE,) * MAX_STAGES
    for number in range(MAX_STAGES):
        stages = stages[1:] + (_stage(path, x, step, number, car, p),)
        x = _onward(path, x, step)
    return stages


def _onward(path: QuinticPath, x: float, step: float) -> float:
    """Return x [m] a distance ``step`` (signed) further along the path."""
    slope = at(path, x).slope
    return x + step / math.sqrt(1.0 + slope * slope)


def _stage(path: QuinticPath, x: float, step: float, number: int, car: FrontAxle, p: MpcParams) -> HorizonStage:
    """Return one prediction step: psi' = v (delta - delta_r) / (L cos^2 delta_r), e' = v psi, held over the step."""
    half = at(path, _onward(path, x, 0.5 * step))
    r = clamp(math.atan(car.wheelbase * half.curvature), -car.angle_limit, car.angle_limit)
    cos = math.cos(r)
    g = step / (car.wheelbase * cos * cos)
    return HorizonStage(step, g, 0.5 * step * g, r, 1.0 if number < p.horizon else 0.0)


def weights(car: FrontAxle, p: MpcParams) -> Weights:
    """Return weights and limits of the QP."""
    return Weights(
        p.lateral,
        p.heading,
        p.angle,
        p.increment,
        p.slack_weight,
        p.corridor,
        car.angle_limit,
        car.rate_limit * p.step_time,
    )
