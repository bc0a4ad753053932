"""How near cars come to the polygons of their scenes, from exchange to exchange."""

import numpy as np

from orchestrator.evaluation.verdict.geometry import CarOutline
from orchestrator.evaluation.verdict.polygons import Polygons, polygon_clearances
from orchestrator.simulation.cosim.fmu_instance import Array

MAX_EXACT_CLEARANCE = 0.05
"""Clearances [m] below this are computed at each exchange; others where the car may have come nearer than this."""


class PolygonClearance:
    """The clearance of one car, computed only where it is not known to be large."""

    def __init__(self, polygons: Polygons, car: CarOutline, pose: Array) -> None:
        self._polygons, self._car = polygons, car
        self._reach = float(np.hypot(max(car.front, car.rear), car.half_width))
        self._pose, self._clearance = pose.copy(), self._exact(pose)
        self.smallest: float = self._clearance
        """Smallest so far [m]; in contact minus the depth."""

    def look(self, pose: Array) -> float:
        """Return a lower bound of the clearance [m] at ``pose``, the clearance itself below ``MAX_EXACT_CLEARANCE``."""
        dx, dy, turn = (pose - self._pose).tolist()
        bound: float = self._clearance - float(np.hypot(dx, dy)) - self._reach * abs(turn)
        if bound >= MAX_EXACT_CLEARANCE:
            return bound
        self._pose, self._clearance = pose.copy(), self._exact(pose)
        self.smallest = min(self.smallest, self._clearance)
        return self._clearance

    def _exact(self, pose: Array) -> float:
        return float(polygon_clearances(pose[None], self._polygons, self._car)[0])
