"""Prediction: the covariance of landmarks grows with the error of the odometry.

Landmarks stand still; the odometry frame drifts against them. Over a distance s the pose errs by a longitudinal error
of variance q_d s and a heading error of variance q_h s (random walks). Seen in the odometry frame a landmark at r from
the vehicle moves by -u e_d + (z x r) e_h, with u the vehicle's direction, and turns by e_h:

    P += q_d s [u; 0][u; 0]' + q_h s [-r_y; r_x; 1][-r_y; r_x; 1]'
"""

import math

from controller_fmu.parking.map.landmark import Landmark
from controller_fmu.parking.map.params import MappingParams
from modelkit.vocabulary import Pose


def predict_landmark(landmark: Landmark, vehicle: Pose, distance: float, params: MappingParams) -> Landmark:
    """Return the landmark after the vehicle, now at ``vehicle``, drove ``distance`` [m] >= 0."""
    along = params.distance_variance * distance
    turn = params.heading_variance * distance
    ux = math.cos(vehicle.heading)
    uy = math.sin(vehicle.heading)
    gx = vehicle.y - landmark.y
    gy = landmark.x - vehicle.x
    return landmark._replace(
        xx=landmark.xx + along * ux * ux + turn * gx * gx,
        xy=landmark.xy + along * ux * uy + turn * gx * gy,
        yy=landmark.yy + along * uy * uy + turn * gy * gy,
        xh=landmark.xh + turn * gx,
        yh=landmark.yh + turn * gy,
        hh=landmark.hh + turn,
    )
