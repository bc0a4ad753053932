"""Tyres: Magic Formula with combined slip, a brush of carcass springs in front of it.

Slip is that of a wheel rolling in its own direction: kappa = (R omega - V_x) / V and
s_y = -V_y / V, with V the larger of |V_x| and |R omega|, so that a force has the sign of its slip.

    pure:      F = D sin(C atan(B s - E (B s - atan(B s)))),  D = mu F_z,  B C D = K F_z
    combined:  F_x G(alpha),  F_y G(kappa),  G = cos(C atan(B s - E (B s - atan(B s))))

with B = B_1 / sqrt(1 + (B_2 s)^2) of the other slip (Pacejka, Tyre and Vehicle Dynamics,
chapter 4; PAC2002). All shifts are left out, for they would push a car at rest and make left
differ from right; camber comes in as a shift of the slip angle and as thrust, both odd in camber.

Slip follows over a relaxation length (Pacejka, chapter 7: stretched string): see ``relax``.
"""

import math
from typing import Annotated, NamedTuple

from modelkit.maths import clamp
from modelkit.signal import Signal

ADAMS = "ADAMS handbook, PAC2002 example tyre, as in CommonRoad vehicle models 3.0.2"
CHOSEN = "chosen, usual for passenger cars"
LARGEST_SLIP = 1.0
"""A carcass deflects by at most this slip times the relaxation length; forces are flat there."""


class TireParams(NamedTuple):
    """Magic Formula of one tyre; letters as in the module's equations."""

    shape_x: Annotated[float, Signal("1", "C, longitudinal", 1.0, 2.0, ADAMS + ", PCX1")] = 1.6411
    friction_x: Annotated[float, Signal("1", "mu, longitudinal", 0.01, 3.0, ADAMS + ", PDX1")] = 1.1739
    curvature_x: Annotated[float, Signal("1", "E, longitudinal", -10.0, 1.0, ADAMS + ", PEX1")] = 0.46403
    stiffness_x: Annotated[float, Signal("1", "K, slip stiffness over load", 1.0, 100.0, ADAMS + ", PKX1")] = 22.303
    shape_y: Annotated[float, Signal("1", "C, lateral", 1.0, 2.0, ADAMS + ", PCY1")] = 1.3507
    friction_y: Annotated[float, Signal("1", "mu, lateral", 0.01, 3.0, ADAMS + ", PDY1")] = 1.0489
    curvature_y: Annotated[float, Signal("1", "E, lateral", -10.0, 1.0, ADAMS + ", PEY1")] = -0.0074722
    stiffness_y: Annotated[float, Signal("1", "K, cornering stiffness over load", 1.0, 100.0, ADAMS + ", PKY1")] = 21.92
    combined_x_slope: Annotated[float, Signal("1", "B_1 of G(alpha)", 0.0, 100.0, ADAMS + ", RBX1")] = 13.276
    combined_x_fade: Annotated[float, Signal("1", "B_2 of G(alpha), times kappa", 0.0, 100.0, ADAMS + ", RBX2")] = 13.778
    combined_x_shape: Annotated[float, Signal("1", "C of G(alpha)", 0.0, 2.0, ADAMS + ", RCX1")] = 1.2568
    combined_x_curvature: Annotated[float, Signal("1", "E of G(alpha)", -10.0, 1.0, ADAMS + ", REX1")] = 0.65225
    combined_y_slope: Annotated[float, Signal("1", "B_1 of G(kappa)", 0.0, 100.0, ADAMS + ", RBY1")] = 7.1433
    combined_y_fade: Annotated[float, Signal("1", "B_2 of G(kappa), times alpha", 0.0, 100.0, ADAMS + ", RBY2")] = 9.1916
    combined_y_shape: Annotated[float, Signal("1", "C of G(kappa)", 0.0, 2.0, ADAMS + ", RCY1")] = 1.0719
    combined_y_curvature: Annotated[float, Signal("1", "E of G(kappa)", -10.0, 1.0, ADAMS + ", REY1")] = -0.27572
    camber_friction: Annotated[float, Signal("1", "gain of mu with camber squared", -10.0, 10.0, ADAMS + ", -PDY3")] = 2.8821
    camber_shift: Annotated[float, Signal("1", "shift of slip angle over camber", -1.0, 1.0, ADAMS + ", PHY3")] = 0.031415
    camber_thrust: Annotated[float, Signal("1", "side force over load and camber", -1.0, 2.0, ADAMS + ", PVY3")] = 0.32931
    relaxation_x: Annotated[float, Signal("m", "relaxation length, longitudinal", 0.01, 2.0, CHOSEN)] = 0.1
    relaxation_y: Annotated[float, Signal("m", "relaxation length, lateral", 0.01, 2.0, CHOSEN)] = 0.3
    damping: Annotated[float, Signal("s", "look-ahead that damps the carcass", 0.0, 0.1, CHOSEN)] = 0.01


