"""A person at pedals and lever: what the pedals ask of the wheels, and how the car without tyres obeys them.

    drive = along the gear * accelerator * drive_force_limit + creep      brake = brake * brake_force_limit

The gear follows the lever at standstill. While the controller has the speed, accelerator and lever do
nothing and the brake stops the car. Steering, the assist's switch and taking over stay as they are.
"""

from modelkit.maths import clamp, move_towards
from modelkit.vocabulary import Gear
from vehicle_fmu.bodies.chassis import GRAVITY, ChassisParams
from vehicle_fmu.drivetrain import STANDSTILL, Pedals, Rolling, along, creep, lag
from vehicle_fmu.effort import Effort
from vehicle_fmu.interface import DriveParams, PersonInput, VehicleInput

PRESSED = 0.02
"""From here on a brake pedal counts as pressed."""


def has_pedals(inputs: VehicleInput) -> bool:
    """Return whether a person drives: at the pedals, and the controller has not the speed."""
    return inputs.person.drives and not (inputs.speed_control_active or inputs.force_control_active)


def stops_controller(inputs: VehicleInput) -> bool:
    """Return whether a person brakes a car whose speed the controller has."""
    return inputs.person.drives and not has_pedals(inputs) and inputs.person.brake > PRESSED


def lever_gear(person: PersonInput, gear: int, speed: float) -> int:
    """Return the gear the lever asks for: that engaged while the car moves."""
    return person.lever if abs(speed) < STANDSTILL else gear


def tread(pedals: Pedals, person: PersonInput, car: Rolling, p: DriveParams, h: float) -> Pedals:
    """Return the pedals ``h`` [s] later under a person's feet; the aim is the car's speed, for who comes after."""
    engaged = car.gear == Gear.DRIVE or car.gear == Gear.REVERSE
    push = along(car.gear) * clamp(person.accelerator, 0.0, 1.0) * p.drive_force_limit if engaged else 0.0
    brake = clamp(person.brake, 0.0, 1.0) * p.brake_force_limit
    return Pedals(car.speed, effort=lag(pedals.effort, push + creep(car, p), brake, p, h))


def roll(speed: float, effort: Effort, chassis: ChassisParams, h: float) -> float:
    """Return the speed [m/s] ``h`` [s] later of a car without tyres on a level road: brake and rolling resistance
    stop it and push it no further."""
    stopping = effort.brake / chassis.mass + chassis.rolling_resistance * GRAVITY
    return move_towards(speed + h * effort.drive / chassis.mass, 0.0, stopping * h)
