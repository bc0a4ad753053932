"""Random scenes with 0 to 20 mm of room at the start, at the goal or where the car replans, and a judge of paths."""

import math
import random
from typing import Any, NamedTuple

from shapely.geometry import Polygon

from controller_fmu.parking.geometry.outline import pose_along_arc
from controller_fmu.parking.planning.planner import PlanningStatus
from controller_fmu.parking.planning.problem import PlanningRequest
from controller_fmu.parking.planning.search_schedule import MIN_MARGIN
from modelkit.vocabulary import Pose
from tests.planning.plan_model import Input, Params
from tests.planning.scenes import CAR, least_clearance, outline_of, poses_along, request_of, scene_of

MOST_ROOM = 0.02
STEP = 0.002
"""Poses of a path that are judged lie so far [m] apart: the outline moves by less than the least margin between two."""
ROUNDING = 1e-4
"""What a pose of the tree is rounded by [m]."""
MOST_CALLS = 400
REFUSALS = (
    PlanningStatus.NO_PATH,
    PlanningStatus.START_BLOCKED,
    PlanningStatus.GOAL_BLOCKED,
    PlanningStatus.MARGIN_TOO_SMALL,
)


class TightScene(NamedTuple):
    """A request among polygons."""

    kind: str
    request: PlanningRequest
    polygons: list[list[tuple[float, float]]]


class Plan(NamedTuple):
    """What the planner answers."""

    status: int
    margin: float
    pieces: list[tuple[float, float]]


def rectangle(pose: Pose, x: float, y: float, length: float, width: float) -> list[tuple[float, float]]:
    """Return a rectangle whose corner of least x and y lies at (x, y), seen from ``pose``."""
    cos, sin = math.cos(pose.heading), math.sin(pose.heading)
    corners = ((x, y), (x + length, y), (x + length, y + width), (x, y + width))
    return [(pose.x + a * cos - b * sin, pose.y + a * sin + b * cos) for a, b in corners]


def beside(pose: Pose, room: float, draw: random.Random) -> list[tuple[float, float]]:
    """Return a box with ``room`` [m] to the outline of a car: at a side, ahead, behind, or off a corner of it."""
    front, rear, side = CAR.centre_ahead + CAR.half_length, CAR.centre_ahead - CAR.half_length, CAR.half_width
    length, width = draw.uniform(0.05, 4.0), draw.uniform(0.05, 2.0)
    place = draw.choice(("left", "right", "ahead", "behind", "corner"))
    if place == "left":
        return rectangle(pose, draw.uniform(rear - length, front), side + room, length, width)
    if place == "right":
        return rectangle(pose, draw.uniform(rear - length, front), -side - room - width, length, width)
    if place == "ahead":
        return rectangle(pose, front + room, draw.uniform(-side - width, side), length, width)
    if place == "behind":
        return rectangle(pose, rear - room - length, draw.uniform(-side - width, side), length, width)
    angle = draw.uniform(0.0, 0.5 * math.pi)
    return rectangle(pose, front + room * math.cos(angle), side + room * math.sin(angle), length, width)


def slot(goal: Pose, room: float, draw: random.Random) -> list[list[tuple[float, float]]]:
    """Return two neighbours and what ends the slot, one of the three with ``room`` [m] to the car at the goal."""
    front, rear, side = CAR.centre_ahead + CAR.half_length, CAR.centre_ahead - CAR.half_length, CAR.half_width
    rooms = [draw.uniform(0.05, 0.6) for _ in range(3)]
    rooms[draw.randrange(3)] = room
    length = front - rear
    return [
        rectangle(goal, rear, side + rooms[0], length, 1.8),
        rectangle(goal, rear, -side - rooms[1] - 1.8, length, 1.8),
        rectangle(goal, rear - rooms[2] - 1.0, -4.0, 1.0, 8.0),
    ]


