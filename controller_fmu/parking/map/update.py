"""The measurement update of a landmark: an extended Kalman filter with scalar innovations.

    y = z - h(x)    S = H P H' + R    K = P H' / S    x += K y    P -= K H P

The echo of a side updates the line of its segment by the range to the foot of the perpendicular. The echo of a corner
updates a point along and across its direction, or the end of a segment along its line.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.map.landmark import Landmark, LandmarkType, along_of, offset_of
from controller_fmu.parking.measurement.echo_feature import EchoFeature, FeatureType
from controller_fmu.parking.measurement.echo_window import MIDDLE, EchoWindow
from modelkit.maths import sign, wrap_angle

MIN_VARIANCE = 1e-6
"""Variances stay above (1 mm)2 and (1 mrad)2: sensors are mounted no better."""
KNOWN_END_SIGMA = 0.1
"""An end is known once its standard deviation [m] is below this: half of the narrowest gap that separates two cars."""
OPEN_END_SIGMA = 0.15
"""Standard deviation [m] of an end known only by feet of perpendiculars: at 1 m a corner's range leaves that of the
line by two sigma of 1 cm after 0.2 m, and then by more."""
AGREEMENT_SIGMA = 2.0
"""An echo within this many standard deviations of the line's distance agrees with it."""
OVERLAP = 9.0
"""Bearings of features in a row come from windows of nine echoes that overlap: each is worth a ninth of one."""


BEARING_OVERLAP = 3.0 * OVERLAP
"""The error of a bearing comes from the ends of its window, which stay in nine windows in a row, twice as long."""


class Gradient(NamedTuple):
    """H: how a measured scalar changes with the landmark's x, y [1] and heading [m]."""

    x: float
    y: float
    heading: float


def line_gradient(landmark: Landmark, sensor_x: float, sensor_y: float) -> Gradient:
    """Return H of the distance [m] from a sensor to a segment's line."""
    cos = math.cos(landmark.heading)
    sin = math.sin(landmark.heading)
    side = sign((sensor_y - landmark.y) * cos - (sensor_x - landmark.x) * sin)
    along = (sensor_x - landmark.x) * cos + (sensor_y - landmark.y) * sin
    return Gradient(side * sin, -side * cos, -side * along)


def innovation_variance(landmark: Landmark, h: Gradient, noise_variance: float) -> float:
    """Return S = H P H' + R [m2]."""
    return (
        h.x * h.x * landmark.xx
        + h.y * h.y * landmark.yy
        + h.heading * h.heading * landmark.hh
        + 2.0 * (h.x * h.y * landmark.xy + h.x * h.heading * landmark.xh + h.y * h.heading * landmark.yh)
        + noise_variance
    )


def update_landmark(landmark: Landmark, h: Gradient, innovation: float, noise_variance: float) -> Landmark:
    """Return the landmark after a scalar measurement with gradient ``h`` and ``innovation`` z - h(x) [m]."""
    s = innovation_variance(landmark, h, noise_variance)
    px = h.x * landmark.xx + h.y * landmark.xy + h.heading * landmark.xh
    py = h.x * landmark.xy + h.y * landmark.yy + h.heading * landmark.yh
    ph = h.x * landmark.xh + h.y * landmark.yh + h.heading * landmark.hh
    return landmark._replace(
        x=landmark.x + px / s * innovation,
        y=landmark.y + py / s * innovation,
        heading=landmark.heading + ph / s * innovation,
        xx=max(MIN_VARIANCE, landmark.xx - px * px / s),
        xy=landmark.xy - px * py / s,
        xh=landmark.xh - px * ph / s,
        yy=max(MIN_VARIANCE, landmark.yy - py * py / s),
        yh=landmark.yh - py * ph / s,
        hh=max(MIN_VARIANCE, landmark.hh - ph * ph / s),
    )


