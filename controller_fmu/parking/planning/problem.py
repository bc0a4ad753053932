"""The request to the planner, and the problem of one search: poses, a car, a margin, costs and resolution."""

from typing import NamedTuple

from controller_fmu.parking.geometry.outline import VehicleOutline
from modelkit.vocabulary import Pose

CUSP_COST = 2.0
"""Cost [m] of a change of direction."""
STEERING_COST = 0.5
"""Cost [m] of turning the wheel from straight to full lock."""


class PlanningRequest(NamedTuple):
    """Request for a path from one pose to another."""

    start: Pose = Pose()
    goal: Pose = Pose()
    car: VehicleOutline = VehicleOutline()
    margin: float = 0.0
    """Desired clearance [m]; where it cannot be kept, less is tried."""
    max_cusps: int = 0
    """Changes of direction of a path that is taken."""
    has_map: bool = False
    """The polygons of the given map are obstacles, too."""
    run_in: float = 0.0
    """Length [m] of the straight line with which a path ends, reverse negative."""


class SearchGrid(NamedTuple):
    """Square cells whose sides are ``cell`` [m] long, ``row_cells`` in a row."""

    cell: float
    row_cells: int


class SearchRegion(NamedTuple):
    """The part of the plane that is searched, in the frame of the task: a square [m] and its two grids."""

    x0: float
    y0: float
    side: float
    edge_grid: SearchGrid
    """Its cells list the edges near them."""
    cost_to_go: SearchGrid


class SearchResolution(NamedTuple):
    """How finely a search distinguishes poses, and how greedily it heads for the target."""

    cell: float
    """Side [m] of the cells in which one pose stands for all."""
    heading_cell: float
    """The same for headings [rad]."""
    refinement: float
    """Cells are finer by this factor near the root."""
    heuristic_weight: float
    """Factor of the estimated cost to go, against the cost so far."""
    crowding_cost: float
    """Cost [m] for each node that has been expanded in the same region."""


class SearchStage(NamedTuple):
    """One of the searches that are made in turn until one finds a path."""

    resolution: SearchResolution
    margin_fraction: float
    """Of the desired margin."""
    max_expansions: int
    """Expansions after which the search gives up."""
    always: bool = False
    """Made even if the one before has found a path; the cheaper is kept."""
    root_at_tighter_end: bool = True
    """The tree is rooted where the car has less room, at start or goal; else at the other end."""


class SearchProblem(NamedTuple):
    """One search: a tree from ``root`` that shall meet ``target``; all in a frame about the goal."""

    root: Pose
    target: Pose
    car: VehicleOutline
    region: SearchRegion
    from_goal: bool
    """``root`` is the goal, ``target`` the start."""
    margin: float
    """Clearance [m] that the path keeps."""
    stage: SearchStage


class Successor(NamedTuple):
    """A pose that the tree may grow to, by one line or arc from a node that it has."""

    pose: Pose
    cost: float
    """From the root [m]."""
    distance: float
    """From the parent [m], reverse negative."""
    curvature: float
    """Curvature of that distance [1/m]."""
    parent: int
