"""Initialisation: the landmark that a single echo feature makes, with the covariance that its range and bearing have.

Across the echo's direction u the point is known to r sigma_b (bearing), along it to the range's sigma_r:

    P = sigma_r2 u u' + (r sigma_b)2 v v',  v perpendicular to u

A side lies across u: its line is known to sigma_r, its heading as an update by a bearing would tell it.
"""

import math

from controller_fmu.parking.map.landmark import Landmark, LandmarkType
from controller_fmu.parking.map.update import BEARING_OVERLAP
from controller_fmu.parking.measurement.echo_feature import EchoFeature, FeatureType


def landmark_of(feature: EchoFeature, range_variance: float) -> Landmark:
    """Return a new landmark: a segment of no length for a side, a point for a corner, none if undecided."""
    lateral = feature.range * feature.bearing_sigma
    lateral_variance = lateral * lateral
    ux = feature.ux
    uy = feature.uy
    if feature.type == FeatureType.CORNER:
        return Landmark(
            type=LandmarkType.POINT,
            x=feature.x,
            y=feature.y,
            xx=range_variance * ux * ux + lateral_variance * uy * uy,
            xy=(range_variance - lateral_variance) * ux * uy,
            yy=range_variance * uy * uy + lateral_variance * ux * ux,
            confirmations=1,
        )
    if feature.type != FeatureType.SIDE:
        return Landmark()
    return Landmark(
        type=LandmarkType.SEGMENT,
        x=feature.x,
        y=feature.y,
        heading=math.atan2(ux, -uy),
        xx=range_variance * ux * ux,
        xy=range_variance * ux * uy,
        yy=range_variance * uy * uy,
        hh=BEARING_OVERLAP * feature.bearing_sigma * feature.bearing_sigma,
        start_variance=lateral_variance,
        end_variance=lateral_variance,
        confirmations=1,
    )
