"""The smallest clearance of a run, worked out where it may be smaller: the bits of the smallest of all."""

import math
import random
from collections.abc import Iterable
from typing import Any

import pytest

from fmus.compiled_batch import RecordedSignal, SampleTime, StopCondition, in_smallest_forms
from modelkit.car import Car
from modelkit.geometry import NO_HIT
from modelkit.vocabulary import Pose
from orchestrator.inputs.scenario.models import MODELS
from tests.vehicle.test_scene import random_scene
from vehicle_fmu import MODEL
from vehicle_fmu.interface import VehicleInput, VehicleParams
from vehicle_fmu.nearest_approach import NearestApproach, approach, is_static, may_be_nearer
from vehicle_fmu.scene import Kerb, Obstacle, SceneParams, clearance

STEP_NS = 10_000_000
CAR = Car()


def smallest_of_all(scene: SceneParams, poses: Iterable[Pose], car: Car = CAR) -> float:
    params = VehicleParams(scene=scene, car=car)
    gaps = [
        clearance(pose, params.car, scene, params.ultrasonic.kerb_height, number * STEP_NS)
        for number, pose in enumerate(poses)
    ]
    return min(gaps)


def smallest_on_demand(scene: SceneParams, poses: list[Pose], car: Car = CAR) -> tuple[float, int]:
    """Return the smallest clearance [m] and how often one was worked out."""
    params = VehicleParams(scene=scene, car=car)
    nearest = approach(NearestApproach(static=is_static(scene)), poses[0], params, 0)
    count = 1
    for number, pose in enumerate(poses):
        if may_be_nearer(nearest, pose, params.car, scene):
            nearest = approach(nearest, pose, params, number * STEP_NS)
            count += 1
    return nearest.smallest, count


def scene_of(*boxes: Obstacle, kerbs: tuple[Kerb, ...] = ()) -> SceneParams:
    return SceneParams((*boxes, *(Obstacle(),) * (16 - len(boxes))), (*kerbs, *(Kerb(),) * (4 - len(kerbs))))


def walk(draw: random.Random, count: int) -> list[Pose]:
    """Return poses that follow each other in short and in long steps, with stops and turns on the spot."""
    pose, poses = Pose(draw.uniform(-9, 9), draw.uniform(-9, 9), draw.uniform(-4, 4)), []
    for _ in range(count):
        kind = draw.randrange(4)
        for _ in range(draw.randrange(1, 12)):
            step, turn = draw.uniform(0.0, 0.05), draw.uniform(-0.02, 0.02)
            ahead = pose.heading + (math.pi if kind == 1 else 0.0)
            if kind < 2:
                pose = Pose(pose.x + step * math.cos(ahead), pose.y + step * math.sin(ahead), pose.heading + 0.2 * turn)
            elif kind == 2:
                pose = pose._replace(heading=pose.heading + turn)
            poses.append(pose)
    return poses


def test_random_walks_have_the_smallest_of_all_with_fewer_clearances() -> None:
    draw = random.Random(11)
    poses_in_all = worked_out = touching = 0
    for _ in range(60):
        scene, poses = random_scene(draw), walk(draw, 40)
        expected = smallest_of_all(scene, poses)
        found, count = smallest_on_demand(scene, poses)
        assert found == expected
        poses_in_all, worked_out = poses_in_all + len(poses), worked_out + count
        touching += expected <= 0.0
    assert 10 < touching < 50
    assert worked_out < 0.5 * poses_in_all


@pytest.mark.parametrize("car", [CAR, CAR._replace(front_overhang=3.0), CAR._replace(rear_overhang=6.0)])
def test_a_corner_that_swings_past_a_post_is_seen(car: Car) -> None:
    """The rear axle stays where it is: only the turn brings the corner near, after it was as near to another post."""
    front, rear = car.wheelbase + car.front_overhang, car.rear_overhang
    x, direction = (front, 0.0) if front > rear else (rear, math.pi)
    reach, corner = math.hypot(x, 0.5 * car.width), direction + math.atan2(0.5 * car.width, x)
    posts = [
        Obstacle(away * math.cos(at), away * math.sin(at), 0.0, 0.001, 0.001)
        for away, at in ((reach + 0.102, corner), (reach + 0.1, corner + 1.2))
    ]
    poses = [Pose(heading=0.2 * number) for number in range(7)]
    poses += [Pose(heading=1.2 - 0.05 * number) for number in range(20)]
    expected = smallest_of_all(scene_of(*posts), poses, car)
    found, count = smallest_on_demand(scene_of(*posts), poses, car)
    assert found == expected < 0.101
    assert count < len(poses)


