"""The valet drives: slots from outside, things in the way, reasons to give up; in C as in CPython."""

import math
from typing import Any

import numpy as np
import pytest
from shapely.geometry import LineString, Polygon

from controller_fmu import MODEL, VALET
from controller_fmu.common.external_slot import ExternalSlot, SlotKind
from controller_fmu.interface import Reason
from controller_fmu.planning.plan import Piece
from controller_fmu.planning.task import Corner
from controller_fmu.registry import System
from controller_fmu.valet.params import MAP_CORNERS, GivenSlot, ValetParams
from controller_fmu.valet.phases import ValetPhase
from controller_fmu.valet.sight import NUMBER, SEEN_CORNERS, Sight, expected, remembered, take_scene
from controller_fmu.valet.signals import Planning, ValetInput
from controller_fmu.valet.slot import body_of, goal_of
from fmus.compiler import translate
from modelkit.model import Model
from modelkit.variables import variables
from modelkit.vocabulary import Pose
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.model_instance import ModelInstance
from tests.compiler.c_model import CModel
from tests.planning.plan_model import Scene
from tests.valet.looks import look

STEP_NS = 10_000_000
BOX = ((4.0, -1.0), (6.0, -1.0), (6.0, 1.0), (4.0, 1.0))


def with_map(*polygons: Any, **more: Any) -> Any:
    corners = [Corner(x, y, number) for number, polygon in enumerate(polygons, start=1) for x, y in polygon]
    return ValetParams(map=(*corners, *(Corner() for _ in range(MAP_CORNERS - len(corners)))), **more)


HERE = Pose()


def goal(kind: Any, now: Any = HERE, **more: Any) -> Any:
    slot = GivenSlot(kind=kind, ax=0.0, ay=0.0, bx=2.5, by=0.0, heading=-0.5 * math.pi, depth=5.0)
    return goal_of(ValetParams(), slot._replace(**more), now)


def test_the_goal_is_in_the_middle_of_the_slot_that_is_given() -> None:
    ahead = body_of(ValetParams()).ahead
    assert goal(SlotKind.TAIL_IN) == pytest.approx((1.25, -2.5 - ahead, 0.5 * math.pi))
    assert goal(SlotKind.NOSE_IN) == pytest.approx((1.25, -2.5 + ahead, -0.5 * math.pi))
    along = goal(SlotKind.PARALLEL, bx=6.0, depth=2.0)
    assert along == pytest.approx((3.0 - ahead, -1.0, 0.0))
    against = goal(SlotKind.PARALLEL, Pose(0.0, 0.0, 3.0), bx=6.0, depth=2.0)
    assert against == pytest.approx((3.0 + ahead, -1.0, math.pi))
    assert goal(SlotKind.NONE) == ValetParams().target


def test_a_sensor_expects_what_shapely_sees() -> None:
    params = with_map(BOX)
    store = VALET.new_store()
    take_scene(store, params, (Corner(),) * SEEN_CORNERS)
    box = Polygon(BOX)
    for heading in np.linspace(-math.pi, math.pi, 41):
        at = Pose(1.0, 0.3, float(heading))
        half, reach = params.car.ultrasonic.half_angle, params.car.ultrasonic.max_range
        rays = [
            LineString([at[:2], (at.x + reach * math.cos(a), at.y + reach * math.sin(a))])
            for a in np.linspace(heading - half, heading + half, 2001)
        ]
        from_at = LineString([at[:2], at[:2]])
        seen = [from_at.distance(ray.intersection(box)) for ray in rays if ray.intersects(box)]
        assert expected(store, at, params) == pytest.approx(min(seen, default=reach), abs=0.02)


def test_only_what_the_map_does_not_have_is_in_the_way() -> None:
    params = with_map(BOX)
    scene = Scene(params.map)
    front = params.car.wheelbase + params.car.front_overhang
    pose = Pose(4.0 - front - 0.4, 0.0, 0.0)  # 0.4 m before the box
    readings = [5.0] * 12
    readings[1] = readings[2] = 0.4
    near: Any = pytest.approx(14.1, abs=0.1)
    assert look(tuple(readings), pose, Piece(1.0), 0.2, scene, False, params) == Sight(
        speed=near, blocked=False, ahead=False
    )
    readings[1] = 0.05
    sight = look(tuple(readings), pose, Piece(1.0), 0.2, scene, False, params)
    assert sight.blocked
    assert sight.echo.x == pytest.approx(pose.x + params.car.ultrasonic.mounts[1].x + 0.05)
    assert not look(tuple(readings), pose, Piece(-1.0), 0.2, scene, False, params).blocked


