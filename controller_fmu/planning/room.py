"""What room there is, beyond its margin, where pieces of the path kept begin: a car that rolls may use of it."""

from controller_fmu.planning.clearance import SIGHT, clearance, free_way
from controller_fmu.planning.plan_store import KEPT_COUNT, KEPT_MARGIN, SEEN, PlanStore, put_mark, put_room
from controller_fmu.planning.task import Request, Task, drive
from modelkit.maths import sign
from modelkit.vocabulary import Pose

REACH = 1.25
"""Way [m] before and behind where a piece begins along which the car is looked at."""
EACH = 0.125
"""Way [m] from one look to the next."""
BEYOND = 0.2
"""Looked for no farther [m] beyond a change of gear."""


def see_room(store: PlanStore, request: Request, task: Task) -> bool:
    """Measure the room about the begin of the next piece of the path kept; returns whether there is one more."""
    piece = store.mark[SEEN]
    task = task._replace(margin=store.measure[KEPT_MARGIN])
    start = Pose(request.start.x - request.goal.x, request.start.y - request.goal.y, request.start.heading)
    turns_round = piece > 0 and store.kept_way[piece - 1] * store.kept_way[piece] < 0.0
    put_room(store, piece, _beyond(store, start, piece, task) if turns_round else _beside(store, start, piece, task))
    put_mark(store, SEEN, piece + 1)
    return piece + 1 < store.mark[KEPT_COUNT]


def _beside(store: PlanStore, start: Pose, piece: int, task: Task) -> float:
    """Return the least clearance [m] beyond the margin within ``REACH`` of where a piece begins."""
    joint = 0.0
    for number in range(piece):
        joint += abs(store.kept_way[number])
    least = clearance(store, start, task) if piece == 0 else SIGHT
    pose = start
    at = 0.0
    for number in range(store.mark[KEPT_COUNT]):
        way = store.kept_way[number]
        place = max(0.0, joint - REACH - at)
        last = min(abs(way), joint + REACH - at)
        while place <= last:
            there = drive(pose, sign(way) * place, store.kept_k[number])
            least = min(least, clearance(store, there, task))
            place += EACH
        at += abs(way)
        pose = drive(pose, way, store.kept_k[number])
    return max(0.0, least - task.margin)


def _beyond(store: PlanStore, start: Pose, piece: int, task: Task) -> float:
    """Return how far [m] the piece before may go on, at the margin."""
    pose = start
    for number in range(piece):
        pose = drive(pose, store.kept_way[number], store.kept_k[number])
    return free_way(store, pose, sign(store.kept_way[piece - 1]), store.kept_k[piece - 1], BEYOND, task)
