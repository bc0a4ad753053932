"""Tyres: Magic Formula with combined slip, behind the springs of a carcass that cannot give energy.

Slip is that of a wheel rolling in its own direction: kappa = (R omega - V_x) / V and
t = -V_y / V, with V the larger of |V_x| and |R omega| (at least a tenth of |V_y|), so that a
force has the sign of its slip and slip stays finite.

    pure:      F = D sin(C atan(B s - E (B s - atan(B s)))),  D = mu F_z,  B C D = K F_z
    combined:  F_x G(alpha),  F_y G(kappa),  G = cos(C atan(B s - E (B s - atan(B s))))

with B = B_1 / sqrt(1 + (B_2 s)^2) of the other slip (Pacejka, Tyre and Vehicle Dynamics,
chapter 4; PAC2002). All shifts are left out, for they would push a car at rest and make left
differ from right; camber adds to the lateral slip.

The carcass is a spring c, and slides against the road at the slip speed V_s = slip V:

    F = c u    u' = V_s - (c V / S) u,  S = F_steady / slip

In steady rolling F = F_steady; for small slip the relaxation length is K F_z / c; at rest
(V = 0) a spring that holds. F V_s - (c u^2 / 2)' = c^2 V u^2 / S >= 0: no motion gains energy.
At V -> 0 this is Dahl's friction model.
"""

import math
from typing import Annotated, NamedTuple

from modelkit.signal import Signal

ADAMS = "ADAMS handbook, PAC2002 example tyre, as in CommonRoad vehicle models 3.0.2"
CHOSEN = "chosen, usual for passenger cars"
FREE_CARCASS_RATE = 1e9
"""Rate [1/s] at which a carcass without grip springs back."""


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
    combined_x_fade: Annotated[float, Signal("1", "B_2 of G(alpha), times kappa", 0.0, 100.0, ADAMS + ", RBX2")] = (
        13.778
    )
    combined_x_shape: Annotated[float, Signal("1", "C of G(alpha)", 0.0, 2.0, ADAMS + ", RCX1")] = 1.2568
    combined_x_curvature: Annotated[float, Signal("1", "E of G(alpha)", -10.0, 1.0, ADAMS + ", REX1")] = 0.65225
    combined_y_slope: Annotated[float, Signal("1", "B_1 of G(kappa)", 0.0, 100.0, ADAMS + ", RBY1")] = 7.1433
    combined_y_fade: Annotated[float, Signal("1", "B_2 of G(kappa), times alpha", 0.0, 100.0, ADAMS + ", RBY2")] = (
        9.1916
    )
    combined_y_shape: Annotated[float, Signal("1", "C of G(kappa)", 0.0, 2.0, ADAMS + ", RCY1")] = 1.0719
    combined_y_curvature: Annotated[float, Signal("1", "E of G(kappa)", -10.0, 1.0, ADAMS + ", REY1")] = -0.27572
    camber_friction: Annotated[float, Signal("1", "gain of mu with camber squared", -10.0, 10.0, ADAMS + ", -PDY3")] = (
        2.8821
    )
    camber_slip: Annotated[
        float, Signal("1", "slip angle equivalent to camber", -1.0, 1.0, ADAMS + ", PHY3 + PVY3 / PKY1")
    ] = 0.04644
    carcass_x: Annotated[float, Signal("N/m", "carcass stiffness, longitudinal", 1e4, 1e7, CHOSEN)] = 400000.0
    carcass_y: Annotated[float, Signal("N/m", "carcass stiffness, lateral", 1e4, 1e7, CHOSEN)] = 150000.0
    damping: Annotated[float, Signal("s", "damping over stiffness of the carcass", 0.0, 0.1, CHOSEN)] = 0.01


LINEAR_SLIP = 1e-9
"""Slip below which a force is linear."""


MIN_WHEEL_LOAD = 1e-6
"""Load [N] below which a wheel hangs in the air."""


class Force(NamedTuple):
    """Force of the road on a tyre [N], in the wheel's own directions."""

    x: float
    y: float


def relax(deflection: float, slip_speed: float, rate: float, h: float) -> float:
    """Return the carcass deflection [m] ``h`` [s] later: u' = slip_speed - rate u, by backward Euler.

    Stable at any rate >= 0 and step; rate 0 is a spring that holds.
    """
    return (deflection + h * slip_speed) / (1.0 + h * rate)


def slide_rate(carcass: float, speed: float, secant: float) -> float:
    """Return c V / S [1/s]: how fast the road takes the deflection away; without grip at once."""
    if secant <= 1e-9:
        return FREE_CARCASS_RATE
    return carcass * speed / secant


def magic(slip: float, stiffness: float, shape: float, curvature: float, peak: float) -> float:
    """Return peak sin(C atan(B s - E (B s - atan(B s)))) with B = stiffness / (C peak)."""
    b = stiffness * slip / (shape * peak)
    return peak * math.sin(shape * math.atan(b - curvature * (b - math.atan(b))))


def weight(slip: float, slope: float, shape: float, curvature: float) -> float:
    """Return the share G in [0, 1] of a force that is left beside the other slip; even in ``slip``.

    The cosine turns negative far out (G(alpha) beyond 0.5 rad here): held to 0, for a tyre never
    drives what slides.
    """
    b = slope * slip
    share = math.cos(shape * math.atan(b - curvature * (b - math.atan(b))))
    return share if share > 0.0 else 0.0


def secants(kappa: float, slip_y: float, load: float, camber: float, grip: float, p: TireParams) -> Force:
    """Return the steady forces over their slips, F_x / kappa and F_y / slip_y [N], both >= 0.

    ``slip_y`` is the tangent of the slip angle; ``grip`` scales friction. At zero slip the
    slip stiffness itself. Where weighting leaves less than sliding rubber has (grip times load
    over slip: at large angles), that. No load or no grip: zero.
    """
    if not load * grip > MIN_WHEEL_LOAD:
        return Force(0.0, 0.0)
    angle = math.atan(slip_y)
    fade_x = p.combined_x_fade * kappa
    fade_y = p.combined_y_fade * angle
    slope_x = p.combined_x_slope / math.sqrt(1.0 + fade_x * fade_x)
    slope_y = p.combined_y_slope / math.sqrt(1.0 + fade_y * fade_y)
    share_x = weight(angle, slope_x, p.combined_x_shape, p.combined_x_curvature)
    share_y = weight(kappa, slope_y, p.combined_y_shape, p.combined_y_curvature)
    force_x = p.stiffness_x * load
    if abs(kappa) > LINEAR_SLIP:
        force_x = magic(kappa, force_x, p.shape_x, p.curvature_x, grip * p.friction_x * load) / kappa
    force_y = p.stiffness_y * load
    if abs(slip_y) > LINEAR_SLIP:
        peak = grip * p.friction_y * (1.0 + p.camber_friction * camber * camber) * load
        force_y = magic(angle, force_y, p.shape_y, p.curvature_y, peak) / slip_y
    least = grip * load / (1.0 + math.sqrt(kappa * kappa + slip_y * slip_y))
    force_x = share_x * force_x
    force_y = share_y * force_y
    return Force(force_x if force_x > least else least, force_y if force_y > least else least)
