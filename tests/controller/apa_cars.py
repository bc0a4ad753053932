"""Cars, slots and starts for the tests of the parking assist."""

import math

from controller_fmu.apa.outline import Shape
from controller_fmu.apa.slot import Kind, Margins, Site, Slot, site_of
from controller_fmu.apa.ways.move import Move, end_of
from controller_fmu.apa.ways.planner import NOTHING, SEARCHING, new_search, search_on
from controller_fmu.common.slot_frame import to_slot
from modelkit.vocabulary import Pose

MARGINS = Margins(0.15, 0.08, 0.0)
CARS = {
    "small": (2.405, 0.8, 0.6, 1.65, 4.166),
    "middle": (2.62, 0.966, 0.85, 1.82, 4.8),
    "large": (2.595, 0.9, 1.0, 1.674, 5.0),
}
"""Wheelbase, front overhang, rear overhang, width, smallest turning radius [m]."""


def shape_of(name: str) -> Shape:
    wheelbase, front, rear, width, radius = CARS[name]
    return Shape(wheelbase + front, rear, 0.5 * width, 0.95 / radius, 0.8)


def iso_slot(car: Shape, kind: int, extra: float, side: int = 0) -> Slot:
    """Return the shortest (narrowest) slot of ISO 16787 and ``extra`` [m], at the world's origin."""
    length = car.front + car.rear
    if kind == Kind.PARALLEL:
        shortest = length + 1.0 if length < 4.0 else 1.25 * length
        return Slot(Kind.PARALLEL, side, Pose(0.0, 0.0, 0.0), shortest + extra, 0.0, 2.0 * car.half_width + 0.4)
    return Slot(Kind.PERPENDICULAR, side, Pose(0.0, 0.0, 0.0), 2.0 * car.half_width + 1.2 + extra, 0.0, length + 0.5)


def start_of(slot: Slot, site: Site, car: Shape, past_b: float, beside: float, heading: float) -> Pose:
    """Return a start on the road, in the frame of the target: rear axle ``past_b`` beyond corner B."""
    mirror = site.frame.mirror
    pose = Pose(slot.length + past_b, mirror * (beside + car.half_width), mirror * heading)
    return to_slot(pose, site.frame)


def park_in_thought(start: Pose, site: Site, car: Shape) -> tuple[list[Move], Pose]:
    """Return the moves (each driven exactly) and the last pose; no moves if nothing was found."""
    pose = start
    moves: list[Move] = []
    for _ in range(12):
        if math.hypot(pose.y, pose.heading) < 0.01 and site.x_low - 1e-6 <= pose.x <= site.x_high + 1e-6:
            return moves, pose
        search = new_search(pose)
        while search.status == SEARCHING:
            search = search_on(search, site, car, 50)
        if search.status == NOTHING:
            return [], pose
        moves.append(search.move)
        pose = end_of(search.move)
    return [], pose


def slot_and_site(car: Shape, kind: int, extra: float, side: int = 0) -> tuple[Slot, Site]:
    slot = iso_slot(car, kind, extra, side)
    return slot, site_of(slot, car, MARGINS)
