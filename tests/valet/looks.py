"""What a car sees at a place, with a speed, by what its sensors hear."""

import math

from controller_fmu.planning.plan import Piece
from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.gap import Gap, GapLayout
from controller_fmu.valet import sight
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.signals import ValetInput
from modelkit.store import new_store
from modelkit.vocabulary import Pose
from tests.planning.plan_model import Scene
from tests.planning.scenes import take

LONG = 6.0


def look(
    readings: tuple[float, ...],
    pose: Pose,
    piece: Piece,
    speed: float,
    scene: Scene,
    along: bool,
    params: ValetParams,
) -> sight.Sight:
    """Return the sight of a car that hears ``readings`` at ``pose`` with ``speed`` [m/s].

    ``along``: it is on its way into a slot along the road, that lies where it stands.
    """
    inputs = ValetInput(odometry=pose, measured_speed=speed, ultrasonic=readings)
    gap = Gap(GapLayout.ALONG, Pose(), Pose(LONG, 0.0), -0.5 * math.pi, width=LONG) if along else Gap()
    store = new_store(PlanStore)
    take(store, scene)
    return sight.look(store, inputs, piece, gap, params)