def draw_scene(seed: int) -> TightScene:
    """Return one of the random scenes: tight at the start, at the goal, at both, or in a slot."""
    draw = random.Random(seed)
    kind = draw.choice(("start", "goal", "both", "slot"))
    goal = Pose(0.0, 0.0, draw.uniform(-math.pi, math.pi))
    away, towards = draw.uniform(3.0, 9.0), draw.uniform(-math.pi, math.pi)
    start = Pose(away * math.cos(towards), away * math.sin(towards), draw.uniform(-math.pi, math.pi))
    if kind == "slot":
        start = pose_along_arc(
            pose_along_arc(goal, draw.uniform(6.0, 8.0), 0.0), draw.uniform(-3.0, 3.0), draw.choice((-0.2, 0.2))
        )
    if kind == "goal" and draw.random() < 0.1:
        start = goal
    polygons = [beside(start, draw.uniform(0.0, MOST_ROOM), draw)] if kind in ("start", "both") else []
    polygons += [beside(goal, draw.uniform(0.0, MOST_ROOM), draw)] if kind in ("goal", "both") else []
    polygons += slot(goal, draw.uniform(0.0, MOST_ROOM), draw) if kind == "slot" else []
    free = [outline_of(pose, CAR).buffer(0.3) for pose in (start, goal)]
    for _ in range(draw.randrange(4)):
        box = rectangle(
            Pose(draw.uniform(-9.0, 9.0), draw.uniform(-9.0, 9.0), draw.uniform(-3.0, 3.0)), 0.0, 0.0, 3.0, 1.5
        )
        if not any(area.intersects(_polygon(box)) for area in free):
            polygons.append(box)
    return TightScene(kind, request_of(start, goal, draw.choice((0.0, 0.05, 0.1, 0.15))), polygons)


def replanned(scene: TightScene, plan: Plan, seed: int) -> TightScene:
    """Return the scene as a car sees it that has left its path: it stands near a new obstacle, somewhere on the way."""
    draw = random.Random(seed)
    poses = poses_along(scene.request.start, plan.pieces, 0.1)
    at = draw.choice(poses)
    start = Pose(at.x, at.y, at.heading + draw.uniform(-0.02, 0.02))
    box = beside(start, draw.uniform(0.0, MOST_ROOM), draw)
    goal_is_free = _polygon(box).distance(outline_of(scene.request.goal, CAR)) > 0.0
    polygons = [*scene.polygons, box] if goal_is_free else scene.polygons
    return TightScene("replanning", scene.request._replace(start=start), polygons)


def planned_by(model: Any, scene: TightScene, each: int = 400) -> Plan:
    """Return what the compiled planner ``model`` answers."""
    model.initialize(Params(scene_of(scene.polygons), scene.request, each))
    for _ in range(MOST_CALLS):
        model.step(Input(), 0)
        if model.outputs.status != PlanningStatus.PLANNING:
            break
    path = model.outputs.path
    return Plan(
        model.outputs.status, path.margin, [(piece.distance, piece.curvature) for piece in path.segments[: path.used]]
    )


def clearance_along(scene: TightScene, plan: Plan) -> float:
    """Return the least distance [m] to any polygon along a path, by shapely."""
    poses = poses_along(scene.request.start, plan.pieces, STEP)
    return least_clearance(poses, scene.polygons, CAR) if scene.polygons else math.inf


def mistake_of(scene: TightScene, plan: Plan) -> str:
    """Return what is wrong with an answer: a path keeps half its margin and ends at the goal, or there is a reason."""
    if plan.status != PlanningStatus.PLANNED:
        known = plan.status in REFUSALS
        return "" if known and not plan.pieces else f"no path and no reason: status {plan.status}"
    if plan.margin < MIN_MARGIN:
        return f"margin {plan.margin} m"
    clear = clearance_along(scene, plan)
    if clear < 0.5 * plan.margin - ROUNDING:
        return f"clearance {clear} m with a margin of {plan.margin} m"
    end, goal = poses_along(scene.request.start, plan.pieces)[-1], scene.request.goal
    off = math.hypot(end.x - goal.x, end.y - goal.y)
    return f"ends {off} m from the goal" if off > ROUNDING else ""


def _polygon(corners: list[tuple[float, float]]) -> Any:
    return Polygon(corners)
