"""Ways out with everything known: whether one exists, and how far the car can drive on where it ended."""

import math

from controller_fmu.apa.out.limits import MOVES
from controller_fmu.apa.out.pull_out import OutSearch, plan_out
from controller_fmu.apa.outline import Box, Obstacles, Shape, clearance, grown
from controller_fmu.apa.slot import Kind, Site
from controller_fmu.apa.ways.planner import FOUND, SEARCHING, PlanSearch
from controller_fmu.common.slot_frame import SlotFrame, to_slot
from modelkit.car import largest_curvature
from modelkit.vocabulary import Pose
from orchestrator.studies.parking.cases import CARS
from orchestrator.studies.parking.pull_out_cases import PullOutCase, start_of, things_of

MIN_CLEARANCE = 0.05
"""Clearance [m] of a way that counts, or as much as the car has where it stands."""


def moves_out(case: PullOutCase) -> int:
    """Return how many moves the planner needs that knows what stands there, with the whole lock; 0: it finds no way."""
    site, car = site_known(case, MIN_CLEARANCE), shape_known(case)
    start = to_slot(Pose(*start_of(case)), site.frame)
    search, plan = OutSearch(), PlanSearch(SEARCHING)
    while plan.status == SEARCHING:
        search, plan = plan_out(search, start, site, car, MOVES[-1])
    return plan.moves if plan.status == FOUND else 0


def shape_known(case: PullOutCase) -> Shape:
    """Return the outline of the car of a case, with its whole lock."""
    car = CARS[case.car]
    return Shape(car.wheelbase + car.front_overhang, car.rear_overhang, 0.5 * car.width, largest_curvature(car), 0.8)


def site_known(case: PullOutCase, margin: float) -> Site:
    """Return what stands there, grown by a margin [m], in the frame that the planner has for such a slot."""
    things = things_of(case)
    across = case.kind == Kind.PERPENDICULAR
    boxes = {}
    for name, item in things.items():
        box = Box(item.y0, item.y1, -item.x1, -item.x0) if across else Box(item.x0, item.x1, item.y0, item.y1)
        boxes[name] = grown(box, margin)
    beside = boxes.get("wall", boxes.get("kerb", Box()))
    obstacles = Obstacles(boxes["first"], boxes["second"], beside, boxes.get("across", Box()))
    frame = SlotFrame(Pose(0.0, 0.0, 0.5 * math.pi if across else 0.0), 1.0)
    return Site(case.kind, frame, obstacles)


def free_ahead(case: PullOutCase, end: Pose, most: float = 5.0) -> float:
    """Return how far [m] a car that ended at ``end`` (scene) could drive straight on past its neighbours, ``most``."""
    site, car = site_known(case, 0.0), shape_known(case)
    at = to_slot(Pose(end.x, case.side * end.y, case.side * end.heading), site.frame)
    row = Obstacles(site.obstacles.behind, site.obstacles.ahead)
    way = 0.0
    while way < most and clearance(at, car._replace(front=car.front + way), row, 0.0) > 0.0:
        way += 0.1
    return way
