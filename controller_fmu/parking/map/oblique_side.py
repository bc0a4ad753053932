"""Sides that run obliquely to a sensor's path: echoes from where the boundary of the cone meets them.

On a side whose normal is turned by more than the half cone against the sensor's axis no foot of a perpendicular is in
view. The echo comes from the boundary of the cone on that side, so its place is known: p = s + r u, u the boundary. The
points of one side lie on a line, and the line's direction tells that they came from the boundary: the ranges of feet
and corners change by less than sin(cone) per metre, and would make lines less oblique than the cone is wide. A sensor
that turns by q moves the boundary's point by r q, whatever it measures: then the line's direction tells nothing.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import planar_distance
from controller_fmu.parking.geometry.line_fit import PointSums, about_mean, add_point
from controller_fmu.parking.map.chain_update import CONE_SIGMA, is_better, same_side
from controller_fmu.parking.map.echo_chain import MAX_EDGE_RANGE, Ending
from controller_fmu.parking.map.landmark import (
    Landmark,
    LandmarkType,
    along_of,
    free_index,
    offset_of,
    offset_variance,
    with_offset_variance,
)
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.measurement.sensor import Measurement, ReadingStatus, SensorPose, boundary_point
from modelkit.geometry import NO_HIT, Point
from modelkit.maths import PI, wrap_angle

MIN_POINTS = 5
"""Of a side, as many as confirm a landmark; a line through fewer is not tested."""
MIN_LENGTH = 0.25
"""Of a side [m]."""
MIN_SPACING = 0.03
MAX_SPACING = 0.6
"""Of two points of a side [m]: a step of 0.1 m, on a side nearly along the boundary."""
LINE_SIGMA = 3.0
"""A point off the line by more than this many standard deviations is of another side."""
OBLIQUE_MARGIN = 0.08
"""A side's normal is turned by more than the half cone and this [rad]: cones open by up to 4 deg more."""
SQUARE_MARGIN = 0.2
"""And by less than a right angle less this [rad]: along a side across the path the range tells no direction."""
EDGE_JUMP = 0.25
"""Two echoes in a row that differ by more [m] are of two bodies: a boundary point moves by less at each step."""
MAX_LOST = 3
"""Cycles without an echo that are dropouts."""
CONE_BOUNDARIES = 2
"""Of a cone: to the left and to the right of its axis."""


class BoundaryRun(NamedTuple):
    """Boundary points in a row: sums relative to the first of them, the first and the last."""

    sums: PointSums = PointSums()
    first: Point = Point(0.0, 0.0)
    last: Point = Point(0.0, 0.0)
    sensor: SensorPose = SensorPose()
    """At the first of them."""
    range: float = 0.0
    """Of the last echo [m]; ``NO_HIT`` after none, 0 before the first reading."""
    begins: int = Ending.HIDDEN
    lost: int = 0
    """Cycles without an echo since the last."""


class ConeBoundaries(NamedTuple):
    """The runs at the left and the right boundary of a sensor's cone."""

    runs: tuple[BoundaryRun, ...] = (BoundaryRun(),) * CONE_BOUNDARIES


class ObliqueUpdate(NamedTuple):
    """The boundaries of a sensor's cone after a reading, and the sides that have been passed."""

    boundaries: ConeBoundaries = ConeBoundaries()
    passed: tuple[Landmark, ...] = (Landmark(),) * CONE_BOUNDARIES
    """Type NONE: none, at that boundary."""
    is_oblique: bool = False
    """The echo is of such a side: of no foot or corner."""


def update_oblique_sides(boundaries: ConeBoundaries, reading: Measurement) -> ObliqueUpdate:
    """Return the runs after a reading of a sensor on a flank, and the sides that are to be mapped: those passed."""
    update = ObliqueUpdate(boundaries)
    for boundary in range(CONE_BOUNDARIES):
        runs = update.boundaries.runs
        run = runs[boundary]
        turn = 1.0 if boundary == 0 else -1.0
        point = boundary_point(reading.sensor, reading.range, turn)
        over = is_over(run, reading, point)
        if over:
            ends = side_ending(run.range, reading.range)
            side = side_of(run, reading.sensor, turn, ends, reading.variance)
            side = Landmark() if _is_turned(run, reading.sensor) else side
            update = update._replace(passed=update.passed[:boundary] + (side,) + update.passed[boundary + 1 :])
        run = next_run(run, reading, point, over)
        now = side_of(run, reading.sensor, turn, int(Ending.HIDDEN), reading.variance)
        update = update._replace(
            boundaries=ConeBoundaries(runs[:boundary] + (run,) + runs[boundary + 1 :]),
            is_oblique=update.is_oblique or now.type != LandmarkType.NONE,
        )
    return update


def index_of_side(landmarks: tuple[Landmark, ...], new: Landmark, params: MappingParams) -> int:
    """Return the place of the map for a new side; -1: a landmark is the same and known better, or there is no side."""
    if new.type == LandmarkType.NONE:
        return -1
    other = same_side(landmarks, new, -1, params)
    if other < 0:
        return free_index(landmarks)
    return -1 if is_better(landmarks[other], new) else other


def is_over(run: BoundaryRun, reading: Measurement, point: Point) -> bool:
    """Return whether a run has ended with a reading whose boundary point is ``point``."""
    if run.sums.n == 0:
        return False
    if reading.status == ReadingStatus.NO_ECHO:
        return run.lost + 1 >= MAX_LOST
    if reading.status != ReadingStatus.ECHO or abs(reading.range - run.range) > EDGE_JUMP:
        return True
    if planar_distance(point.x, point.y, run.last.x, run.last.y) > MAX_SPACING:
        return True
    if run.sums.n < 3:
        return False
    line = line_of(run, reading.variance)
    off = offset_of(line, point.x, point.y)
    known = offset_variance(line, along_of(line, point.x, point.y))
    return off * off > LINE_SIGMA * LINE_SIGMA * (reading.variance + known)


