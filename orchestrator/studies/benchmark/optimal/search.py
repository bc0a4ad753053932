"""A sequence of linear programmes in a trust region, with an exact L1 penalty (Fletcher and Sainz de la Maza 1989).

Time-optimal inputs lie at their bounds almost everywhere, as solutions of linear programmes do. A second-order
correction keeps steps along curved constraints from being refused. The result is a local optimum.
"""

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.benchmark.optimal.motion import MotionLimits, TimedMotion, integrate_motion
from orchestrator.studies.benchmark.optimal.program import (
    CLEARANCE_PRICE,
    DEFECT_PRICE,
    EFFORT_PRICE,
    LinearProgramme,
    input_bounds,
    nearest_edges,
    state_bounds,
)

MAX_PROGRAMMES = 80
FIRST_REGION, MAX_REGION, MIN_REGION = 0.5, 2.0, 1e-4
ENOUGH_GAIN = 1e-3
"""The search ends when a step promises a smaller share of the merit ..."""
MAX_DEFECTS = 1e-4
"""... and the defects sum up to less."""
GOOD_STEP, BAD_STEP, TAKEN_STEP = 0.7, 0.25, 0.1
"""Share of the promised gain from which the region grows, below which it shrinks, above which a step is taken."""


def violations(motion: TimedMotion, edges: Array, limits: MotionLimits) -> tuple[float, float]:
    """Return the sums of all defects of the dynamics and of what clearances lack [m]."""
    states = integrate_motion(motion, limits.wheelbase)
    defects = float(np.abs(states[-1] - motion.states[1:]).sum())
    if not len(edges):
        return defects, 0.0
    near = nearest_edges(states[..., :3].reshape(-1, 3), edges, limits)
    return defects, float(np.maximum(limits.clearance - near.distance, 0.0).sum())


def merit(motion: TimedMotion, edges: Array, limits: MotionLimits) -> float:
    """Return the duration [s], what turning the wheels and what violations cost."""
    defects, lacking = violations(motion, edges, limits)
    effort = float(np.abs(motion.inputs[:, 1:] * motion.intervals).sum())
    return motion.duration + EFFORT_PRICE * effort + DEFECT_PRICE * defects + CLEARANCE_PRICE * lacking


def optimize(motion: TimedMotion, edges: Array, limits: MotionLimits) -> TimedMotion:
    """Return the time-optimal motion near ``motion``, with its start, goal and gears, among ``edges`` (e, 2, 2)."""
    now = motion._replace(
        states=np.clip(motion.states, *state_bounds(motion, limits)),
        inputs=np.clip(motion.inputs, *input_bounds(motion, limits)),
    )
    value, region = merit(now, edges, limits), FIRST_REGION
    for _ in range(MAX_PROGRAMMES):
        programme = LinearProgramme(now, edges, limits, region)
        step = programme.solve()
        if step is None:
            region *= 0.5
            continue
        after, reached, promised = step.motion, merit(step.motion, edges, limits), value - step.predicted
        if promised < ENOUGH_GAIN * value and violations(now, edges, limits)[0] < MAX_DEFECTS:
            break
        if value - reached < GOOD_STEP * promised and (again := programme.solve_again(step)) is not None:
            other = merit(again.motion, edges, limits)
            after, reached = (again.motion, other) if other < reached else (after, reached)
        gain = value - reached
        if gain > TAKEN_STEP * promised:
            now, value = after, reached
        region = region * (2.0 if gain > GOOD_STEP * promised else 0.5 if gain < BAD_STEP * promised else 1.0)
        region = min(region, MAX_REGION)
        if region < MIN_REGION:
            break
    return now