def update_with_feature(landmark: Landmark, feature: EchoFeature, variance: float) -> Landmark:
    """Return the landmark after a feature that came from it; ``variance`` [m2] of its range."""
    lateral = feature.range * feature.bearing_sigma
    lateral_variance = OVERLAP * lateral * lateral
    updated = landmark._replace(confirmations=landmark.confirmations + 1, contradictions=0)
    if landmark.type == LandmarkType.POINT:
        dx = feature.x - landmark.x
        dy = feature.y - landmark.y
        radial = Gradient(feature.ux, feature.uy, 0.0)
        updated = update_landmark(updated, radial, dx * feature.ux + dy * feature.uy, variance)
        across = Gradient(-feature.uy, feature.ux, 0.0)
        return update_landmark(
            updated,
            across,
            (feature.y - updated.y) * feature.ux - (feature.x - updated.x) * feature.uy,
            lateral_variance,
        )
    along = along_of(landmark, feature.x, feature.y)
    if feature.type == FeatureType.CORNER:
        return update_end(updated, along, lateral_variance)
    if feature.type == FeatureType.SIDE:
        h = line_gradient(landmark, feature.sensor_x, feature.sensor_y)
        distance = abs(offset_of(landmark, feature.sensor_x, feature.sensor_y))
        updated = update_landmark(updated, h, feature.range - distance, OVERLAP * variance)
        turn = wrap_angle(math.atan2(feature.ux, -feature.uy) - updated.heading)
        bearing_variance = BEARING_OVERLAP * feature.bearing_sigma * feature.bearing_sigma
        updated = update_landmark(updated, Gradient(0.0, 0.0, 1.0), turn, bearing_variance)
    return extend_segment(updated, along, lateral * lateral)


def extend_over_window(landmark: Landmark, window: EchoWindow, variance: float) -> Landmark:
    """Return the segment with open ends moved to the feet of those echoes of a window that agree with its line.

    Outwards from the middle echo, as far as they agree; this is where the side was still detected, not where it ends.
    """
    if landmark.type != LandmarkType.SEGMENT:
        return landmark
    most = AGREEMENT_SIGMA * AGREEMENT_SIGMA * variance
    for direction in (-1, 1):
        agrees = True
        for step in range(MIDDLE + 1):
            sample = window.samples[MIDDLE + direction * step]
            error = sample.range - abs(offset_of(landmark, sample.x, sample.y))
            agrees = agrees and error * error < most
            if agrees:
                along = along_of(landmark, sample.x, sample.y)
                landmark = extend_segment(landmark, along, OPEN_END_SIGMA * OPEN_END_SIGMA)
    return landmark


def update_end(landmark: Landmark, along: float, variance: float) -> Landmark:
    """Return the segment whose nearer end was detected ``along`` [m] its line with a ``variance`` [m2]."""
    if along - landmark.start < landmark.end - along:
        p = landmark.start_variance
        gain = p / (p + variance)
        after = max(MIN_VARIANCE, p - gain * p)
        known = landmark.start_known or after < KNOWN_END_SIGMA * KNOWN_END_SIGMA
        start = landmark.start + gain * (along - landmark.start)
        return landmark._replace(start=start, start_variance=after, start_known=known)
    p = landmark.end_variance
    gain = p / (p + variance)
    after = max(MIN_VARIANCE, p - gain * p)
    known = landmark.end_known or after < KNOWN_END_SIGMA * KNOWN_END_SIGMA
    end = landmark.end + gain * (along - landmark.end)
    return landmark._replace(end=end, end_variance=after, end_known=known)


def extend_segment(landmark: Landmark, along: float, variance: float) -> Landmark:
    """Return the segment with an open end moved to ``along`` [m], of a ``variance`` [m2], if that lies beyond it."""
    if along < landmark.start and not landmark.start_known:
        return landmark._replace(start=along, start_variance=variance)
    if along > landmark.end and not landmark.end_known:
        return landmark._replace(end=along, end_variance=variance)
    return landmark
