"""The linear programme about a motion: dynamics, clearance and limits linearized, within a trust region.

Unknown: changes of states, inputs and durations, then what defects and clearances are violated by, at a price.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_array, csr_array

from orchestrator.simulation.cosim.fmu_instance import Array, Indices
from orchestrator.studies.benchmark.optimal.motion import (
    INPUTS,
    STATES,
    MotionLimits,
    TimedMotion,
    derivatives,
    integrate_motion,
)
from orchestrator.studies.benchmark.optimal.outline_distance import measure_gaps

DEFECT_PRICE, CLEARANCE_PRICE = 100.0, 200.0
"""Penalties [s per m, rad, m/s], larger than the multipliers of the constraints."""
EFFORT_PRICE = 0.01
"""Of turning the wheels [s per rad]: of motions that take equally long the calmest is wanted."""
NEAREST_EDGES = 6
"""So many edges are constraints at one pose."""
MAX_EDGE_DISTANCE = 1.5
"""Edges beyond this distance [m] from an outline are none."""
REACH = np.array([1.0, 1.0, 0.5, 2.0, 1.0])
"""Trust region of the states, in units of its size."""
MAX_STRETCH = 0.2
"""Largest change of a duration, as a share."""
UNKNOWNS_PER_INTERVAL = STATES + INPUTS + 1


class Nearness(NamedTuple):
    """Edges near poses: distances (p, e), derivatives by the pose (p, e, 3), the edges (p, e, 2, 2)."""

    distance: Array
    gradient: Array
    edges: Array


def nearest_edges(poses: Array, edges: Array, limits: MotionLimits) -> Nearness:
    """Return the nearest edges of each pose (p, 3); those beyond ``MAX_EDGE_DISTANCE`` may be missing."""
    heading = np.stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])], axis=-1)
    middle = poses[:, :2] + limits.ahead * heading
    along = edges[:, 1] - edges[:, 0]
    to = middle[:, None] - edges[None, :, 0]
    share = (to * along).sum(axis=-1) / np.maximum((along**2).sum(axis=-1), 1e-18)
    off = to - np.clip(share, 0.0, 1.0)[..., None] * along
    rough = np.hypot(off[..., 0], off[..., 1])
    reach = float(np.hypot(limits.half_length, limits.half_width)) + MAX_EDGE_DISTANCE
    chosen = edges[_least(rough, max(1, int((rough < reach).sum(axis=1).max())))]
    gaps = measure_gaps(poses, chosen, limits)
    best = _least(gaps.distance, NEAREST_EDGES)
    rows = np.arange(len(poses))[:, None]
    return Nearness(gaps.distance[rows, best], gaps.gradient[rows, best], chosen[rows, best])


def _least(values: Array, count: int) -> Indices:
    """Return the places of the ``count`` least values of each row."""
    if count >= values.shape[1]:
        return np.broadcast_to(np.arange(values.shape[1]), values.shape)
    return np.argpartition(values, count - 1, axis=1)[:, :count]


class ProgrammeStep(NamedTuple):
    """A solution: the motion it leads to, its merit as predicted [s], all unknowns."""

    motion: TimedMotion
    predicted: float
    unknowns: Array


class LinearProgramme:
    """The programme about one motion."""

    def __init__(self, motion: TimedMotion, edges: Array, limits: MotionLimits, region: float) -> None:
        self.motion, self._edges, self._limits = motion, edges, limits
        n = len(motion.inputs)
        self._inputs_at, self._durations_at = STATES * (n + 1), STATES * (n + 1) + INPUTS * n
        self._defects_at = self._durations_at + len(motion.durations)
        self._lacks_at = self._defects_at + 2 * STATES * n
        self._columns = np.concatenate(
            [
                STATES * np.arange(n)[:, None] + np.arange(STATES),
                self._inputs_at + INPUTS * np.arange(n)[:, None] + np.arange(INPUTS),
                self._durations_at + motion.move_of[:, None],
            ],
            axis=1,
        )
        states, slopes = integrate_motion(motion, limits.wheelbase), derivatives(motion, limits.wheelbase)
        self._clearances(states, slopes, region)
        self._efforts_at = self._lacks_at + self._count
        self._size = self._efforts_at + n
        self._dynamics(states, slopes)
        self._bounds = self._bounds_of(region)
        self._cost = np.zeros(self._size)
        self._cost[self._durations_at : self._defects_at] = 1.0
        self._cost[self._defects_at : self._lacks_at] = DEFECT_PRICE
        self._cost[self._lacks_at : self._efforts_at] = CLEARANCE_PRICE
        self._cost[self._efforts_at :] = EFFORT_PRICE * motion.intervals[:, 0]
        self._inequalities()

    def solve(self) -> ProgrammeStep | None:
        """Return the solution; None if the solver finds none."""
        return self._solution(self._defects, self._spare)

    def solve_again(self, step: ProgrammeStep) -> ProgrammeStep | None:
        """Return the solution with the constraints as they are at a step (second-order correction)."""
        bare = step.unknowns.copy()
        bare[self._defects_at :] = 0.0
        states = integrate_motion(step.motion, self._limits.wheelbase)
        defects = (step.motion.states[1:] - states[-1]).ravel() + self._equal @ bare
        spare = self._spare.copy()
        if self._count:
            gaps = measure_gaps(states[..., :3].reshape(-1, 3), self._near.edges, self._limits)
            spare[: self._count] = self._lacking(gaps.distance) + (self._upper @ bare)[: self._count]
        return self._solution(defects, spare)

    def _solution(self, defects: Array, spare: Array) -> ProgrammeStep | None:
        found = linprog(self._cost, self._upper, spare, self._equal, defects, self._bounds, method="highs")
        if found.x is None:
            return None
        motion, n = self.motion, len(self.motion.inputs)
        moved = motion._replace(
            states=motion.states + found.x[: self._inputs_at].reshape(n + 1, STATES),
            inputs=motion.inputs + found.x[self._inputs_at : self._durations_at].reshape(n, INPUTS),
            durations=motion.durations + found.x[self._durations_at : self._defects_at],
        )
        return ProgrammeStep(moved, motion.duration + float(found.fun), found.x)

    def _dynamics(self, states: Array, slopes: Array) -> None:
        """Each interval ends in the next one's first state."""
        n = len(self.motion.inputs)
        rows = np.arange(STATES * n).reshape(n, STATES)
        flat, ones = rows.ravel(), np.ones(STATES * n)
        entries = [
            (
                np.repeat(rows[:, :, None], UNKNOWNS_PER_INTERVAL, axis=2),
                np.repeat(self._columns[:, None], STATES, axis=1),
            ),
            (flat, STATES + flat),
            (flat, self._defects_at + flat),
            (flat, self._defects_at + STATES * n + flat),
        ]
        values = np.concatenate([slopes[-1].ravel(), -ones, ones, -ones])
        places = tuple(np.concatenate([item[axis].ravel() for item in entries]) for axis in (0, 1))
        self._equal = csr_array(coo_array((values, places), shape=(STATES * n, self._size)))
        self._defects = (self.motion.states[1:] - states[-1]).ravel()

    def _clearances(self, states: Array, slopes: Array, region: float) -> None:
        """Each pose within an interval keeps its distance to its nearest edges."""
        self._chosen: tuple[Indices, Indices] = (np.empty(0, dtype=np.intp), np.empty(0, dtype=np.intp))
        self._count = 0
        if not len(self._edges):
            return
        self._near = nearest_edges(states[..., :3].reshape(-1, 3), self._edges, self._limits)
        rows, edges = np.nonzero(self._near.distance < self._limits.clearance + 2.0 * region + 0.2)
        self._chosen, self._count = (rows, edges), len(rows)
        slope = slopes[..., :3, :].reshape(-1, 3, UNKNOWNS_PER_INTERVAL)[rows]
        self._approach = np.einsum("rk,rkj->rj", self._near.gradient[self._chosen], slope)
        self._approach_columns = np.tile(self._columns, (len(states), 1))[rows]

    def _inequalities(self) -> None:
        """Clearances, and efforts that are at least the wheels' rates to either side."""
        n, rows = len(self.motion.inputs), np.arange(self._count)
        wheel = self._inputs_at + INPUTS * np.arange(n) + 1
        entries = []
        if self._count:
            entries += [
                (np.repeat(rows, UNKNOWNS_PER_INTERVAL), self._approach_columns.ravel(), -self._approach.ravel())
            ]
            entries += [(rows, self._lacks_at + rows, -np.ones(self._count))]
        for side, sign in ((0, 1.0), (1, -1.0)):
            own = self._count + side * n + np.arange(n)
            entries += [(own, wheel, np.full(n, sign)), (own, self._efforts_at + np.arange(n), -np.ones(n))]
        parts = [np.concatenate([item[part] for item in entries]) for part in range(3)]
        shape = (self._count + 2 * n, self._size)
        self._upper = csr_array(coo_array((parts[2], (parts[0], parts[1])), shape=shape))
        rate = self.motion.inputs[:, 1]
        self._spare = np.concatenate([self._lacking(self._near.distance) if self._count else [], -rate, rate])

    def _lacking(self, distances: Array) -> Array:
        return np.asarray(distances[self._chosen] - self._limits.clearance)

    def _bounds_of(self, region: float) -> Array:
        """Trust region and limits; start and goal stay, and so does the standstill between two moves."""
        motion, limits = self.motion, self._limits
        low, high = np.zeros(self._size), np.full(self._size, np.inf)
        least, most = state_bounds(motion, limits)
        change = np.maximum(least - motion.states, -region * REACH), np.minimum(most - motion.states, region * REACH)
        fixed = np.zeros_like(motion.states, dtype=bool)
        fixed[[0, -1]] = True
        for values, bound in zip((low, high), change, strict=True):
            values[: self._inputs_at] = np.where(fixed, 0.0, bound).ravel()
        for values, bound in zip((low, high), input_bounds(motion, limits), strict=True):
            values[self._inputs_at : self._durations_at] = (bound - motion.inputs).ravel()
        stretch = min(region, MAX_STRETCH) * motion.durations
        low[self._durations_at : self._defects_at], high[self._durations_at : self._defects_at] = -stretch, stretch
        return np.stack([low, np.maximum(low, high)], axis=1)


