"""What a car sees at a place, with a speed, by what its sensors hear."""

from controller_fmu.interface import ControllerInput
from controller_fmu.planning.plan import Piece
from controller_fmu.planning.task import Scene
from controller_fmu.valet import sight
from controller_fmu.valet.params import ValetParams
from modelkit.vocabulary import Pose


def look(
    readings: tuple[float, ...],
    pose: Pose,
    piece: Piece,
    speed: float,
    scene: Scene,
    between: bool,
    params: ValetParams,
) -> sight.Sight:
    """Return the sight of a car that hears ``readings`` at ``pose`` with ``speed`` [m/s]."""
    inputs = ControllerInput(odometry=pose, measured_speed=speed, ultrasonic=readings)
    return sight.look(inputs, piece, scene, between, params)
