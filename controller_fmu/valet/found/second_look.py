"""A slot at an angle into which there is no way after all: cars that stand the other way leave another one."""

from controller_fmu.common.external_slot import SlotKind
from controller_fmu.common.sensors import LEFT_SENSOR, RIGHT_SENSOR, sensor_at
from controller_fmu.interface import Reason
from controller_fmu.planning.plan import Path
from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.planning.task import Corner
from controller_fmu.sensing.find_gap import gap_across
from controller_fmu.sensing.gap import Gap, GapLayout
from controller_fmu.valet.found.search import RIGHT, mapped, wanted_beside
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.sight import SEEN_CORNERS, Sight
from controller_fmu.valet.state import ValetState

NO_WAY_IN = (Reason.NO_PATH, Reason.BLOCKED, Reason.SLOT_TOO_SHALLOW, Reason.LEFT_PATH)


def looked_again(store: PlanStore, state: ValetState, params: ValetParams) -> ValetState:
    """Return the valet about to plan into the slot that is there if neighbours stand across what they seemed to.

    Once for each slot that was found, where there is no way into it; else the valet as it is.
    """
    sought = state.search
    if state.reason not in NO_WAY_IN or sought.gap.layout != GapLayout.ACROSS or sought.again:
        return state
    if sought.told != SlotKind.NONE or not params.search.active:
        return state
    gap = _other_gap(store, state, params)
    if gap.layout == GapLayout.NONE or gap.shallow:
        return state
    sought = sought._replace(gap=gap, again=True)
    sought = mapped(store, sought, params)
    return state._replace(
        reason=Reason.NONE,
        search=sought,
        searched=0,
        plans=0,
        path=Path(),
        seen=(Corner(),) * SEEN_CORNERS,
        seen_count=0,
        sight=Sight(),
    )


def _other_gap(store: PlanStore, state: ValetState, params: ValetParams) -> Gap:
    """Return the gap that is there if neighbours stand the other way, from all that was heard from the road."""
    sought = state.search
    right = sought.side == RIGHT
    mount = params.car.ultrasonic.mounts[RIGHT_SENSOR if right else LEFT_SENSOR]
    at = sensor_at(mount, sought.pose)._replace(heading=sought.pose.heading)
    places = sought.right.places if right else sought.left.places
    want = wanted_beside(store, sought, sought.side, at, params)._replace(at_end=True)
    return gap_across(store, sought.side, places, at, want, sought.gap.into)
