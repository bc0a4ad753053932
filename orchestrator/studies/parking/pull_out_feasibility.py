"""Ways out with everything known: whether one exists, and how far the car can drive on where it ended."""

import math

from modelkit.geometry import Box, boxes_gap, outline
from modelkit.vocabulary import Pose
from orchestrator.inputs.scenario.car import car_parameters
from orchestrator.inputs.scenario.obstacle_map import map_of
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.scenario.slot_sizes import ParkingType
from orchestrator.inputs.text.console import say
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.studies.parking.cases import CARS
from orchestrator.studies.parking.pull_out_cases import PullOutCase, footprints_of, start_of, vehicle_of
from orchestrator.studies.parking.system_signals import APA_SYSTEM

MIN_CLEARANCE = 0.05
"""Clearance [m] of a path that counts, or as much as the car has where it stands."""
PLANNING_TIME = 5.0
STEPS_PER_SAMPLE = 100
"""The planner has so much time [s], and so many steps of its search in each sample."""
GOALS_ALONG = (5.0, 8.0)
GOALS_OUT = (1.5, 2.3, 3.1)
"""A car is out at one of these poses along the road: so far [m] beyond where it stood, and out of the row."""


def is_way_out(case: PullOutCase) -> bool:
    """Return whether a planner that knows what stands there finds a path to one of several poses on the road."""
    goals = (goal_of(case, along, out) for along in GOALS_ALONG for out in GOALS_OUT)
    return any(is_path(case, goal) for goal in goals)


def goal_of(case: PullOutCase, along: float, out: float) -> Pose:
    """Return a pose on the road, of a car that has turned to the left if it stood across the road."""
    x, _, _ = start_of(case)
    return Pose(x + along, out, 0.0) if case.kind == ParkingType.PARALLEL else Pose(x - along, out, math.pi)


def is_path(case: PullOutCase, goal: Pose) -> bool:
    """Return whether the planner, with the scene as its map, finds a path from where the car stands to ``goal``."""
    car = car_parameters(CARS[case.car])
    scenario = Scenario(
        name="apa-out-path",
        stop_time=PLANNING_TIME,
        vehicle=vehicle_of(case._replace(side=1)) | {"odometry.ideal": True},
        controller={
            **car,
            "system": APA_SYSTEM,
            "search.active": False,
            "plan.min_margin": MIN_CLEARANCE,
            "plan.steps_per_sample": STEPS_PER_SAMPLE,
            **{f"target.{axis}": value for axis, value in goal._asdict().items()},
        },
    )
    known = scenario.model_copy(update={"controller": scenario.controller | map_of(scenario)})
    recording = run_scenario(known, fmu_files("native", say), kind="native").recording
    return bool((recording.signals["controller.apa.segments"] > 0.0).any())


def free_ahead(case: PullOutCase, end: Pose, most: float = 5.0) -> float:
    """Return how far [m] a car that ended at ``end`` (scene) could drive straight on past its neighbours, ``most``."""
    car, at = CARS[case.car], Pose(end.x, case.side * end.y, case.side * end.heading)
    footprints = footprints_of(case)
    row = [
        Box(0.5 * (item.x0 + item.x1), 0.5 * (item.y0 + item.y1), 0.0, item.x1 - item.x0, item.y1 - item.y0)
        for item in (footprints["first"], footprints["second"])
    ]
    ahead = 0.0
    while ahead < most and all(
        boxes_gap(outline(at, car.wheelbase, car.front_overhang + ahead, car.rear_overhang, car.width), item) > 0.0
        for item in row
    ):
        ahead += 0.1
    return ahead
