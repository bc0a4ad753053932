"""The two preview distances and the set speed as the car nears, drives and leaves a curve (preview paper, Fig. 4)."""

from typing import NamedTuple

from controller_fmu.preview.params import PreviewParams
from controller_fmu.preview.safe_speed import safe_speed
from controller_fmu.preview.stage import PreviewStage
from modelkit.maths import clamp


class Sequence(NamedTuple):
    """Stage, distances and set speed held over a control step."""

    stage: int = PreviewStage.STRAIGHT
    l1: float = 4.5
    l2: float = 6.5
    set_speed: float = 0.0
    clock: float = 0.0
    """Time in the alternation's period [s]."""
    kappa: float = 0.0
    """Curvature L1 and the safe speed were chosen for [1/m]."""


def straight_distance(speed: float, params: PreviewParams) -> float:
    """Return L1 on a straight [m], equation (5)."""
    length = params.straight_slope * speed + params.straight_offset
    return clamp(length, params.straight_shortest, params.straight_longest)


def curve_distance(curvature: float, params: PreviewParams) -> float:
    """Return L1 on a curve [m], equation (6)."""
    return clamp(params.curve_slope * abs(curvature) + params.curve_offset, params.curve_shortest, params.curve_longest)


def advance(
    sequence: Sequence, kappa1: float, kappa2: float, speed: float, params: PreviewParams, dt: float
) -> Sequence:
    """Return the sequence after a control step in which LA1 and LA2 saw ``kappa1`` and ``kappa2`` [1/m]."""
    if sequence.stage == PreviewStage.STRAIGHT:
        return _straight(sequence, kappa2, speed, params, dt)
    if sequence.stage == PreviewStage.SLOWING:
        if kappa2 != 0.0:
            return _shorten(sequence, kappa2, params)
        l1 = straight_distance(speed, params)
        return sequence._replace(l1=l1, l2=l1 + params.near_gap)
    if sequence.stage == PreviewStage.SHORTENED:
        if kappa1 != 0.0:
            return sequence._replace(stage=PreviewStage.CURVE, l2=sequence.l1 + params.near_gap)
        return sequence
    if kappa1 == 0.0:
        return _restart(speed, params)
    if kappa2 == 0.0:
        return sequence._replace(stage=PreviewStage.LEAVING)
    if kappa2 != sequence.kappa:
        shortened = _shorten(sequence, kappa2, params)
        return shortened._replace(stage=PreviewStage.CURVE, l2=shortened.l1 + params.near_gap)
    return sequence._replace(stage=PreviewStage.CURVE)


def _straight(sequence: Sequence, kappa2: float, speed: float, params: PreviewParams, dt: float) -> Sequence:
    """Return the alternation one step on, or the slowing stage if either L2 sees a curve."""
    l1 = straight_distance(speed, params)
    if kappa2 != 0.0:
        slow = safe_speed(kappa2, params.safe_acceleration, params.set_speed)
        if sequence.l2 < sequence.l1 + 0.5 * (params.near_gap + params.far_gap):
            return _shorten(sequence, kappa2, params)
        return Sequence(PreviewStage.SLOWING, l1, l1 + params.near_gap, slow, 0.0, kappa2)
    clock = sequence.clock + dt
    if clock >= params.period:
        clock = clock - params.period
    gap = params.far_gap if clock < params.far_time else params.near_gap
    return Sequence(sequence.stage, l1, l1 + gap, params.set_speed, clock, 0.0)


def _shorten(sequence: Sequence, kappa2: float, params: PreviewParams) -> Sequence:
    """Return L1 by (6) with L2 as it was, and the curve's safe speed."""
    slow = safe_speed(kappa2, params.safe_acceleration, params.set_speed)
    return Sequence(PreviewStage.SHORTENED, curve_distance(kappa2, params), sequence.l2, slow, 0.0, kappa2)


def _restart(speed: float, params: PreviewParams) -> Sequence:
    """Return the alternation at the start of its period, set speed of the straight."""
    l1 = straight_distance(speed, params)
    return Sequence(PreviewStage.STRAIGHT, l1, l1 + params.far_gap, params.set_speed, 0.0, 0.0)
