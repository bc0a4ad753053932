"""What is asked of the surroundings while the car parks: the guard's sight, the rest of the move, the last word."""

import math
from typing import NamedTuple

from controller_fmu.apa.around.closing import without_lost
from controller_fmu.apa.around.course import HeldCourse
from controller_fmu.apa.around.guard import GuardState, Sight, watch_way
from controller_fmu.apa.around.local_map import LocalMap
from controller_fmu.apa.around.near import NEARER
from controller_fmu.apa.around.row import is_certain, is_heard, is_in_the_middle, line_unsure, without_gone
from controller_fmu.apa.around.shifted import Shifts
from controller_fmu.apa.hearing.mute import SLOWLY, is_waited_for
from controller_fmu.apa.outline import Shape, clearance, outline_rate, sure_steps
from controller_fmu.apa.params import ApaSystemParams
from controller_fmu.apa.signals import ApaInput
from controller_fmu.apa.slot import Kind, Site, Slot, mirror_of, stands_out_by
from controller_fmu.apa.tracking import Tracked
from controller_fmu.apa.ways.move import Move, point_at
from controller_fmu.common.slot_frame import SlotFrame, to_slot, to_world
from modelkit.vocabulary import Gear, Pose

DOUBT = 0.5
"""The line between the neighbours' corners is taken to lie further in by this share of its standard deviation,"""
DOUBT_AT_FIRST = 1.2
"""and by this beside a perpendicular slot, as long as a way leads deeper."""
ROLLS = 0.1
"""A car in the move's gear that goes faster [m/s] the other way slips, or rolls down a slope, and is stopped."""
LOOK = 0.2
LOOKS = 6
"""The rest of a move is looked at every so much [m], so many times."""


class Around(NamedTuple):
    """What the assist knows of what stands around it."""

    slot: Slot = Slot()
    """The one chosen."""
    map: LocalMap = LocalMap()
    guard: GuardState = GuardState()
    """What the guard has heard."""
    shifts: Shifts = Shifts()
    """Neighbours who seem to stand elsewhere than on the map."""
    mute_ns: int = 0
    """Since when a sensor tells nothing [ns]."""


def shape_of(params: ApaSystemParams) -> Shape:
    """Return the car as the planner sees it."""
    car = params.car
    plan = params.apa.plan
    lock = math.tan(car.steering.angle_limit / car.steering.ratio)
    return Shape(
        front=car.wheelbase + car.front_overhang,
        rear=car.rear_overhang,
        half_width=0.5 * car.width,
        curvature=min(plan.curvature_share * lock / car.wheelbase, plan.curvature_limit),
        ramp=plan.ramp,
    )


class Settled(NamedTuple):
    """Whether a car that stands as planned is parked: neighbours are heard on both sides, it is in the slot."""

    surely: bool = False
    enough: bool = False
    """It is so if no way leads deeper."""


def settled_in(inputs: ApaInput, around: Around, params: ApaSystemParams) -> Settled:
    """Return whether a car that stands as planned is parked."""
    slot = around.slot
    pose = to_slot(inputs.odometry, SlotFrame(slot.a, mirror_of(slot)))
    spare = params.apa.end.out - stands_out_by(pose, slot, shape_of(params))
    unsure = line_unsure(around.map)
    sure = is_sure(inputs, around, params)
    doubt = DOUBT_AT_FIRST if slot.kind == Kind.PERPENDICULAR else DOUBT
    return Settled(sure and spare >= doubt * unsure, sure and spare >= DOUBT * unsure)


def is_sure(inputs: ApaInput, around: Around, params: ApaSystemParams) -> bool:
    """Return whether both neighbours are where the map has them, and the sensors do not contradict it."""
    heard = inputs.ultrasonic
    last = without_lost(heard, around.guard.tracks)
    told = is_heard(around.map, last, params) and is_in_the_middle(around.map, last, params)
    return told and is_certain(without_gone(around.map, around.guard.tracks, heard, params), params.apa.map)


def is_rest_free(
    move: Move, tracked: Tracked, site: Site, bare: Site, leads_away: bool, params: ApaSystemParams
) -> bool:
    """Return whether the rest of a move, as far as it is looked at, stays clear of what the map has now.

    ``bare``: the slot without margins. The car is as far beside its path as it is now. A move that ``leads_away``, as
    the first one in and those out, may begin near to something.
    """
    car = shape_of(params)
    gap = params.apa.guard.gap
    off = tracked.lateral_error
    least = gap
    if leads_away:
        now = point_at(move, tracked.way).pose
        least = min(gap, clearance(_beside(now, off, site, bare), car, bare.obstacles, gap) - NEARER)
    moved = LOOK * outline_rate(car.curvature, car._replace(half_width=car.half_width + abs(off)))
    sure = 0
    for number in range(1, LOOKS + 1):
        way = tracked.way + LOOK * number
        if way > tracked.way + tracked.left:
            return True
        if sure > 0:
            sure -= 1
        else:
            free = clearance(_beside(point_at(move, way).pose, off, site, bare), car, bare.obstacles, gap)
            if free < least:
                return False
            sure = sure_steps(free - gap, moved)
    return True


def _beside(at: Pose, off: float, site: Site, bare: Site) -> Pose:
    """Return the pose, in bare's frame, of a car ``off`` [m] to the left of ``at`` (site's frame)."""
    pose = Pose(at.x - off * math.sin(at.heading), at.y + off * math.cos(at.heading), at.heading)
    return to_slot(to_world(pose, site.frame), bare.frame)


def sight_of(direction: int, bare: Site, around: Around, inputs: ApaInput, params: ApaSystemParams) -> Sight:
    """Return what the guard says to driving in ``direction`` with the wheels as they are; ``bare``: without margins."""
    in_gear = inputs.gear == (Gear.REVERSE if direction < 0 else Gear.DRIVE)
    if in_gear and direction * inputs.measured_speed < -ROLLS:
        return Sight(0.0, True, True)
    if is_waited_for(around.mute_ns, params.apa.sensors):
        return Sight(0.0, True, True)
    front = bare.frame.mirror * inputs.steering_wheel_angle / params.car.steering.ratio
    course = HeldCourse(
        pose=to_slot(inputs.odometry, bare.frame),
        direction=direction,
        curvature=math.tan(front) / params.car.wheelbase,
        speed=inputs.measured_speed,
        car=shape_of(params),
    )
    on_map = around.map._replace(pose=to_slot(inputs.odometry, around.map.frame))
    sight = watch_way(around.guard, inputs.ultrasonic, on_map, bare.obstacles, course, params)
    return sight._replace(speed=min(sight.speed, SLOWLY)) if around.mute_ns > 0 else sight
