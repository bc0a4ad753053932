"""The planner alone as a model: one request, so many steps at each call."""

import sys
from typing import Annotated, NamedTuple

from controller_fmu.planning.plan import Path, path_of, search_to, status_of, take_corner
from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.planning.task import CORNERS, Corner, Request
from modelkit.model import Model
from modelkit.signal import Signal


class State(NamedTuple):
    count: int = 0  # type: ignore[assignment]  # tuples have a method count


class Scene(NamedTuple):
    corners: tuple[Corner, ...] = (Corner(),) * CORNERS


class Params(NamedTuple):
    scene: Scene = Scene()
    request: Request = Request()
    each: Annotated[int, Signal("1", "steps of the search at each call")] = 5


class Input(NamedTuple):
    patterns_without_match: bool = False


class Output(NamedTuple):
    status: int = 0
    path: Path = Path()


def initialize(params: Params) -> tuple[State, Output]:
    return State(), Output()


def step(store: PlanStore, state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    count = state.count + params.each
    for number, corner in enumerate(params.scene.corners):
        take_corner(store, number, corner)
    search_to(store, params.request, count)
    return State(count), Output(status_of(store), path_of(store))


MODEL = Model(
    name="Planner",
    description="The planner alone",
    package=sys.modules[__name__],
    state=State,
    params=Params,
    inputs=Input,
    outputs=Output,
    initialize=initialize,
    step=step,
    step_size=0.01,
    stop_time=1.0,
    store=PlanStore,
)
