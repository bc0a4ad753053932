"""Outputs of NTBPTcwPT."""

import math

from controller_fmu.common.phases import is_parking
from controller_fmu.common.slot_frame import to_world
from controller_fmu.guo2015.legs import point_of_leg
from controller_fmu.guo2015.params import GuoSystemParams
from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.guo2015.planner import Plan
from controller_fmu.guo2015.prompts import prompt_of
from controller_fmu.guo2015.signals import NO_POINTS, PLANNED_POINT_COUNT, GuoOutput, GuoSignals, PlannedPoint
from controller_fmu.guo2015.smooth_path import PathShape, on_curve
from controller_fmu.guo2015.system import GuoState
from controller_fmu.interface import Path, Segment
from modelkit.vocabulary import Pose

NOT_DRAWN = (Segment(), Segment(), Segment())
"""A path that is not made of arcs."""


def guo_outputs(state: GuoState, params: GuoSystemParams) -> GuoOutput:
    """Return the outputs that hold until the next sample."""
    active = is_parking(state.phase)
    frame = state.plan.frame
    reference = state.tracking.reference
    return GuoOutput(
        steering_wheel_request=state.request,
        steering_active=active,
        prompt=prompt_of(state.phase, state.moving, state.advice, params.guo2015.prompting),
        advised_speed=state.advice,
        brake_request=state.phase == GuoPhase.FAILED and not state.takeover,
        phase=state.phase,
        reason=state.reason,
        manoeuvres=state.manoeuvres,
        reference=to_world(Pose(reference.x, reference.y, reference.heading), frame),
        lateral_error=state.tracking.lateral_error,
        heading_error=state.tracking.heading_error,
        path=arc_plan(state.plan),
        guo2015=guo_signals(state.plan, params),
    )


def arc_plan(planned: Plan) -> Path:
    """Return the start of the path and, where it is made of arcs, its pieces."""
    path = planned.path
    k = planned.frame.mirror / path.radius if path.found else 0.0
    line = math.sqrt(_distance_squared(path.tangent1, path.tangent2))
    pieces = (
        Segment(path.radius * (path.tangent1.heading - path.start.heading), -k),
        Segment(line, 0.0),
        Segment(path.radius * path.tangent2.heading, k),
    )
    start = to_world(path.start, planned.frame)
    return Path(start, pieces if path.curve.shape == PathShape.TWO_ARCS else NOT_DRAWN)


def guo_signals(planned: Plan, params: GuoSystemParams) -> GuoSignals:
    """Return the points Q1 to Q4 and the path where it is not made of arcs; without a path, all zero."""
    path = planned.path
    frame = planned.frame
    if not path.found:
        return GuoSignals()
    gains = params.guo2015
    points = NO_POINTS
    if path.curve.shape != PathShape.TWO_ARCS:
        for number in range(PLANNED_POINT_COUNT):
            x = path.start.x * (1.0 - number / (PLANNED_POINT_COUNT - 1.0))
            at = to_world(Pose(x, on_curve(path.curve, x).y, 0.0), frame)
            points = points[1:] + (PlannedPoint(at.x, at.y),)
    return GuoSignals(
        q1=to_world(point_of_leg(GuoPhase.TO_Q1, path, gains), frame),
        q2=to_world(point_of_leg(GuoPhase.TO_Q2, path, gains), frame),
        q3=to_world(point_of_leg(GuoPhase.TO_Q3, path, gains), frame),
        q4=to_world(point_of_leg(GuoPhase.TO_Q4, path, gains), frame),
        points=points,
    )


def _distance_squared(a: Pose, b: Pose) -> float:
    dx = a.x - b.x
    dy = a.y - b.y
    return dx * dx + dy * dy