@pytest.mark.parametrize(
    "walker",
    [
        Obstacle(6.0, 0.0, 0.0, 0.4, 0.8, speed_x=-0.5, moves_at=0.2, halts_at=1.2),
        Obstacle(4.0, 0.0, 0.0, 0.4, 0.8, appear_at=0.5, disappear_at=0.6),
    ],
)
def test_what_moves_or_appears_comes_nearer_to_a_vehicle_that_stands_or_creeps(walker: Obstacle) -> None:
    scene = scene_of(Obstacle(-9.0, 0.0, 0.0, 1.0, 1.0), walker)
    for poses in ([Pose()] * 200, [Pose(-1e-4 * number) for number in range(200)]):
        assert smallest_on_demand(scene, poses)[0] == smallest_of_all(scene, poses) < 2.3


def test_a_pose_that_is_no_number_counts_as_everywhere() -> None:
    scene, poses = scene_of(Obstacle(6.0, 0.0, 0.0, 1.0, 1.0)), [Pose(), Pose(math.nan), Pose(0.1)]
    assert smallest_on_demand(scene, poses)[0] == smallest_of_all(scene, poses) < 0.0


def test_a_kerb_under_the_bumper_counts_from_the_tyres() -> None:
    scene = scene_of(kerbs=(Kerb(3.1, -2.0, 3.1, 2.0, 0.05),))
    poses = [Pose(0.01 * number) for number in range(60)]
    assert smallest_on_demand(scene, poses)[0] == smallest_of_all(scene, poses) == 0.0


def test_steps_of_the_form_give_the_smallest_clearance_of_those_of_the_model() -> None:
    form = MODEL.in_smallest_form()
    params = VehicleParams(scene=scene_of(Obstacle(6.0, 0.4, 0.3, 1.0, 1.0)))
    inputs = VehicleInput(
        speed_control_active=True, speed_request=0.8, steering_active=True, steering_wheel_request=2.0
    )
    smallest: list[Any] = []
    ends = []
    for model in (MODEL, form):
        state, outputs = model.initialize(params)
        gaps, step = [outputs.clearance], model.stepper(None)
        for _ in range(300):
            state, outputs = step(state, inputs, params, STEP_NS)
            gaps.append(outputs.clearance)
        smallest.append(min(gaps))
        ends.append(outputs._replace(clearance=0.0, contact=False))
        assert model is MODEL or gaps[-1] == min(gaps)
    assert smallest[0] == smallest[1] < 2.0
    assert ends[0] == ends[1]


def test_an_empty_scene_is_clear_and_a_bad_parameter_is_not() -> None:
    form = MODEL.in_smallest_form()
    assert form.initialize(VehicleParams())[1].clearance == NO_HIT
    bad = VehicleParams()._replace(largest_step=-1.0)
    assert form.initialize(bad)[1].clearance == MODEL.initialize(bad)[1].clearance == 0.0


ENDING = StopCondition("controller.phase", (9,), "vehicle.speed", 0.01, 1)
SMALLEST = RecordedSignal("smallest", "vehicle.clearance")


def test_the_form_takes_the_place_of_the_model_where_the_smallest_alone_is_kept() -> None:
    models, kept = in_smallest_forms(MODELS, ENDING, [SMALLEST, RecordedSignal("last", "vehicle.speed")])
    assert models["vehicle"].step is MODEL.in_smallest_form().step
    assert models["controller"] is MODELS["controller"]
    assert kept == [RecordedSignal("last", "vehicle.clearance"), RecordedSignal("last", "vehicle.speed")]


@pytest.mark.parametrize(
    "other",
    [
        RecordedSignal("last", "vehicle.clearance"),
        RecordedSignal("greatest", "vehicle.contact"),
        SMALLEST._replace(when=SampleTime("controller.phase", (2,))),
        RecordedSignal("last", "vehicle.speed", SampleTime("vehicle.contact", (1,))),
    ],
)
def test_the_model_stays_where_more_of_its_clearance_is_kept(other: RecordedSignal) -> None:
    assert in_smallest_forms(MODELS, ENDING, [SMALLEST, other]) == (dict(MODELS), [SMALLEST, other])


def test_the_model_stays_where_its_clearance_ends_the_run_or_is_not_kept() -> None:
    touching = ENDING._replace(mode="vehicle.contact")
    assert in_smallest_forms(MODELS, touching, [SMALLEST])[0] == dict(MODELS)
    assert in_smallest_forms(MODELS, ENDING, [])[0] == dict(MODELS)
