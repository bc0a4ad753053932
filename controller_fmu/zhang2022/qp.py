"""The steering QP over a fixed horizon, solved by a primal-dual interior-point method of our own.

Each iteration is one Riccati sweep backward and one forward over the stages, so its cost grows with
the horizon, not its cube, and no matrix is ever stored. The sweeps are written out stage by stage:
the sizes are fixed, nothing is allocated, and the same code runs in CPython and compiled.
Start: no steering movement; slacks and multipliers of at least a small number.
"""

from enum import IntEnum
from typing import NamedTuple

from controller_fmu.zhang2022.qp_stage import (
    Gain,
    Node,
    Six,
    Stage,
    Value,
    Weights,
    backward,
    complementarity,
    forward,
    infeasibility,
    longest,
    moved,
)

STAGES = 12
CONSTRAINTS = 6.0 * STAGES
FIRST_GAP = 1000.0
"""Multiplier times slack at the start: large against any weight, found to need the fewest iterations."""
SMALLEST_SLACK = 0.1
NOTHING = Value(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
AT_REST = Six(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Status(IntEnum):
    """How the solver ended."""

    NOT_RUN = 0
    SOLVED = 1
    ITERATION_CAP = 2
    FAILED = 3
    """Not finite, or the angle now is outside its limit."""


Nodes = tuple[Node, Node, Node, Node, Node, Node, Node, Node, Node, Node, Node, Node]
Stages = tuple[Stage, Stage, Stage, Stage, Stage, Stage, Stage, Stage, Stage, Stage, Stage, Stage]
Gains = tuple[Gain, Gain, Gain, Gain, Gain, Gain, Gain, Gain, Gain, Gain, Gain, Gain]


class Solution(NamedTuple):
    """Last iterate and how it came about."""

    nodes: Nodes
    status: int
    iterations: int
    gap: float
    """Mean of multiplier times slack."""


def solve(e: float, psi: float, d: float, stages: Stages, weights: Weights, tolerance: float, cap: int) -> Solution:
    """Return the optimal steering over the horizon from lateral error, heading error and angle now.

    Stops when the mean complementarity and the largest infeasibility are below ``tolerance``, or
    after ``cap`` iterations. Each iteration aims at a share of the present complementarity, the
    smaller the longer the last step was.
    """
    nodes = _start(Node(e, psi, d, 0.0, 0.0, AT_REST, AT_REST), stages, weights)
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
        nodes = _moved(nodes, steps, length)
        share = _next_share(length)
        gap = _gap(nodes)
    solved = gap < tolerance and _worst(nodes, weights) < tolerance
    return Solution(nodes, Status.SOLVED if solved else Status.ITERATION_CAP, cap, gap)


def _next_share(length: float) -> float:
    rest = 1.0 - length
    share = rest * rest
    if share < 0.005:
        return 0.005
    return share if share < 0.9 else 0.9


def _length(nodes: Nodes, steps: Nodes) -> float:
    length = 1.0 / 0.99
    for index in range(STAGES):
        length = longest(nodes[index], steps[index], length)
    return 0.99 * length


def _gap(nodes: Nodes) -> float:
    total = 0.0
    for index in range(STAGES):
        total = total + complementarity(nodes[index])
    return total / CONSTRAINTS


def _worst(nodes: Nodes, w: Weights) -> float:
    worst = 0.0
    for index in range(STAGES):
        value = infeasibility(nodes[index], w)
        if value > worst:
            worst = value
    return worst


def first_node(before: Node, stage: Stage, w: Weights) -> Node:
    """Return a node reached without steering movement, with slacks and multipliers inside."""
    psi = before.psi + stage.g * (before.d - stage.r)
    e = before.e + stage.a * before.psi + stage.c * (before.d - stage.r)
    over = abs(e) - w.limit_e
    s = over if over > 0.0 else 0.0
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
    return slack if slack > SMALLEST_SLACK else SMALLEST_SLACK


def _start(now: Node, q: Stages, w: Weights) -> Nodes:
    n0 = first_node(now, q[0], w)
    n1 = first_node(n0, q[1], w)
    n2 = first_node(n1, q[2], w)
    n3 = first_node(n2, q[3], w)
    n4 = first_node(n3, q[4], w)
    n5 = first_node(n4, q[5], w)
    n6 = first_node(n5, q[6], w)
    n7 = first_node(n6, q[7], w)
    n8 = first_node(n7, q[8], w)
    n9 = first_node(n8, q[9], w)
    n10 = first_node(n9, q[10], w)
    return (n0, n1, n2, n3, n4, n5, n6, n7, n8, n9, n10, first_node(n10, q[11], w))


def _backward(n: Nodes, q: Stages, w: Weights, mu: float) -> Gains:
    b11 = backward(NOTHING, n[11], q[11], w, mu)
    b10 = backward(b11.value, n[10], q[10], w, mu)
    b9 = backward(b10.value, n[9], q[9], w, mu)
    b8 = backward(b9.value, n[8], q[8], w, mu)
    b7 = backward(b8.value, n[7], q[7], w, mu)
    b6 = backward(b7.value, n[6], q[6], w, mu)
    b5 = backward(b6.value, n[5], q[5], w, mu)
    b4 = backward(b5.value, n[4], q[4], w, mu)
    b3 = backward(b4.value, n[3], q[3], w, mu)
    b2 = backward(b3.value, n[2], q[2], w, mu)
    b1 = backward(b2.value, n[1], q[1], w, mu)
    b0 = backward(b1.value, n[0], q[0], w, mu)
    first = (b0.gain, b1.gain, b2.gain, b3.gain, b4.gain, b5.gain)
    return first + (b6.gain, b7.gain, b8.gain, b9.gain, b10.gain, b11.gain)


def _forward(k: Gains, n: Nodes, q: Stages, w: Weights, mu: float) -> Nodes:
    s0 = forward(Node(0.0, 0.0, 0.0, 0.0, 0.0, AT_REST, AT_REST), k[0], n[0], q[0], w, mu)
    s1 = forward(s0, k[1], n[1], q[1], w, mu)
    s2 = forward(s1, k[2], n[2], q[2], w, mu)
    s3 = forward(s2, k[3], n[3], q[3], w, mu)
    s4 = forward(s3, k[4], n[4], q[4], w, mu)
    s5 = forward(s4, k[5], n[5], q[5], w, mu)
    s6 = forward(s5, k[6], n[6], q[6], w, mu)
    s7 = forward(s6, k[7], n[7], q[7], w, mu)
    s8 = forward(s7, k[8], n[8], q[8], w, mu)
    s9 = forward(s8, k[9], n[9], q[9], w, mu)
    s10 = forward(s9, k[10], n[10], q[10], w, mu)
    return (s0, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, forward(s10, k[11], n[11], q[11], w, mu))


def _moved(n: Nodes, s: Nodes, length: float) -> Nodes:
    return (
        moved(n[0], s[0], length),
        moved(n[1], s[1], length),
        moved(n[2], s[2], length),
        moved(n[3], s[3], length),
        moved(n[4], s[4], length),
        moved(n[5], s[5], length),
        moved(n[6], s[6], length),
        moved(n[7], s[7], length),
        moved(n[8], s[8], length),
        moved(n[9], s[9], length),
        moved(n[10], s[10], length),
        moved(n[11], s[11], length),
    )
