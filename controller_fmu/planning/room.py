"""What room there is where pieces of the path kept begin: a car that turns its wheel on the move may use of it.

On a ramp (``common/ramp.py``) the car is off its direction, and behind it beside its path. So the outline is looked at
as it stands on the ramp, not on the path alone.
"""

import math
from typing import NamedTuple

from controller_fmu.common.ramp import off_behind, on_ramp, ramp_length
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
OF_MARGIN = 0.2
"""Share of the margin that turning the wheel on the move may take: a ramp up to ``MOST`` beside the path."""
MOST = 0.02
"""[m]"""
OF_ROOM = 0.25
"""And of what there is beyond the margin: a ramp up to ``ROOMIEST`` in all."""
ROOMIEST = 0.03
"""[m]"""
SHARES = (1.0, 0.7, 0.5, 0.35, 0.2, 0.1)
"""Of that; the first is taken that leaves enough."""
LEFT = 0.75
"""Share of the margin that is left on a ramp, for what tracking and odometry are off."""
RATE = 1.3
"""How fast [1/m] tracking takes back what a ramp leaves: as e^(-RATE s) (1 + RATE s) over the way s."""
SAME = 1e-6
"""Curvatures nearer than this [1/m] are one."""
TAKEN_BACK = 2.0
"""Way [m] behind a ramp over which the car is looked at."""


def see_room(store: PlanStore, request: Request, task: Task) -> bool:
    """Measure the room about the begin of the next piece of the path kept; returns whether there is one more."""
    piece = store.mark[SEEN]
    task = task._replace(margin=store.measure[KEPT_MARGIN])
    start = Pose(request.start.x - request.goal.x, request.start.y - request.goal.y, request.start.heading)
    if store.kept_speed[piece] > 0.0 or (piece > 0 and store.kept_speed[piece - 1] > 0.0):
        put_room(store, piece, 0.0)
    elif piece == 0:
        put_room(store, piece, _about(store, start, piece, task))
    elif store.kept_way[piece - 1] * store.kept_way[piece] < 0.0:
        put_room(store, piece, _beyond(store, start, piece, task))
    else:
        _put_ramp(store, start, piece, task)
    put_mark(store, SEEN, piece + 1)
    return piece + 1 < store.mark[KEPT_COUNT]


def _about(store: PlanStore, start: Pose, piece: int, task: Task) -> float:
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


class OffPath(NamedTuple):
    """Where a car is whose curvature changes over ramps."""

    lateral: float = 0.0
    """Beside the path, to the left [m]."""
    turned: float = 0.0
    """Off its direction [rad], as the curvature takes it when it goes forward."""


def _put_ramp(store: PlanStore, start: Pose, piece: int, task: Task) -> None:
    """Set how far [m] beside the path a ramp may take the car where a piece begins; 0: it has to stand there."""
    joint = _joint(store, start, piece)
    most = min(ROOMIEST, min(MOST, OF_MARGIN * task.margin) + OF_ROOM * _about(store, start, piece, task))
    if abs(store.kept_k[piece] - store.kept_k[piece - 1]) < SAME:
        put_room(store, piece, most)
        return
    for number in range(len(SHARES)):
        put_room(store, piece, SHARES[number] * most)
        if _is_ramp_free(store, joint, piece, task):
            return
    put_room(store, piece, 0.0)


def _is_ramp_free(store: PlanStore, joint: Pose, piece: int, task: Task) -> bool:
    """Return whether the car keeps enough of the margin on a ramp and behind it, those before counted."""
    direction = sign(store.kept_way[piece])
    past = -0.5 * _ramp(store, piece)
    last = min(_gear_way(store, piece, 1), TAKEN_BACK - past)
    while past <= last:
        at = _along(store, joint, piece, past)
        off = _beside(store, piece, past)
        x = at.x - off.lateral * math.sin(at.heading)
        y = at.y + off.lateral * math.cos(at.heading)
        if clearance(store, Pose(x, y, at.heading + direction * off.turned), task) < LEFT * task.margin:
            return False
        past += EACH
    return True


def _beside(store: PlanStore, piece: int, past: float) -> OffPath:
    """Return where the car is ``past`` [m] behind the begin of a piece, by the ramps up to there in its gear."""
    lateral = 0.0
    turned = 0.0
    way = past
    number = piece
    while number > 0 and store.kept_way[number - 1] * store.kept_way[piece] > 0.0:
        jump = store.kept_k[number] - store.kept_k[number - 1]
        ramp = _ramp(store, number)
        on = way + 0.5 * ramp
        if 0.0 < on < ramp:
            more = on_ramp(jump, ramp, way, way > 0.0)
            lateral += more.lateral
            turned += more.turned
        if 0.0 < ramp <= on:
            behind = RATE * (on - ramp)
            off = off_behind(jump, ramp) * math.exp(-behind)
            lateral += off * (1.0 + behind)
            turned -= off * RATE * behind
        number -= 1
        way += abs(store.kept_way[number])
    return OffPath(lateral, turned)


def _ramp(store: PlanStore, piece: int) -> float:
    """Return the length [m] of the ramp about the begin of a piece, by what it may take the car off."""
    longest = 2.0 * min(_gear_way(store, piece, -1), _gear_way(store, piece, 1))
    return ramp_length(store.kept_room[piece], store.kept_k[piece] - store.kept_k[piece - 1], longest)


def _gear_way(store: PlanStore, piece: int, turn: int) -> float:
    """Return the way [m] in a piece's gear from its begin on (``turn`` 1), or before it (-1), up to a transition."""
    way = 0.0
    number = piece if turn > 0 else piece - 1
    while 0 <= number < store.mark[KEPT_COUNT] and store.kept_way[number] * store.kept_way[piece] > 0.0:
        if store.kept_speed[number] > 0.0:
            return way
        way += abs(store.kept_way[number])
        number += turn
    return way


def _joint(store: PlanStore, start: Pose, piece: int) -> Pose:
    """Return the pose where a piece begins."""
    pose = start
    for number in range(piece):
        pose = drive(pose, store.kept_way[number], store.kept_k[number])
    return pose


def _along(store: PlanStore, joint: Pose, piece: int, past: float) -> Pose:
    """Return the pose on the path ``past`` [m] behind the begin of a piece, or before it, in the same gear."""
    pose = joint
    left = abs(past)
    number = piece if past > 0.0 else piece - 1
    turn = 1 if past > 0.0 else -1
    while left > abs(store.kept_way[number]) and 0 <= number + turn < store.mark[KEPT_COUNT]:
        pose = drive(pose, turn * store.kept_way[number], store.kept_k[number])
        left -= abs(store.kept_way[number])
        number += turn
    return drive(pose, turn * sign(store.kept_way[number]) * left, store.kept_k[number])


def _beyond(store: PlanStore, start: Pose, piece: int, task: Task) -> float:
    """Return how far [m] the piece before may go on, at the margin."""
    pose = _joint(store, start, piece)
    return free_way(store, pose, sign(store.kept_way[piece - 1]), store.kept_k[piece - 1], BEYOND, task)
