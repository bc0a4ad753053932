"""Wheel loads of a car that leans: quasi-static pitch and roll, with a lag.

    pitch:  dF_z per axle = m a_x h / L
    roll:   phi = m a_y h_r / (K_f + K_r - m g h_r)
            dF_z (front) T_f = K_f phi + (b / L) m a_y (h - h_r), rear alike

h_r is the arm of the sprung mass about the roll axis, K_f and K_r the roll stiffnesses of
suspension and tyres in series. a_x and a_y are the tyres' forces over the mass (what an
accelerometer shows: on a slope too), lagged by the time springs and dampers take. A wheel that
would pull on the road lifts, and its neighbour carries the axle.
"""

from typing import Annotated, NamedTuple

from modelkit.maths import clamp
from modelkit.signal import Signal
from vehicle_fmu.bodies.chassis import CHOSEN, GRAVITY_ACCELERATION, ChassisParams, Stance


class RollParams(NamedTuple):
    """How the body leans and what that does to loads and wheels."""

    arm: Annotated[
        float, Signal("m", "sprung mass's arm about the roll axis, times its share of the mass", 0.0, 3.0, CHOSEN)
    ] = 0.45
    stiffness_front: Annotated[float, Signal("N.m/rad", "roll stiffness of the front axle", 1.0, 1e7, CHOSEN)] = 30000.0
    stiffness_rear: Annotated[float, Signal("N.m/rad", "roll stiffness of the rear axle", 1.0, 1e7, CHOSEN)] = 22000.0
    camber_front: Annotated[float, Signal("1", "front camber into the turn over roll angle", -2.0, 2.0, CHOSEN)] = 0.0
    camber_rear: Annotated[float, Signal("1", "rear camber into the turn over roll angle", -2.0, 2.0, CHOSEN)] = 0.0
    unsprung_front: Annotated[float, Signal("kg", "mass that stands on the front axle itself", 0.0, 1e4, CHOSEN)] = 0.0
    unsprung_rear: Annotated[float, Signal("kg", "mass that stands on the rear axle itself", 0.0, 1e4, CHOSEN)] = 0.0
    lag: Annotated[float, Signal("s", "lag of the load transfer", 0.0, 2.0, CHOSEN)] = 0.05


class Loads(NamedTuple):
    """Vertical forces, and the lean they come with."""

    wheels: tuple[float, float, float, float]
    """Front left, front right, rear left, rear right [N]."""
    roll: float
    """Roll angle [rad], positive out of a left turn."""


class Felt(NamedTuple):
    """Acceleration the springs have felt, lagged [m/s2]."""

    x: float = 0.0
    y: float = 0.0


def feel(felt: Felt, x: float, y: float, lag: float, h: float) -> Felt:
    """Return the lagged acceleration [m/s2] ``h`` [s] later, backward Euler."""
    share = h / (lag + h)
    return Felt(felt.x + share * (x - felt.x), felt.y + share * (y - felt.y))


def wheel_loads(
    felt: Felt, normal: float, stance: Stance, tracks: tuple[float, float], p: ChassisParams, roll: RollParams
) -> Loads:
    """Return the loads [N] at the accelerations felt; ``normal`` is gravity into the road [m/s2]."""
    wheelbase = stance.wheelbase
    weight = p.mass * normal
    pitch = clamp(p.mass * felt.x * p.cg_height / wheelbase, -weight, weight)
    sprung = weight - normal * (roll.unsprung_front + roll.unsprung_rear)
    front = clamp(sprung * stance.cg_to_rear / wheelbase + normal * roll.unsprung_front - pitch, 0.0, weight)
    rear = weight - front
    stiffness = max(1.0, roll.stiffness_front + roll.stiffness_rear - p.mass * GRAVITY_ACCELERATION * roll.arm)
    angle = clamp(p.mass * felt.y * roll.arm / stiffness, -0.5, 0.5)
    direct = p.mass * felt.y * (p.cg_height - roll.arm) / wheelbase
    shift_front = (roll.stiffness_front * angle + direct * stance.cg_to_rear) / tracks[0]
    shift_rear = (roll.stiffness_rear * angle + direct * (wheelbase - stance.cg_to_rear)) / tracks[1]
    shift_front = clamp(shift_front, -0.5 * front, 0.5 * front)
    shift_rear = clamp(shift_rear, -0.5 * rear, 0.5 * rear)
    return Loads(
        (0.5 * front - shift_front, 0.5 * front + shift_front, 0.5 * rear - shift_rear, 0.5 * rear + shift_rear), angle
    )
