"""The vehicle for runs of which only the smallest clearance is kept: it is worked out where it may be smaller.

Outline and obstacles are rigid. So the clearance falls by no more than a point of the outline moves:

    clearance >= clearance before - |position - position before| - reach |heading - heading before|

with the distance ``reach`` from the rear-axle midpoint that no point of the outline exceeds. Where this bound is not
below the smallest clearance so far, that stays. Things that move or appear during the run have no such bound: with them
the clearance is worked out at each step. ``clearance`` and ``contact`` of the outputs are those of the smallest so far.
"""

import math
from typing import NamedTuple

from modelkit.car import Car
from modelkit.geometry import NO_HIT
from modelkit.vocabulary import Pose, VehicleFault
from vehicle_fmu.interface import VehicleInput, VehicleOutput, VehicleParams
from vehicle_fmu.model import VehicleState, advance, begin, outputs
from vehicle_fmu.scene import MAX_ROUNDING_ERROR, SceneParams, clearance

MAX_ABOVE_SMALLEST = 1.0
"""Clearances are distinguished up to this much [m] above the smallest so far."""


class NearestApproach(NamedTuple):
    """What is known of the clearance."""

    smallest: float = NO_HIT
    """So far [m]."""
    pose: Pose = Pose()
    """Where it was worked out last."""
    least: float = 0.0
    """Lower bound of the clearance there [m]."""
    static: bool = False
    """Nothing in the scene moves or appears during the run."""


class WatchedVehicle(NamedTuple):
    """The vehicle and its nearest approach."""

    vehicle: VehicleState = VehicleState()
    nearest: NearestApproach = NearestApproach()


def initialize(params: VehicleParams) -> tuple[WatchedVehicle, VehicleOutput]:
    """Return the car at rest at its start pose, with the clearance there."""
    vehicle = begin(params)
    nearest = NearestApproach(static=is_static(params.scene))
    if vehicle.fault == VehicleFault.BAD_PARAMETER:
        nearest = NearestApproach(0.0)
    else:
        nearest = approach(nearest, vehicle.car.pose, params, 0)
    return WatchedVehicle(vehicle, nearest), outputs(vehicle, nearest.smallest, False, params)


def step(
    state: WatchedVehicle, inputs: VehicleInput, params: VehicleParams, dt_ns: int
) -> tuple[WatchedVehicle, VehicleOutput]:
    """Return the vehicle ``dt_ns`` later, its inputs held."""
    vehicle = state.vehicle
    vehicle = advance(vehicle, inputs, params, dt_ns)
    nearest = state.nearest
    if vehicle.fault != VehicleFault.BAD_PARAMETER and may_be_nearer(
        nearest, vehicle.car.pose, params.car, params.scene
    ):
        nearest = approach(nearest, vehicle.car.pose, params, vehicle.car.time_ns)
    confirms = inputs.manual.active and inputs.manual.confirm
    state = WatchedVehicle(vehicle, nearest)
    return state, outputs(state.vehicle, state.nearest.smallest, confirms, params)


def is_static(scene: SceneParams) -> bool:
    """Return whether nothing moves or appears; what disappears leaves more room."""
    static = True
    for box in scene.boxes:
        if box.length > 0.0 and (box.appear_at > 0.0 or box.speed_x != 0.0 or box.speed_y != 0.0):
            static = False
    return static


def may_be_nearer(nearest: NearestApproach, pose: Pose, car: Car, scene: SceneParams) -> bool:
    """Return whether the clearance at ``pose`` may be below the smallest so far."""
    dx = pose.x - nearest.pose.x
    dy = pose.y - nearest.pose.y
    turned = abs(pose.heading - nearest.pose.heading)
    reach = car.wheelbase + max(car.front_overhang, car.rear_overhang, scene.tyre_reach) + 0.5 * car.width
    moved = math.sqrt(dx * dx + dy * dy) + reach * turned
    if moved == 0.0:
        return not nearest.static
    return not (nearest.static and nearest.least - moved - MAX_ROUNDING_ERROR >= nearest.smallest)


def approach(nearest: NearestApproach, pose: Pose, params: VehicleParams, time_ns: int) -> NearestApproach:
    """Return the nearest approach after the clearance at ``pose`` is worked out."""
    limit = min(nearest.smallest + MAX_ABOVE_SMALLEST, NO_HIT)
    gap = clearance(pose, params.car, params.scene, params.ultrasonic.kerb_height, time_ns, limit)
    return NearestApproach(min(nearest.smallest, gap), pose, gap, nearest.static)