def test_things_heard_are_remembered_and_the_oldest_forgotten() -> None:
    seen = (Corner(),) * SEEN_CORNERS
    rooms = SEEN_CORNERS // 4
    for count in range(rooms + 1):
        seen = remembered(seen, Pose(10.0 * count, 0.0, 0.0), count, False)
    numbers = {corner.polygon for corner in seen}
    assert numbers == {NUMBER + count for count in range(1, rooms + 1)}
    first = [corner for corner in seen if corner.polygon == NUMBER + rooms]
    assert min(corner.x for corner in first) == pytest.approx(10.0 * rooms)


def test_the_large_controller_refuses_what_only_the_valet_does() -> None:
    _, outputs = MODEL.initialize(MODEL.params()._replace(system=System.VALET))
    assert (outputs.phase, outputs.reason) == (ValetPhase.FAILED, Reason.BAD_PARAMETER)
    assert not {"map", "slot"} & {item.name.split(".")[0].split("[")[0] for item in variables(MODEL.params)}


def test_parameters_without_sense_are_refused() -> None:
    params = ValetParams(sample_time=0.0)
    step = VALET.stepper(VALET.new_store())
    _, outputs = step(VALET.initialize(params)[0], ValetInput(), params, STEP_NS)
    assert (outputs.phase, outputs.reason, outputs.brake_request) == (ValetPhase.FAILED, Reason.BAD_PARAMETER, True)


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"measured_speed": math.nan}, Reason.BAD_INPUT),
        ({"vehicle_fault": 1}, Reason.VEHICLE_FAULT),
        ({"external_slot": ExternalSlot(SlotKind.TAIL_IN, ax=math.nan)}, Reason.BAD_INPUT),
    ],
)
def test_a_fault_ends_it_with_its_reason(changed: Any, reason: Any) -> None:
    params = with_map(BOX, target=Pose(0.0, 8.0, 0.0))
    step, (state, _) = VALET.stepper(VALET.new_store()), VALET.initialize(params)
    state, outputs = step(state, ValetInput(), params, STEP_NS)
    assert (outputs.phase, outputs.valet.search) == (ValetPhase.STANDBY, Planning.PLANNING)
    _, outputs = step(state, ValetInput()._replace(**changed), params, STEP_NS)
    assert (outputs.phase, outputs.reason, outputs.brake_request) == (ValetPhase.FAILED, reason, True)


class Twin(ModelInstance):
    """The valet in CPython, and in C beside it, which must not differ."""

    def __init__(self, name: Any, model: Any, parameters: Any, twin: CModel) -> None:
        super().__init__(name, model, parameters)
        self.c = twin
        self.differing: set[str] = set()

    def initialize(self, stop_ns: Any) -> None:
        super().initialize(stop_ns)
        self.c.initialize(self._params)

    def step(self, t_ns: Any, dt_ns: Any) -> None:
        super().step(t_ns, dt_ns)
        self.c.step(self._input, dt_ns)
        self.differing |= set(self.c.differing(self._state, self.output))


@pytest.fixture(scope="module")
def valet_in_c(tmp_path_factory: pytest.TempPathFactory) -> CModel:
    return CModel(VALET, translate(VALET), tmp_path_factory.mktemp("c"))


@pytest.mark.parametrize(
    ("name", "stop"),
    [
        pytest.param("valet-angled-45", 22.0, marks=pytest.mark.release),
        ("valet-obstacle-on-path", 24.0),
        pytest.param("valet-search-perpendicular", 13.0, marks=pytest.mark.release),
    ],
)
def test_a_drive_in_c_has_the_bits_of_cpython(
    name: str, stop: float, valet_in_c: CModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    twins = []

    def make(name: Any, model: Any, parameters: Any) -> Any:
        if model is not VALET:
            return ModelInstance(name, model, parameters)
        twins.append(Twin(name, model, parameters, valet_in_c))
        return twins[-1]

    monkeypatch.setattr("orchestrator.session.session.ModelInstance", make)
    scenario = load_scenario(name, [f"stop_time={stop}", "vehicle.body=kinematic", "controller.plan.at_once=3"])
    ran = run_scenario(scenario)
    assert max(ran.recording.signals["controller.valet.pieces"]) > 0
    assert [twin.differing for twin in twins] == [set()]


def test_it_is_a_model_of_its_own_with_few_kilobytes_of_state() -> None:
    assert isinstance(VALET, Model)
    assert len(variables(VALET.state)) < 900
