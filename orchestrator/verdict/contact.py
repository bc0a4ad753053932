"""Contact of the car with the scene: from what the vehicle puts out, or from its poses where that is not enough.

The vehicle of this project puts out its clearance, in contact minus the penetration depth. A third-party vehicle may
put out none, and older logs have 0 in contact: there the true outline is held against the true scene, at every pose.
"""

import math
from collections.abc import Mapping
from functools import cache
from typing import NamedTuple

import numpy as np

from modelkit.geometry import FAR
from modelkit.variables import variables
from orchestrator.cosim.recording import Recording
from orchestrator.cosim.slave import Array
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.scenario import Scenario
from orchestrator.verdict.geometry import CarOutline, described, kerbs, things
from orchestrator.verdict.polygons import TOUCH, polygon_clearances

CLEARANCE, SPEED, VEHICLE = "vehicle.clearance", "vehicle.speed", "vehicle"
POSE = ("vehicle.pose.x", "vehicle.pose.y", "vehicle.pose.heading")
SIZES = ("length", "height")
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
    return any(
        value > 0.0 and name.startswith("scene.") and name.rpartition(".")[2] in SIZES
        for name, value in vehicle.items()
    )


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


def clearances(recording: Recording, scenario: Scenario) -> Clearances:
    """Return the distances of the outline to what stands in ``scenario``."""
    parameters = described(scenario, recording.parameters_of(VEHICLE))
    scene = _to_scene(recording, parameters)
    if not scenario.polygons:
        return Clearances(scene, np.full(len(scene), np.inf))
    poses = _poses(recording)
    if poses is None:
        return Clearances(scene, np.full(len(scene), np.nan))
    return Clearances(scene, polygon_clearances(poses, scenario.polygons, CarOutline.of(parameters)))


def least(distances: Array) -> float:
    """Return the least of the distances at all samples; NaN if one of them is not known, or there are none."""
    return float(distances.min()) if len(distances) else math.nan


def depth(distances: Array) -> float:
    """Return the greatest penetration depth [m], 0 without contact; NaN if that is not known."""
    nearest = least(distances)
    return nearest if math.isnan(nearest) else max(0.0, -nearest)


def first_contact(recording: Recording, found: Clearances) -> FirstContact | None:
    """Return the first contact of a run; None if it has none."""
    rows = np.flatnonzero(found.nearest < 0.0)
    if not len(rows):
        return None
    speed = recording.signals.get(SPEED)
    first = math.nan if speed is None else float(speed[rows[0]])
    return FirstContact(float(recording.t[rows[0]]), first, len(rows), depth(found.nearest))


def low_kerb_time(recording: Recording, found: Clearances) -> float:
    """Return the first instant [s] at which a wheel is at a kerb too low to be a contact; NaN if there is none."""
    rows = np.flatnonzero(found.scene == 0.0)
    return float(recording.t[rows[0]]) if len(rows) else math.nan


def _to_scene(recording: Recording, parameters: Mapping[str, float]) -> Array:
    """Return the distances to boxes and kerbs: as the vehicle puts them out, or of its poses from the scene."""
    own = recording.signals.get(CLEARANCE)
    is_ours = own is not None and _is_ours(recording)
    if own is not None and is_ours and ((own < 0.0).any() or not (own == 0.0).any()):
        return own
    poses = _poses(recording)
    if poses is None:
        return np.full(len(recording.t), np.nan) if own is None else np.where(own <= 0.0, -TOUCH, own)
    found = _at_poses(poses, recording.t, parameters)
    return found if own is None or is_ours else np.where(own <= 0.0, np.minimum(found, -TOUCH), found)


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
    found = np.where(np.isfinite(poses).all(axis=1), FAR, np.nan)
    for box in things(parameters):
        rows = np.flatnonzero((box.appear_at <= t) & (t < box.disappear_at))
        moved = np.maximum(0.0, np.minimum(t[rows], box.halts_at) - box.moves_at)
        seen = poses[rows] - np.column_stack([box.speed_x * moved, box.speed_y * moved, np.zeros(len(rows))])
        found[rows] = np.minimum(found[rows], polygon_clearances(seen, [box.outline()[:4].tolist()], car))
    for kerb in kerbs(parameters):
        part = low if kerb.height < parameters["scene.ground_clearance"] else car
        near = polygon_clearances(poses, [[(kerb.x1, kerb.y1), (kerb.x2, kerb.y2)]], part)
        counts = kerb.height >= parameters["ultrasonic.kerb_height"]
        found = np.minimum(found, near if counts else np.maximum(near, 0.0))
    return found


@cache
def _defaults() -> Mapping[str, float]:
    return {item.name: float(item.start) for item in variables(MODELS[VEHICLE].params)}
