"""Contact of the car with the scene: from what the vehicle puts out, or from its poses where that is not enough.

The vehicle of this project puts out its clearance, in contact minus the penetration depth. A third-party vehicle may
put out none: there the true outline is held against the true scene, at every pose.
"""

import math
import re
from collections.abc import Iterator, Mapping
from functools import cache
from typing import NamedTuple

import numpy as np

from modelkit.geometry import NO_HIT
from modelkit.variables import variables
from orchestrator.evaluation.verdict.geometry import CarOutline, kerbs, moving_boxes, vehicle_parameters
from orchestrator.evaluation.verdict.polygons import TOUCH_DEPTH, polygon_clearances
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording

CLEARANCE, SPEED, VEHICLE = "vehicle.clearance", "vehicle.speed", "vehicle"
POSE = ("vehicle.pose.x", "vehicle.pose.y", "vehicle.pose.heading")
SIZE = re.compile(r"scene\.(boxes\[\d+\]\.length|kerbs\[\d+\]\.height)")
"""Fields of a thing of the scene that are 0 where there is none: of boxes, of kerbs."""


class FirstContact(NamedTuple):
    """The first contact of a run."""

    t: float
    """When [s]."""
    speed: float
    """Speed of the car then [m/s], NaN if it is not known."""
    samples: int
    """How many samples of the run are in contact."""
    depth: float
    """Greatest penetration depth [m]."""


def has_scene(vehicle: Mapping[str, float]) -> bool:
    """Return whether there is anything in the scene that the parameters ``vehicle`` describe."""
    return any(value > 0.0 and SIZE.fullmatch(name) for name, value in vehicle.items())


class Clearances(NamedTuple):
    """Distances [m] at every sample, in contact minus the penetration depth; NaN where they are not known."""

    scene: Array
    """To boxes and kerbs."""
    polygons: Array
    """To polygons; infinite where the scenario has none."""

    @property
    def nearest(self) -> Array:
        """Return the distance to anything."""
        return np.minimum(self.scene, self.polygons)


class ContactFacts(NamedTuple):
    """What is known of contact in a whole run: distances [m], in contact minus the penetration depth."""

    scene: float
    """Least distance to boxes and kerbs; NaN if one is not known."""
    polygons: float
    """Least distance to polygons; infinite where the scenario has none."""
    nearest: float
    """Least distance to anything."""
    first: FirstContact | None
    low_kerb_time: float
    """First instant [s] at which a wheel is at a kerb too low to be a contact; NaN if there is none."""

    @property
    def depth(self) -> float:
        """Return the greatest penetration depth [m], 0 without contact; NaN if that is not known."""
        return depth(self.nearest)


def contact_facts(recording: Recording, scenario: Scenario) -> ContactFacts:
    """Return what is known of contact in a run of ``scenario``."""
    least = np.full(3, np.nan)
    first: tuple[float, float] | None = None
    samples, low, is_empty = 0, math.nan, True
    for part, found in clearance_parts(recording, scenario):
        if not part.count:
            continue
        now = np.array([found.scene.min(), found.polygons.min(), found.nearest.min()])
        least, is_empty = now if is_empty else np.minimum(least, now), False
        rows = np.flatnonzero(found.nearest < 0.0)
        samples += len(rows)
        if first is None and len(rows):
            speed = part.signals.get(SPEED)
            first = float(part.t[rows[0]]), math.nan if speed is None else float(speed[rows[0]])
        at_kerb = np.flatnonzero(found.scene == 0.0)
        low = float(part.t[at_kerb[0]]) if math.isnan(low) and len(at_kerb) else low
    scene, polygons, nearest = (float(value) for value in least)
    touched = None if first is None else FirstContact(*first, samples, depth(nearest))
    return ContactFacts(scene, polygons, nearest, touched, low)


def depth(nearest: float) -> float:
    """Return the penetration depth [m] of a least distance, 0 without contact; NaN if that is not known."""
    return nearest if math.isnan(nearest) else max(0.0, -nearest)


def clearance_parts(recording: Recording, scenario: Scenario) -> Iterator[tuple[Recording, Clearances]]:
    """Yield a run part by part with the distances of the outline to what stands in ``scenario``."""
    parameters = vehicle_parameters(scenario, recording.parameters_of(VEHICLE))
    for part, _, _ in recording.parts():
        scene = _to_scene(part, parameters)
        if not scenario.obstacles:
            yield part, Clearances(scene, np.full(len(scene), np.inf))
            continue
        poses = _poses(part)
        if poses is None:
            yield part, Clearances(scene, np.full(len(scene), np.nan))
        else:
            near = polygon_clearances(poses, scenario.obstacles, CarOutline.of(parameters))
            yield part, Clearances(scene, near)


def _to_scene(recording: Recording, parameters: Mapping[str, float]) -> Array:
    """Return the distances to boxes and kerbs: as our vehicle puts them out, or of another's poses from the scene."""
    own = recording.signals.get(CLEARANCE)
    if own is not None and _is_ours(recording):
        return own
    poses = _poses(recording)
    if poses is None:
        return np.full(len(recording.t), np.nan) if own is None else np.where(own <= 0.0, -TOUCH_DEPTH, own)
    found = _at_poses(poses, recording.t, parameters)
    return found if own is None else np.where(own <= 0.0, np.minimum(found, -TOUCH_DEPTH), found)


def _is_ours(recording: Recording) -> bool:
    used = [item for item in recording.info.get("fmus", []) if item.get("name") == VEHICLE]
    return bool(used) and used[0].get("kind") != "foreign"


def _poses(recording: Recording) -> Array | None:
    """Return the poses (n, 3) of a run; None if they are not known."""
    if not all(name in recording.signals for name in POSE):
        return None
    return np.column_stack([recording.signals[name] for name in POSE])


def _at_poses(poses: Array, t: Array, given: Mapping[str, float]) -> Array:
    """Return the clearance of the outline at each pose: in contact minus the depth, 0 at a kerb that is too low."""
    parameters = {**_defaults(), **given}
    car, reach = CarOutline.of(parameters), parameters["scene.tyre_reach"]
    low = CarOutline(car.wheelbase + reach, reach, car.half_width, car.wheelbase)
    detected = parameters["ultrasonic.kerb_height"]

    def part_at(height: float) -> CarOutline:
        return low if height < parameters["scene.ground_clearance"] else car

    found = np.where(np.isfinite(poses).all(axis=1), NO_HIT, np.nan)
    for box in moving_boxes(parameters):
        rows = np.flatnonzero((box.appear_at <= t) & (t < box.disappear_at))
        moved = np.maximum(0.0, np.minimum(t[rows], box.halts_at) - box.moves_at)
        seen = poses[rows] - np.column_stack([box.speed_x * moved, box.speed_y * moved, np.zeros(len(rows))])
        near = polygon_clearances(seen, [box.outline()[:4].tolist()], part_at(box.height))
        found[rows] = np.minimum(found[rows], near if box.height >= detected else np.maximum(near, 0.0))
    for kerb in kerbs(parameters):
        near = polygon_clearances(poses, [[(kerb.x1, kerb.y1), (kerb.x2, kerb.y2)]], part_at(kerb.height))
        found = np.minimum(found, near if kerb.height >= detected else np.maximum(near, 0.0))
    return found


@cache
def _defaults() -> Mapping[str, float]:
    return {item.name: float(item.start) for item in variables(MODELS[VEHICLE].params)}
