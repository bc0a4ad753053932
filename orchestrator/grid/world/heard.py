"""How long before a touch sensors could have told of who moves: what no assist that hears as ours does can have.

Asked of the readings that sensors without noise and losses would have given, where and as they are mounted: once with
who moves, once as if he had stayed (a person: were not there). Whoever hears him knows that he is nearer.
"""

from typing import Any, NamedTuple

import numpy as np

from modelkit.variables import with_values
from modelkit.vocabulary import Pose
from orchestrator.cosim.recording import Recording
from orchestrator.grid.world.scene import THINGS
from vehicle_fmu.interface import VehicleParams
from vehicle_fmu.scene import Obstacle, SceneParams
from vehicle_fmu.ultrasonic import heard_distances, is_due

NEARER = 0.1
"""Readings that are nearer by less [m] are noise."""
READINGS = 3
"""So many readings of one sensor in a row are no chance."""


class Readings(NamedTuple):
    """Exact distances [m] that each sensor measures, a row for each of its cycles."""

    t: np.ndarray[Any, np.dtype[np.float64]]
    """When [s]."""
    moving: np.ndarray[Any, np.dtype[np.float64]]
    """As the run was; cycles x 12."""
    stayed: np.ndarray[Any, np.dtype[np.float64]]
    """As if who moves had stayed where he was."""


def heard_before(recording: Recording, name: str, touched: float) -> float:
    """Return how long [s] before ``touched`` [s] a sensor had told of who moves, one of ``THINGS``; 0: it had not."""
    found = readings(recording, name, touched)
    nearer = found.moving < found.stayed - NEARER
    in_row = nearer[READINGS - 1 :].copy()
    for back in range(1, READINGS):
        in_row &= nearer[READINGS - 1 - back : len(nearer) - back]
    told = np.flatnonzero(in_row.any(axis=1))
    return touched - float(found.t[READINGS - 1 + told[0]]) if len(told) else 0.0


def readings(recording: Recording, name: str, until: float) -> Readings:
    """Return what sensors without any error would have measured ``until`` [s] with who moves, and without."""
    params: VehicleParams = with_values(VehicleParams, recording.parameters_of("vehicle"))
    number = THINGS.index(name)
    staying = _without_motion(params.scene, number)
    sensors = params.car.ultrasonic
    x, y, heading = (recording.signals[f"vehicle.pose.{axis}"] for axis in ("x", "y", "heading"))
    times: list[float] = []
    moving: list[tuple[float, ...]] = []
    stayed: list[tuple[float, ...]] = []
    before = -1
    for place, now in enumerate(recording.t_ns.tolist()):
        if now * 1e-9 <= until and is_due(before, now, sensors.cycle):
            pose = Pose(float(x[place]), float(y[place]), float(heading[place]))
            times.append(now * 1e-9)
            for scene, heard in ((params.scene, moving), (staying, stayed)):
                heard.append(heard_distances(pose, scene, sensors, params.ultrasonic.kerb_height, now))
        before = now
    return Readings(np.array(times), np.array(moving), np.array(stayed))


def _without_motion(scene: SceneParams, number: int) -> SceneParams:
    """Return the scene in which this box does not move; a person is not there."""
    box = scene.boxes[number]
    box = Obstacle() if THINGS[number] == "person" else box._replace(speed_x=0.0, speed_y=0.0)
    return scene._replace(boxes=(*scene.boxes[:number], box, *scene.boxes[number + 1 :]))
