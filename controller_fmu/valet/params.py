"""What can be set of the valet: the car, where to go, what stands there, how it plans, drives and gives up."""

from enum import IntEnum
from math import pi
from typing import Annotated, NamedTuple

from controller_fmu.common.external_slot import SlotKind
from controller_fmu.common.params import LimitParams, ThresholdParams
from controller_fmu.planning.task import Corner
from modelkit.car import Car
from modelkit.signal import Group, Role, Signal
from modelkit.vocabulary import ANYWHERE, Pose

HOUSE = "project default; the source states none"
MAP_CORNERS = 360


class GivenSlot(NamedTuple):
    """A slot from outside: from a camera, a map or a test bench."""

    kind: Annotated[int, Signal("1", "how to stand in it; none: at the target", states=SlotKind)] = SlotKind.NONE
    ax: Annotated[float, Signal("m", "x of corner A, where the slot opens to the road", -1e8, 1e8)] = 0.0
    ay: Annotated[float, Signal("m", "y of corner A", -1e8, 1e8)] = 0.0
    bx: Annotated[float, Signal("m", "x of corner B, the other end of the opening", -1e8, 1e8)] = 0.0
    by: Annotated[float, Signal("m", "y of corner B", -1e8, 1e8)] = 0.0
    heading: Annotated[float, Signal("rad", "direction from the opening into the slot", -100.0, 100.0)] = 0.0
    depth: Annotated[float, Signal("m", "from the opening to the slot's end along its heading", 0.0, 100.0)] = 5.0


class SlotWish(IntEnum):
    """Which slots the driver wants."""

    ANY = 0
    """Across the road tail in, but nose in where the slot leads on along the way."""
    PARALLEL = 1
    TAIL_IN = 2
    NOSE_IN = 3


class WishedSide(IntEnum):
    """On which side of the road."""

    ANY = 0
    RIGHT = 1
    LEFT = 2


class ValetSearchParams(NamedTuple):
    """Looking for a slot while the driver drives past."""

    active: Annotated[bool, Signal("1", "looks for a slot when the driver switches on; else drives to the target")] = (
        False
    )
    wish: Annotated[int, Signal("1", "which slots are wanted", states=SlotWish)] = SlotWish.ANY
    side: Annotated[int, Signal("1", "on which side", states=WishedSide)] = WishedSide.ANY
    open_ended: Annotated[bool, Signal("1", "one neighbour will do")] = False
    speed: Annotated[float, Signal("m/s", "largest speed of the search", 0.1, 10.0, HOUSE)] = 10.0 / 3.6
    way: Annotated[float, Signal("m", "longest way searched", 1.0, 1000.0, HOUSE)] = 60.0
    room_along: Annotated[float, Signal("m", "slot along the road over the car's length", 0.2, 10.0, HOUSE)] = 0.5
    room_across: Annotated[float, Signal("m", "slot across the road over the car's width", 0.2, 10.0, HOUSE)] = 0.4
    stand_out: Annotated[float, Signal("m", "the car may stand so far out of a shallow slot", 0.0, 3.0, HOUSE)] = 0.5
    behind: Annotated[float, Signal("m", "distance to what a slot across the road ends at", 0.05, 2.0, HOUSE)] = 0.25
    kerb_least: Annotated[float, Signal("m", "distance to a kerb beside", 0.05, 1.0, "GB/T 41630")] = 0.15
    kerb_most: Annotated[float, Signal("m", "the same, at most", 0.05, 1.0, "GB/T 41630")] = 0.25
    confirm: Annotated[float, Signal("s", "longest wait for the driver", 0.1, 3600.0, HOUSE)] = 60.0


class ValetPlanParams(NamedTuple):
    """How the way is planned."""

    margin: Annotated[float, Signal("m", "clearance wished for; less if it must be", 0.0, 2.0, HOUSE)] = 0.15
    curvature_share: Annotated[float, Signal("1", "planned curvature over the car's largest", 0.3, 1.0, HOUSE)] = 0.95
    at_once: Annotated[int, Signal("1", "steps of the search in one sample", 1, 1000, HOUSE)] = 10
    steps: Annotated[int, Signal("1", "steps after which the search gives up", 1, 1_000_000, HOUSE)] = 60_000
    plans: Annotated[int, Signal("1", "most plans of one drive", 1, 100, HOUSE)] = 8


