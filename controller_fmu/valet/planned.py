"""The valet plans: its search at each sample, for the goal it was told or the slot it found."""

from controller_fmu.common.external_slot import SlotKind, is_usable_slot
from controller_fmu.interface import Reason
from controller_fmu.planning.plan import (
    NO_ROOM,
    NO_WAY,
    PATH,
    PLANNED,
    PLANNING,
    TOO_MANY_EDGES,
    Path,
    Piece,
    path_of,
    search_on,
    status_of,
)
from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.planning.stretch import trimmed
from controller_fmu.planning.task import Request
from controller_fmu.sensing.around import lay_end
from controller_fmu.sensing.gap import DEEP, Gap, GapLayout
from controller_fmu.valet.chart import Step
from controller_fmu.valet.found.corrected import corrected, turned_gap
from controller_fmu.valet.found.nearby import forget_under, lay_nearby
from controller_fmu.valet.found.way_back import WayBack, path_back
from controller_fmu.valet.given import as_parameter
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.sight import Sight, take_scene
from controller_fmu.valet.signals import ValetInput
from controller_fmu.valet.slot import body_of, dynamics_of, goal_in, goal_of, is_in_place, stands_in_road
from controller_fmu.valet.state import ValetState
from modelkit.vocabulary import Pose

LEAST_MARGIN = 0.03
"""A way into a slot that was found that comes nearer [m] to what was heard is not driven: odometry drifts more."""
MIN_DRIVEN_MARGIN = 0.01
"""A path that leaves less [m] is not driven: exact odometry and a kinematic body leave it by up to 8 mm."""
MIN_REPLANNED_MARGIN = 0.03
"""A path planned anew keeps the first path's margin or so much [m]: the car stops up to 2 cm off its path."""
AT_GOAL = Path(1, 0.0, 0.0, (Piece(),) * PATH)
"""The path of a car that stands at its goal: one piece without a way."""


def planned_on(store: PlanStore, state: ValetState, inputs: ValetInput, params: ValetParams) -> ValetState:
    """Return the valet after some more steps of the search; it begins when the car stands."""
    if abs(inputs.measured_speed) > params.threshold.standstill:
        return state._replace(searched=0)
    request = state.request
    if not is_usable_slot(state.told):
        return state._replace(reason=Reason.BAD_INPUT)
    if state.searched == 0:
        pose = inputs.odometry
        goal = goal_of(params, as_parameter(state.told, params.slot), pose)
        if params.search.active:
            gap = state.search.gap
            forget_under(store, state.nearby, pose, params)
            now = gap_now(store, state, params)
            goal = goal_now(state, now, params)
            if stands_in_road(now, params) > params.search.stand_out:
                return state._replace(reason=Reason.SLOT_TOO_SHALLOW)
            if gap.depth < DEEP:
                lay_end(store, gap, state.search.lines)
            lay_nearby(store, state.nearby, gap, state.search.lines + 1)
        request = Request(pose, goal, body_of(params), params.plan.margin, dynamics_of(params))
        if (state.step == Step.SHOWN or not params.search.active) and is_in_place(pose, goal, params):
            return state._replace(request=request, searched=1, plans=state.plans + 1, path=AT_GOAL, sight=Sight())
    take_scene(store, params, state.seen)
    count = search_on(store, request, state.searched, params.plan.at_once)
    status = status_of(store)
    path = state.path
    if status == PLANNED:
        path = trimmed(path_of(store))
    first_margin = state.first_margin if state.first_margin > 0.0 else path.margin
    reason = reason_of(status, count, state, params)
    if status == PLANNED:
        reason = margin_reason(path.margin, first_margin, state.seen_count, params)
    plans = state.plans + 1 if state.searched == 0 else state.plans
    if reason in (Reason.BLOCKED, Reason.NO_PATH) and state.back.used > 0:
        backs = state.backs + 1
        path = path_back(state.back)
        return state._replace(request=request, searched=count, plans=plans, path=path, back=WayBack(), backs=backs)
    state = state._replace(request=request, searched=count, plans=plans, path=path)
    return state._replace(reason=reason, sight=Sight(), first_margin=first_margin)


def margin_reason(margin: float, first_margin: float, seen_count: int, params: ValetParams) -> int:
    """Return why a path is not driven whose margin is too small, ``NONE`` if it is; ``first_margin``: of the first."""
    if params.search.active:
        return Reason.BLOCKED if margin < LEAST_MARGIN else Reason.NONE
    if margin >= max(MIN_DRIVEN_MARGIN, min(first_margin, MIN_REPLANNED_MARGIN)):
        return Reason.NONE
    return Reason.BLOCKED if seen_count > 0 else Reason.NO_PATH


def gap_now(store: PlanStore, state: ValetState, params: ValetParams) -> Gap:
    """Return the slot found, by all that was heard of it up to now."""
    gap = state.search.gap
    body = body_of(params)
    deep = 2.0 * (body.half_length if gap.layout == GapLayout.ACROSS else body.half_width)
    told = state.search.told != SlotKind.NONE
    if not told:
        gap = turned_gap(store, state.nearby, gap, deep)
    return corrected(store, state.nearby, gap, deep, told)


def goal_now(state: ValetState, gap: Gap, params: ValetParams) -> Pose:
    """Return where to stand in the slot found, which is ``gap`` now."""
    wish = state.search.told if state.search.told != SlotKind.NONE else params.search.wish
    return goal_in(gap, state.search.pose.heading, wish, params)


def room_beside_car(gap: Gap, params: ValetParams) -> float:
    """Return how much more room [m] there is between a slot's neighbours than a car needs."""
    body = body_of(params)
    return gap.width - 2.0 * (body.half_width if gap.layout == GapLayout.ACROSS else body.half_length)


def reason_of(status: int, count: int, state: ValetState, params: ValetParams) -> int:
    """Return why a search leads nowhere, ``NONE`` if it may yet or has found a path."""
    if status == PLANNED:
        return Reason.NONE
    if state.plans > params.plan.plans:
        return Reason.LEFT_PATH
    if status == PLANNING:
        return Reason.NO_PATH if count > params.plan.steps else Reason.NONE
    if status == TOO_MANY_EDGES:
        return Reason.BAD_PARAMETER
    return Reason.NO_PATH if status in (NO_WAY, NO_ROOM) and state.seen_count == 0 else Reason.BLOCKED
