"""The planner alone as a model: one request, so many steps at each call."""

import sys
from typing import Annotated, NamedTuple

from controller_fmu.parking.geometry.polygons import MAP_VERTICES, ObstacleMap, Vertex
from controller_fmu.parking.planning.planner import PlannedPath, path_of_plan, search_status, search_until
from controller_fmu.parking.planning.problem import PlanningRequest
from controller_fmu.parking.planning.work import PlanningWork
from modelkit.model import Model
from modelkit.signal import Signal


class State(NamedTuple):
    count: int = 0  # type: ignore[assignment]  # tuples have a method count


class Scene(NamedTuple):
    corners: tuple[Vertex, ...] = (Vertex(),) * MAP_VERTICES


class Params(NamedTuple):
    scene: Scene = Scene()
    request: PlanningRequest = PlanningRequest()
    each: Annotated[int, Signal("1", "steps of the search at each call")] = 5


class Input(NamedTuple):
    patterns_without_match: bool = False


class Output(NamedTuple):
    status: int = 0
    path: PlannedPath = PlannedPath()


def initialize(params: Params) -> tuple[State, Output]:
    return State(), Output()


def step(store: PlanningWork, state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    count = state.count + params.each
    search_until(store, ObstacleMap(), params.scene.corners, params.request, count)
    return State(count), Output(search_status(store), path_of_plan(store, params.request))


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
    store=PlanningWork,
)
