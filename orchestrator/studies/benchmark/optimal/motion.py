"""Motions of the kinematic single track with inputs that are constant in each interval, and their derivatives.

State: x, y [m], heading [rad], speed [m/s], front-wheel angle [rad]. Inputs: acceleration [m/s2], rate of the
front-wheel angle [rad/s]. A motion is a chain of moves, each in one gear and with a duration of its own, in equal
intervals.
"""

from typing import NamedTuple

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array, Indices

STATES, INPUTS = 5, 2
STEPS_PER_INTERVAL = 10
"""Runge-Kutta steps in each interval."""
DIFFERENCE_STEP = 1e-6
"""Step of the central differences."""


class MotionLimits(NamedTuple):
    """What the vehicle can and may do, in SI units; the outline is ``ahead`` of the rear axle by its middle."""

    speed: float
    acceleration: float
    deceleration: float
    wheel_angle: float
    wheel_rate: float
    wheelbase: float
    clearance: float
    half_length: float
    half_width: float
    ahead: float


class TimedMotion(NamedTuple):
    """A chain of moves from one pose to another."""

    states: Array
    """At the ends of the intervals, (n + 1, 5)."""
    inputs: Array
    """(n, 2)"""
    durations: Array
    """Of the moves [s]."""
    move_of: Indices
    """Move of each interval, (n,)."""
    gears: Array
    """Of the moves: 1 forward, -1 in reverse."""

    @property
    def interval_counts(self) -> Indices:
        """Intervals of each move."""
        return np.bincount(self.move_of, minlength=len(self.durations))

    @property
    def intervals(self) -> Array:
        """Duration of each interval [s], (n, 1)."""
        return (self.durations / self.interval_counts)[self.move_of][:, None]

    @property
    def duration(self) -> float:
        """[s]"""
        return float(self.durations.sum())


def state_rates(states: Array, inputs: Array, wheelbase: float) -> Array:
    """Return the derivatives of states by time: x' = v cos h, y' = v sin h, h' = v tan(wheel) / wheelbase."""
    heading, speed, wheel = states[..., 2], states[..., 3], states[..., 4]
    turning = speed * np.tan(wheel) / wheelbase
    return np.stack(
        [speed * np.cos(heading), speed * np.sin(heading), turning, inputs[..., 0], inputs[..., 1]], axis=-1
    )


def integrate(
    states: Array, inputs: Array, intervals: Array, wheelbase: float, substeps: int = STEPS_PER_INTERVAL
) -> Array:
    """Return the states after each Runge-Kutta step of every interval, (substeps, n, 5)."""
    h, found = intervals / substeps, []
    for _ in range(substeps):
        k1 = state_rates(states, inputs, wheelbase)
        k2 = state_rates(states + 0.5 * h * k1, inputs, wheelbase)
        k3 = state_rates(states + 0.5 * h * k2, inputs, wheelbase)
        k4 = state_rates(states + h * k3, inputs, wheelbase)
        states = states + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        found.append(states)
    return np.stack(found)


def integrate_motion(motion: TimedMotion, wheelbase: float, substeps: int = STEPS_PER_INTERVAL) -> Array:
    """Return the states within the intervals, each from its own first state, (substeps, n, 5)."""
    return integrate(motion.states[:-1], motion.inputs, motion.intervals, wheelbase, substeps)


def derivatives(motion: TimedMotion, wheelbase: float) -> Array:
    """Return the derivatives of ``integrate_motion`` by state, inputs and duration of the move, (substeps, n, 5, 8)."""
    columns = []
    for place in range(STATES + INPUTS + 1):
        ends = []
        for step in (DIFFERENCE_STEP, -DIFFERENCE_STEP):
            states, inputs, intervals = motion.states[:-1].copy(), motion.inputs.copy(), motion.intervals
            if place < STATES:
                states[:, place] += step
            elif place < STATES + INPUTS:
                inputs[:, place - STATES] += step
            else:
                intervals = intervals + step / motion.interval_counts[motion.move_of][:, None]
            ends.append(integrate(states, inputs, intervals, wheelbase))
        columns.append((ends[0] - ends[1]) / (2.0 * DIFFERENCE_STEP))
    return np.stack(columns, axis=-1)


def drive_through(motion: TimedMotion, wheelbase: float, substeps: int) -> Array:
    """Return the states of the inputs applied from the first state on, without a correction at the intervals' ends."""
    state, found = motion.states[:1], [motion.states[:1]]
    for number, interval in enumerate(motion.intervals):
        steps = integrate(state, motion.inputs[number : number + 1], interval[None], wheelbase, substeps)
        found.append(steps[:, 0])
        state = steps[-1]
    return np.concatenate(found)