def next_run(run: BoundaryRun, reading: Measurement, point: Point, over: bool) -> BoundaryRun:
    """Return a run after a reading, or the one that begins after it is ``over``."""
    if reading.status != ReadingStatus.ECHO:
        return BoundaryRun(range=NO_HIT) if over or run.sums.n == 0 else run._replace(lost=run.lost + 1)
    if over or run.sums.n == 0:
        begun = BoundaryRun(sensor=reading.sensor, begins=side_ending(reading.range, run.range))
        return with_point(begun, point, reading.range)
    if planar_distance(point.x, point.y, run.last.x, run.last.y) < MIN_SPACING:
        return run._replace(lost=0)
    return with_point(run, point, reading.range)


def with_point(run: BoundaryRun, point: Point, measured: float) -> BoundaryRun:
    """Return a run with one more point, of an echo at ``measured`` [m]."""
    first = run.first if run.sums.n > 0 else point
    sums = add_point(run.sums, point.x - first.x, point.y - first.y)
    return run._replace(sums=sums, first=first, last=point, range=measured, lost=0)


def side_ending(inner: float, outer: float) -> int:
    """Return the ``Ending`` of a side: its outermost echo is at ``inner`` [m], the next beyond at ``outer`` [m]."""
    if outer > inner + EDGE_JUMP:
        return Ending.EDGE if inner < MAX_EDGE_RANGE else Ending.HIDDEN
    return Ending.HIDDEN if outer < inner - EDGE_JUMP else Ending.CONTINUES


def line_of(run: BoundaryRun, variance: float) -> Landmark:
    """Return the line through a run's points by least squares across it; ``variance`` [m2] of a point."""
    points = about_mean(run.sums)
    difference = points.xx - points.yy
    heading = 0.5 * math.atan2(2.0 * points.xy, difference)
    root = math.sqrt(difference * difference + 4.0 * points.xy * points.xy)
    along = 0.5 * (points.xx + points.yy + root)
    x = run.first.x + points.x
    y = run.first.y + points.y
    hh = variance / max(along, variance)
    line = Landmark(type=LandmarkType.SEGMENT, x=x, y=y, heading=heading, hh=hh, confirmations=run.sums.n)
    return with_offset_variance(line, variance / float(max(points.n, 1)))


def side_of(run: BoundaryRun, sensor: SensorPose, turn: float, ends: int, variance: float) -> Landmark:
    """Return the side of a run at the left (``turn`` 1) or right (-1) boundary; type NONE: no side, or not oblique.

    The end towards the foot of the perpendicular is known unless hidden: there the echoes become a corner's. The other
    end is known where nothing else came nearer.
    """
    if run.sums.n < MIN_POINTS:
        return Landmark()
    line = line_of(run, variance)
    if offset_of(line, sensor.x, sensor.y) < 0.0:
        line = line._replace(heading=wrap_angle(line.heading + PI))
    foot_x = math.sin(line.heading)
    foot_y = -math.cos(line.heading)
    across = turn * (sensor.axis_x * foot_y - sensor.axis_y * foot_x)
    angle = math.atan2(across, sensor.axis_x * foot_x + sensor.axis_y * foot_y)
    half = math.atan2(sensor.cone_sin, sensor.cone_cos)
    first = along_of(line, run.first.x, run.first.y)
    last = along_of(line, run.last.x, run.last.y)
    is_oblique = half + OBLIQUE_MARGIN < angle < 0.5 * PI - SQUARE_MARGIN
    if abs(last - first) < MIN_LENGTH or not is_oblique:
        return Landmark()
    foot = along_of(line, sensor.x, sensor.y)
    first_is_near = (first - last) * (foot - last) > 0.0
    first_known = run.begins == Ending.EDGE or (first_is_near and run.begins == Ending.CONTINUES)
    last_known = ends == Ending.EDGE or (not first_is_near and ends == Ending.CONTINUES)
    start_known = first_known if first < last else last_known
    end_known = last_known if first < last else first_known
    side = line._replace(start=min(first, last), end=max(first, last), start_known=start_known, end_known=end_known)
    return _with_opening(side, angle, angle - half, run.range)


def _is_turned(run: BoundaryRun, sensor: SensorPose) -> bool:
    """Return whether a sensor has turned so far over a run that its points may lie obliquely for that alone."""
    before = run.sensor
    turn = abs(before.axis_x * sensor.axis_y - before.axis_y * sensor.axis_x)
    return turn * run.range > OBLIQUE_MARGIN * planar_distance(sensor.x, sensor.y, before.x, before.y)


def _with_opening(side: Landmark, angle: float, off_boundary: float, measured: float) -> Landmark:
    """Return a side with the covariance of its points and of the cone's opening, at a range [m].

    ``angle`` [rad]: of its normal against the sensor's axis, ``off_boundary``: against the boundary of the cone.
    """
    opening = CONE_SIGMA * math.sin(off_boundary)
    shift = opening * measured
    end_variance = CONE_SIGMA * CONE_SIGMA * measured * measured
    side = with_offset_variance(side, shift * shift)
    hh = side.hh + opening * opening * math.sin(angle) * math.sin(angle)
    return side._replace(hh=hh, start_variance=end_variance, end_variance=end_variance)
