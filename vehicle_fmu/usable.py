"""Whether the parameters describe a car: finite numbers, and positive ones where equations divide."""

from modelkit.car import Car, CarUltrasonic
from modelkit.maths import is_finite
from vehicle_fmu.bodies.chassis import ChassisParams
from vehicle_fmu.bodies.double_track import DoubleTrackParams
from vehicle_fmu.bodies.single_track import SingleTrackParams
from vehicle_fmu.bodies.tires import TireParams
from vehicle_fmu.interface import Body, DriveParams, VehicleParams
from vehicle_fmu.scene import SceneParams
from vehicle_fmu.ultrasonic import UltrasonicParams

MAX_MAGNITUDE = 1e9


def is_usable(params: VehicleParams) -> bool:
    """Return False if an equation of the chosen body, the steering or a sensor would have no meaning."""
    start = params.start
    return (
        is_finite(start.x + start.y + start.heading + params.driver.road_curvature)
        and _sizes(params.car.wheelbase)
        and _sizes(params.car.steering.ratio)
        and _sizes(params.largest_step)
        and _sizes(params.driver.speed_oscillation_period)
        and _sizes(params.chassis.mass)
        and _hears(params.car.ultrasonic, params.ultrasonic)
        and _stands(params.scene)
        and (params.body == Body.KINEMATIC or _has_mass(params))
        and (params.body != Body.SINGLE_TRACK or _is_single(params.single_track))
        and (params.body != Body.DOUBLE_TRACK or _is_double(params.double_track))
    )


def _has_mass(params: VehicleParams) -> bool:
    return (
        _sizes(params.body_step)
        and is_finite(params.road.grade + params.road.cross_slope + params.road.ramp.grade)
        and is_finite(params.road.ramp.x + params.road.ramp.y + params.road.ramp.heading)
        and _is_chassis(params.chassis, params.car)
        and _drives(params.drive)
    )


def _drives(drive: DriveParams) -> bool:
    return (
        is_finite(drive.speed_gain + drive.speed_integral + drive.integral_limit + drive.hold_deceleration)
        and is_finite(drive.drive_force_limit + drive.brake_force_limit + drive.creep_force)
        and drive.drive_lag >= 0.0
        and drive.brake_lag >= 0.0
        and _sizes(drive.creep_speed)
    )


def _is_chassis(p: ChassisParams, car: Car) -> bool:
    return (
        _sizes(p.mass)
        and _sizes(p.yaw_inertia)
        and 0.0 < car.cg_to_rear < car.wheelbase
        and is_finite(p.cg_height + p.rolling_resistance + p.drag_x + p.drag_y)
        and is_finite(p.front_drive_share + p.front_brake_share)
    )


def _is_single(p: SingleTrackParams) -> bool:
    return (
        _sizes(p.stiffness_front)
        and _sizes(p.stiffness_rear)
        and _sizes(p.relaxation)
        and is_finite(p.load_height)
        and is_finite(p.friction)
    )


def _is_double(p: DoubleTrackParams) -> bool:
    roll = p.roll
    return (
        _sizes(p.track_front)
        and _sizes(p.track_rear)
        and _sizes(p.hub.radius)
        and _sizes(p.hub.inertia)
        and _sizes(p.hub.traction)
        and is_finite(p.ackermann + roll.arm + roll.stiffness_front + roll.stiffness_rear)
        and is_finite(roll.camber_front + roll.camber_rear + roll.unsprung_front + roll.unsprung_rear)
        and roll.lag >= 0.0
        and _is_tire(p.tires)
    )


def _is_tire(p: TireParams) -> bool:
    return (
        _sizes(p.shape_x)
        and _sizes(p.shape_y)
        and _sizes(p.friction_x)
        and _sizes(p.friction_y)
        and _sizes(p.stiffness_x)
        and _sizes(p.stiffness_y)
        and _sizes(p.carcass_x)
        and _sizes(p.carcass_y)
        and p.damping >= 0.0
        and p.camber_friction >= 0.0
        and is_finite(p.curvature_x + p.curvature_y + p.camber_slip)
        and is_finite(p.combined_x_slope + p.combined_x_fade + p.combined_x_shape + p.combined_x_curvature)
        and is_finite(p.combined_y_slope + p.combined_y_fade + p.combined_y_shape + p.combined_y_curvature)
    )


def _hears(sensors: CarUltrasonic, p: UltrasonicParams) -> bool:
    total = p.noise + p.dropout + sensors.min_range + sensors.max_range + sensors.resolution
    for mount in sensors.mounts:
        total = total + mount.x + mount.y + mount.yaw
    return is_finite(total) and 1e-6 <= sensors.cycle <= MAX_MAGNITUDE and 0.0 < sensors.half_angle < 1.57


def _stands(p: SceneParams) -> bool:
    total = p.ground_clearance + p.tyre_reach
    for box in p.boxes:
        total = total + box.x + box.y + box.heading + box.length + box.width
        total = total + box.speed_x + box.speed_y + box.moves_at + box.halts_at + box.height
    for kerb in p.kerbs:
        total = total + kerb.x1 + kerb.y1 + kerb.x2 + kerb.y2 + kerb.height
    return is_finite(total)


def _sizes(value: float) -> bool:
    """Return whether ``value`` may be divided by."""
    return 1e-9 <= value <= MAX_MAGNITUDE