def state_bounds(motion: TimedMotion, limits: MotionLimits) -> tuple[Array, Array]:
    """Return the least and greatest states: speeds in the gear of their move, standstill between two moves."""
    n = len(motion.inputs)
    low = np.full((n + 1, STATES), -np.inf)
    high = -low
    before = np.concatenate([motion.move_of[:1], motion.move_of])
    after = np.concatenate([motion.move_of, motion.move_of[-1:]])
    gear, stands = motion.gears[after], before != after
    low[:, 3] = np.where(stands | (gear > 0.0), 0.0, -limits.speed)
    high[:, 3] = np.where(stands | (gear < 0.0), 0.0, limits.speed)
    low[:, 4], high[:, 4] = -limits.wheel_angle, limits.wheel_angle
    return low, high


def input_bounds(motion: TimedMotion, limits: MotionLimits) -> tuple[Array, Array]:
    """Return the least and greatest inputs: a vehicle may slow down at another rate than it speeds up."""
    forward = motion.gears[motion.move_of] > 0.0
    least = -np.where(forward, limits.deceleration, limits.acceleration)
    most = np.where(forward, limits.acceleration, limits.deceleration)
    rate = np.full(len(forward), limits.wheel_rate)
    return np.stack([least, -rate], axis=1), np.stack([most, rate], axis=1)
