"""The slot that a parked car stands in, made of what its sensors hear at standstill: the way out begins with it."""

from controller_fmu.apa.choice import ChosenSide
from controller_fmu.apa.outline import Shape
from controller_fmu.apa.slot import UNSEEN, Kind, Side, Slot, mirror_of
from controller_fmu.common.sensors import HEARD, LEFT_SENSOR, RIGHT_SENSOR
from controller_fmu.common.slot_frame import SlotFrame, to_world
from controller_fmu.interface import ControllerInput, ControllerParams
from modelkit.vocabulary import Pose

STANDS_OUT = 0.2
"""Neighbours are taken to stand out further than the car by so much [m]."""
KERB = 1.5
"""What is heard farther [m] beside the car is no kerb."""
FRONT = 1
REAR = 5


def slot_around(inputs: ControllerInput, car: Shape, params: ControllerParams) -> Slot:
    """Return the parallel slot around a standing car; the road is on the side that the driver chose, else on the left.

    Its neighbours are where the middle sensors hear something, as far out as is likely: what they look like from the
    road is heard on the way.
    """
    right_is_road = inputs.choice.side == ChosenSide.RIGHT
    side = Side.LEFT if right_is_road else Side.RIGHT
    ahead = _nearest(FRONT, inputs)
    behind = _nearest(REAR, inputs)
    beside = _nearest(LEFT_SENSOR if right_is_road else RIGHT_SENSOR, inputs)
    road = _nearest(RIGHT_SENSOR if right_is_road else LEFT_SENSOR, inputs)
    line = car.half_width + STANDS_OUT
    slot = Slot(kind=Kind.PARALLEL, side=side, length=behind + car.rear + car.front + ahead)
    mirror = mirror_of(slot)
    a = to_world(Pose(-car.rear - behind, mirror * line, 0.0), SlotFrame(inputs.odometry, 1.0))
    return slot._replace(
        a=a,
        depth=line + car.half_width + beside if beside < KERB else UNSEEN,
        opposite=road - STANDS_OUT if road < HEARD * params.car.ultrasonic.max_range else UNSEEN,
    )


def _nearest(first: int, inputs: ControllerInput) -> float:
    """Return the nearest distance [m] that two sensors hear: ``first`` and the next one."""
    return min(inputs.ultrasonic[first], inputs.ultrasonic[first + 1])
