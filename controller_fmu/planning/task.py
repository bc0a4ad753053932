"""What is asked of the planner, and what one search is given: poses, a car, a margin, the numbers that steer it."""

import math
from typing import Annotated, NamedTuple

from modelkit.signal import Signal
from modelkit.vocabulary import Pose

CORNERS = 376
CUSP = 2.0
"""Price [m] of a change of direction."""
STEER = 0.5
"""Price [m] of turning the wheel from straight to full lock."""


class Corner(NamedTuple):
    """A corner of a polygon."""

    x: Annotated[float, Signal("m", "x of the corner")] = 0.0
    y: Annotated[float, Signal("m", "y of the corner")] = 0.0
    polygon: Annotated[int, Signal("1", "corners in a row with the same number are one polygon; 0: unused", 0)] = 0


class PlannedCar(NamedTuple):
    """The car's outline about its centre, and what it can steer."""

    ahead: float = 0.0
    """The outline's centre ahead of the rear axle [m]."""
    half_length: float = 0.0
    half_width: float = 0.0
    curvature: float = 0.0
    """Largest curvature of the rear axle's path [1/m]."""


class Dynamics(NamedTuple):
    """How the vehicle drives a path; with a rate of 0 the wheel is taken to turn at rest."""

    wheelbase: float = 0.0
    rate: float = 0.0
    """Of the front wheels [rad/s]."""
    curvature: float = 0.0
    """Largest curvature [1/m] that leaves some of the lock for tracking."""
    speed: float = 0.0
    acceleration: float = 0.0
    deceleration: float = 0.0


class Request(NamedTuple):
    """What is asked for: a path from one pose to another."""

    start: Pose = Pose()
    goal: Pose = Pose()
    car: PlannedCar = PlannedCar()
    margin: float = 0.0
    """Clearance [m] wished for; where it cannot be kept, less is tried."""
    dynamics: Dynamics = Dynamics()


class SearchWindow(NamedTuple):
    """The part of the plane that is searched, in the frame of the task: a square and its two rasters."""

    x0: float
    y0: float
    side: float
    near: float
    """Side [m] of a cell that lists the edges near it."""
    near_count: int
    """Such cells in a row."""
    route: float
    """Side [m] of a cell of the map of ways."""
    route_count: int


class Rung(NamedTuple):
    """One of the searches that are made in turn until one finds a path."""

    also: bool
    """Made even if the one before has found a path; the cheaper is kept."""
    tighter: bool
    """The tree is rooted where the car has less room, at start or goal; else at the other end."""
    share: float
    """Of the margin wished for."""
    cell: float
    """Side [m] of the cells in which one pose stands for all."""
    turn_cell: float
    """The same for headings [rad]."""
    finer: float
    """Cells are finer by this factor near the root."""
    weight: float
    """How much the estimated rest counts against the way driven."""
    shy: float
    """Cost [m] for each node that has been taken up in the same region."""
    most: int
    """Expansions after which the search gives up."""


class Task(NamedTuple):
    """One search: a tree from ``root`` that shall meet ``target``; all in a frame about the goal."""

    root: Pose
    target: Pose
    car: PlannedCar
    window: SearchWindow
    from_goal: bool
    """``root`` is the goal, ``target`` the start."""
    margin: float
    """Clearance [m] that the path keeps."""
    rung: Rung


class Child(NamedTuple):
    """A pose that the tree may grow to, by one line or arc from a node that it has."""

    pose: Pose
    cost: float
    """From the root [m]."""
    way: float
    """From the parent [m], reverse negative."""
    k: float
    """Curvature of that way [1/m]."""
    parent: int


def fastest(car: PlannedCar, curvature: float) -> float:
    """Return how far [m] the fastest point of the outline goes for each metre of the rear axle."""
    k = abs(curvature)
    across = 1.0 + k * car.half_width
    along = k * (abs(car.ahead) + car.half_length)
    return math.sqrt(across * across + along * along)


def drive(pose: Pose, way: float, curvature: float) -> Pose:
    """Return the pose after ``way`` [m] (reverse negative) along an arc or a line."""
    half = 0.5 * way * curvature
    chord = way
    if abs(half) > 1e-9:
        chord = way * math.sin(half) / half
    h = pose.heading + half
    return Pose(pose.x + chord * math.cos(h), pose.y + chord * math.sin(h), h + half)