class ValetDriveParams(NamedTuple):
    """How the path is driven and tracked."""

    k1: Annotated[float, Signal("1/m2", "path tracking, distance gain", 0.0, 100.0, HOUSE)] = 2.0
    k2: Annotated[float, Signal("1/m", "path tracking, heading gain", 0.0, 100.0, HOUSE)] = 2.4
    speed: Annotated[float, Signal("m/s", "largest speed", 0.1, 3.0, HOUSE)] = 0.8
    creep: Annotated[float, Signal("m/s", "speed at the end of a piece of path", 0.01, 0.5, HOUSE)] = 0.08
    deceleration: Annotated[float, Signal("m/s2", "planned towards the end of a piece", 0.1, 5.0, HOUSE)] = 0.5
    brake: Annotated[float, Signal("m/s2", "deceleration when braking to standstill", 0.1, 10.0, HOUSE)] = 2.0
    delay: Annotated[float, Signal("s", "from a brake request to its effect", 0.0, 2.0, HOUSE)] = 0.03
    rolling: Annotated[
        float, Signal("m", "off the path where the wheel turns on the move; 0: it turns at rest", 0.0, 0.2, HOUSE)
    ] = 0.02
    wheel_delay: Annotated[float, Signal("s", "from a request to the wheel to its effect", 0.0, 1.0, HOUSE)] = 0.06


class ValetGuardParams(NamedTuple):
    """When the way is left, or blocked by something that the map does not have."""

    corridor: Annotated[float, Signal("m", "off the path: stop and plan anew", 0.01, 5.0, HOUSE)] = 0.1
    corridor_heading: Annotated[float, Signal("rad", "off the path's direction: the same", 0.01, 1.5, HOUSE)] = 0.12
    surprise: Annotated[float, Signal("m", "heard so much nearer than the map says: unknown", 0.01, 2.0, HOUSE)] = 0.3
    gap: Annotated[float, Signal("m", "distance kept to something unknown", 0.0, 2.0, HOUSE)] = 0.5
    wait: Annotated[float, Signal("s", "wait for something unknown to go away", 0.0, 600.0, HOUSE)] = 3.0


class ValetEndParams(NamedTuple):
    """How near to the goal the drive may end; if it does not, the rest is planned anew."""

    position: Annotated[float, Signal("m", "along and across the goal's heading", 0.001, 1.0, HOUSE)] = 0.08
    heading: Annotated[float, Signal("rad", "heading", 0.001, 0.5, HOUSE)] = 2.0 * pi / 180.0


class ValetSystem(IntEnum):
    """Its value of ``controller.system``."""

    VALET = 7
    """To any pose among the polygons of a map; a controller of its own."""
    VALET_LARGE = 10
    """The same with a map of 2,048 corners, of 360 otherwise; a controller of its own."""


class ValetParams(NamedTuple):
    """The valet's parameters; those that other systems have too are called as theirs."""

    system: Annotated[int, Signal("1", "which system", states=ValetSystem)] = ValetSystem.VALET
    sample_time: Annotated[float, Signal("s", "controller's sample time, whole nanoseconds", 1e-4, 1.0, HOUSE)] = 0.01
    car: Annotated[Car, Group("vehicle model used by the controller")] = Car()
    target: Annotated[Pose, Group("pose of the rear-axle midpoint to park at", ANYWHERE), Role.TUNABLE] = Pose(
        -7.608, -3.056, 0.0
    )
    slot: Annotated[GivenSlot, Role.TUNABLE] = GivenSlot()
    threshold: Annotated[ThresholdParams, Role.TUNABLE] = ThresholdParams()
    limit: Annotated[LimitParams, Role.TUNABLE] = LimitParams(manoeuvres=30, duration=600.0)
    search: ValetSearchParams = ValetSearchParams()
    plan: Annotated[ValetPlanParams, Role.TUNABLE] = ValetPlanParams()
    drive: Annotated[ValetDriveParams, Role.TUNABLE] = ValetDriveParams()
    guard: Annotated[ValetGuardParams, Role.TUNABLE] = ValetGuardParams()
    end: Annotated[ValetEndParams, Role.TUNABLE] = ValetEndParams()
    map: Annotated[
        tuple[Corner, ...], Role.TUNABLE, Group("corners of the polygons that stand there", (("m", 1e8), ("1", 1e6)))
    ] = (Corner(),) * MAP_CORNERS