class Force(NamedTuple):
    """Force of the road on a tyre [N], in the wheel's own directions."""

    x: float
    y: float


def relax(deflection: float, slip_speed: float, speed: float, length: float, h: float) -> float:
    """Return the carcass deflection [m] ``h`` [s] later: u' = slip_speed - speed u / length.

    Backward Euler: stable at any speed >= 0 and step. Steady state u = length * slip_speed / speed;
    at speed 0 a spring that holds. Held to ``LARGEST_SLIP`` times the length.
    """
    limit = LARGEST_SLIP * length
    return clamp((deflection + h * slip_speed) / (1.0 + h * speed / length), -limit, limit)


def magic(slip: float, stiffness: float, shape: float, curvature: float, peak: float) -> float:
    """Return peak sin(C atan(B s - E (B s - atan(B s)))) with B = stiffness / (C peak)."""
    b = stiffness * slip / (shape * peak)
    return peak * math.sin(shape * math.atan(b - curvature * (b - math.atan(b))))


def weight(slip: float, slope: float, shape: float, curvature: float) -> float:
    """Return the share G in [0, 1] of a force that is left beside the other slip; even in ``slip``.

    The cosine turns negative far out (beyond 60 deg of slip angle here): held to 0, for a tyre
    never drives what slides.
    """
    b = slope * slip
    share = math.cos(shape * math.atan(b - curvature * (b - math.atan(b))))
    return share if share > 0.0 else 0.0


def tire_force(kappa: float, slip_y: float, load: float, camber: float, grip: float, p: TireParams) -> Force:
    """Return the steady force [N] at slips [1] under ``load`` [N]; ``grip`` scales friction.

    ``slip_y`` is the tangent of the slip angle with the force's sign; ``camber`` [rad] is positive
    with the top leaning left, and pushes left. No load or no grip: no force.
    """
    if load <= 0.0 or grip <= 0.0:
        return Force(0.0, 0.0)
    angle = math.atan(slip_y)
    peak_x = grip * p.friction_x * load
    peak_y = grip * p.friction_y * (1.0 + p.camber_friction * camber * camber) * load
    pure_x = magic(kappa, p.stiffness_x * load, p.shape_x, p.curvature_x, peak_x)
    shifted = angle + p.camber_shift * camber
    pure_y = magic(shifted, p.stiffness_y * load, p.shape_y, p.curvature_y, peak_y)
    pure_y = pure_y + p.camber_thrust * camber * load
    fade_x = p.combined_x_fade * kappa
    fade_y = p.combined_y_fade * angle
    slope_x = p.combined_x_slope / math.sqrt(1.0 + fade_x * fade_x)
    slope_y = p.combined_y_slope / math.sqrt(1.0 + fade_y * fade_y)
    return Force(
        pure_x * weight(angle, slope_x, p.combined_x_shape, p.combined_x_curvature),
        pure_y * weight(kappa, slope_y, p.combined_y_shape, p.combined_y_curvature),
    )
