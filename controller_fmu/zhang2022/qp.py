"""The steering QP over a fixed horizon, solved by a primal-dual interior-point method of our own.

Each iteration is one Riccati sweep backward and one forward over the stages, so its cost grows with
the horizon, not its cube, and no matrix is ever stored. The sizes are
fixed and nothing is allocated.
Start: no steering movement; slacks and multipliers of at least a small number.
"""

from enum import IntEnum
from typing import NamedTuple

from controller_fmu.zhang2022.qp_stage import (
    CostToGo,
    Gain,
    HorizonStage,
    Node,
    Six,
    Weights,
    backward,
    complementarity,
    forward,
    infeasibility,
    longest,
    move_node,
)
from modelkit.maths import clamp

MAX_STAGES = 12
CONSTRAINT_COUNT = 6.0 * MAX_STAGES
FIRST_GAP = 1000.0
"""Multiplier times slack at the start: large against any weight, found to need the fewest iterations."""
SMALLEST_SLACK = 0.1
NOTHING = CostToGo(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
AT_REST = Six(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
ORIGIN = Node(0.0, 0.0, 0.0, 0.0, 0.0, AT_REST, AT_REST)
NO_GAIN = Gain(0.0, 0.0, 0.0, 0.0)


class Status(IntEnum):
    """How the solver ended."""

    NOT_RUN = 0
    SOLVED = 1
    ITERATION_CAP = 2
    FAILED = 3
    """Not finite, or the angle now is outside its limit."""


Nodes = tuple[Node, ...]
Stages = tuple[HorizonStage, ...]
Gains = tuple[Gain, ...]


class Initial(NamedTuple):
    """Where the horizon begins."""

    e: float
    """Lateral error [m]."""
    psi: float
    """Heading error [rad]."""
    d: float
    """Front-wheel angle [rad]."""


class Solution(NamedTuple):
    """Last iterate and how it came about."""

    nodes: Nodes = (ORIGIN,) * MAX_STAGES
    status: int = Status.NOT_RUN
    iterations: int = 0
    gap: float = 0.0
    """Mean of multiplier times slack."""


def solve(now: Initial, stages: Stages, weights: Weights, tolerance: float, cap: int) -> Solution:
    """Return the optimal steering over the horizon.

    Stops when the mean complementarity and the largest infeasibility are below ``tolerance``, or
    after ``cap`` iterations. Each iteration aims at a share of the present complementarity, the
    smaller the longer the last step was.
    """
    nodes = _start(Node(now.e, now.psi, now.d, 0.0, 0.0, AT_REST, AT_REST), stages, weights)
    share = 0.2
    gap = _gap(nodes)
    for iteration in range(cap):
        if not gap < 1e12:
            return Solution(nodes, Status.FAILED, iteration, gap)
        if gap < tolerance and _worst(nodes, weights) < tolerance:
            return Solution(nodes, Status.SOLVED, iteration, gap)
        mu = share * gap
        steps = _forward(_backward(nodes, stages, weights, mu), nodes, stages, weights, mu)
        length = _length(nodes, steps)
        nodes = _move_nodes(nodes, steps, length)
        share = _next_share(length)
        gap = _gap(nodes)
    solved = gap < tolerance and _worst(nodes, weights) < tolerance
    return Solution(nodes, Status.SOLVED if solved else Status.ITERATION_CAP, cap, gap)


def _next_share(length: float) -> float:
    rest = 1.0 - length
    return clamp(rest * rest, 0.005, 0.9)


def _length(nodes: Nodes, steps: Nodes) -> float:
    length = 1.0 / 0.99
    for node, step in zip(nodes, steps, strict=True):
        length = longest(node, step, length)
    return 0.99 * length


def _gap(nodes: Nodes) -> float:
    total = 0.0
    for node in nodes:
        total = total + complementarity(node)
    return total / CONSTRAINT_COUNT


def _worst(nodes: Nodes, w: Weights) -> float:
    worst = 0.0
    for node in nodes:
        worst = max(worst, infeasibility(node, w))
    return worst


def first_node(before: Node, stage: HorizonStage, w: Weights) -> Node:
    """Return a node reached without steering movement, with slacks and multipliers inside."""
    psi = before.psi + stage.g * (before.d - stage.r)
    e = before.e + stage.a * before.psi + stage.c * (before.d - stage.r)
    over = abs(e) - w.limit_e
    s = max(0.0, over)
    t = Six(
        _inside(w.limit_e + s - e),
        _inside(w.limit_e + s + e),
        _inside(w.limit_d - before.d),
        _inside(w.limit_d + before.d),
        _inside(w.limit_u),
        _inside(w.limit_u),
    )
    gap = FIRST_GAP
    m = Six(gap / t.c1, gap / t.c2, gap / t.c3, gap / t.c4, gap / t.c5, gap / t.c6)
    return Node(e, psi, before.d, 0.0, s, t, m)


def _inside(slack: float) -> float:
    return max(SMALLEST_SLACK, slack)


def _start(now: Node, q: Stages, w: Weights) -> Nodes:
    nodes: Nodes = (now,) * MAX_STAGES
    before = now
    for stage in q:
        before = first_node(before, stage, w)
        nodes = nodes[1:] + (before,)
    return nodes


def _backward(n: Nodes, q: Stages, w: Weights, mu: float) -> Gains:
    gains: Gains = (NO_GAIN,) * MAX_STAGES
    value = NOTHING
    for index in range(MAX_STAGES - 1, -1, -1):
        back = backward(value, n[index], q[index], w, mu)
        value = back.value
        gains = (back.gain,) + gains[:-1]
    return gains


def _forward(k: Gains, n: Nodes, q: Stages, w: Weights, mu: float) -> Nodes:
    step = ORIGIN
    steps: Nodes = (ORIGIN,) * MAX_STAGES
    for index in range(MAX_STAGES):
        step = forward(step, k[index], n[index], q[index], w, mu)
        steps = steps[1:] + (step,)
    return steps


def _move_nodes(n: Nodes, s: Nodes, length: float) -> Nodes:
    return tuple(move_node(node, step, length) for node, step in zip(n, s, strict=True))
