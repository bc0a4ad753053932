"""A person at pedals and lever: what the pedals ask of the wheels, and how the car without tyres obeys them.

    drive = along the gear * accelerator * drive_force_limit + creep      brake = brake * brake_force_limit

The gear follows the lever at standstill. While the controller has the speed, accelerator and lever do
nothing and the brake stops the car. Steering, the assist's switch and taking over stay as they are.
"""

from modelkit.maths import clamp, move_towards
from modelkit.vocabulary import Gear
from vehicle_fmu.bodies.chassis import GRAVITY_ACCELERATION, ChassisParams
from vehicle_fmu.drivetrain import SELECTOR_SPEED, Pedals, Rolling, along, creep, lag
from vehicle_fmu.effort import Effort
from vehicle_fmu.interface import DriveParams, ManualInput, VehicleInput

PRESSED_BRAKE_PEDAL = 0.02
"""From here on a brake pedal counts as pressed."""


def has_pedals(inputs: VehicleInput) -> bool:
    """Return whether a person drives: at the pedals, and the controller has not the speed."""
    return inputs.manual.active and not (inputs.speed_control_active or inputs.force_control_active)


def stops_controller(inputs: VehicleInput) -> bool:
    """Return whether a person brakes a car whose speed the controller has."""
    return inputs.manual.active and not has_pedals(inputs) and inputs.manual.brake > PRESSED_BRAKE_PEDAL


def lever_gear(manual: ManualInput, gear: int, speed: float) -> int:
    """Return the gear the lever asks for: that engaged while the car moves."""
    return manual.lever if abs(speed) < SELECTOR_SPEED else gear


def tread(pedals: Pedals, manual: ManualInput, car: Rolling, p: DriveParams, h: float) -> Pedals:
    """Return the pedals ``h`` [s] later under a person's feet; the aim is the car's speed, for the next driver."""
    engaged = car.gear == Gear.DRIVE or car.gear == Gear.REVERSE
    push = along(car.gear) * clamp(manual.accelerator, 0.0, 1.0) * p.drive_force_limit if engaged else 0.0
    brake = clamp(manual.brake, 0.0, 1.0) * p.brake_force_limit
    return Pedals(car.speed, effort=lag(pedals.effort, push + creep(car, p), brake, p, h))


def roll(speed: float, effort: Effort, chassis: ChassisParams, h: float) -> float:
    """Return the speed [m/s] ``h`` [s] later of a car without tyres on a level road: brake and rolling resistance
    stop it and push it no further."""
    stopping = effort.brake / chassis.mass + chassis.rolling_resistance * GRAVITY_ACCELERATION
    return move_towards(speed + h * effort.drive / chassis.mass, 0.0, stopping * h)
