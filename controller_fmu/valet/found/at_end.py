"""At the end of a way into a slot that was found: is the car in its place, and what do its sides hear of it?"""

from controller_fmu.common.external_slot import SlotKind
from controller_fmu.common.sensors import is_new_sample
from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.sensing.gap import GapLayout
from controller_fmu.valet.chart import Step
from controller_fmu.valet.found.beside import CYCLES, hear_beside, put_beside
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.planned import gap_now
from controller_fmu.valet.signals import ValetInput
from controller_fmu.valet.slot import seen_from
from controller_fmu.valet.state import ValetState
from modelkit.vocabulary import Pose

NEARLY = 0.3
"""A car is at the end of its way into a slot if it is no more [m], and no more [rad], off it."""
NEARLY_TURNED = 0.1
ASIDE = 0.05
"""Across the road a car that knows its neighbours by what it hears beside it stands no farther [m] off their middle."""
LAST_CORRECTIONS = 7
"""After so many plans a car stays in a slot where it is, even if what it hears beside it then tells a better place."""


def listened_on(store: PlanStore, state: ValetState, inputs: ValetInput, params: ValetParams, dt_ns: int) -> ValetState:
    """Return the valet that has listened to what is beside it at the end of its way, where it is put right by that."""
    told_anew = is_new_sample(state.watch.running, dt_ns, params.car.ultrasonic.cycle)
    if not told_anew or state.beside.cycles >= CYCLES:
        return state
    beside = hear_beside(state.beside, inputs, params)
    if beside.cycles < CYCLES:
        return state._replace(beside=beside)
    sought = state.search._replace(gap=gap_now(store, state, params))
    nearby = put_beside(store, state.nearby, beside, inputs.odometry, sought, params)
    return state._replace(beside=beside, nearby=nearby)


def listens(state: ValetState, pose: Pose, params: ValetParams) -> bool:
    """Return whether the car is at the end of a way into a slot that it found, and is put right by what it hears."""
    if not params.search.active or state.search.told != SlotKind.NONE or state.step != Step.STRAIGHTEN:
        return False
    off = seen_from(state.request.goal, pose)
    there = abs(off.x) < NEARLY and abs(off.y) < NEARLY and abs(off.heading) < NEARLY_TURNED
    return there and state.plans < LAST_CORRECTIONS


def waits(state: ValetState, pose: Pose, params: ValetParams) -> bool:
    """Return whether the car listens, and has not yet heard enough."""
    return listens(state, pose, params) and state.beside.cycles < CYCLES


def is_beside(state: ValetState, pose: Pose, goal: Pose, params: ValetParams) -> bool:
    """Return whether a car across the road that has listened stands beside its goal, farther than it need be."""
    across = state.search.gap.layout == GapLayout.ACROSS
    return across and listens(state, pose, params) and abs(seen_from(goal, pose).y) > ASIDE
