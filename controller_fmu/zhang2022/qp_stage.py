"""One stage of the steering QP: its data, its iterate, and the algebra of a Newton step.

State x = (e, psi, d): lateral error, heading error, front-wheel angle. Input u: its increment.

    d+ = d + u,  psi+ = psi + g (d+ - r),  e+ = e + a psi + c (d+ - r)

Cost of the state reached: (q_e e^2 + q_psi psi^2 + q_d (d - r)^2 + q_u u^2 + q_s s^2) / 2.
Constraints, each with a slack t > 0 and a multiplier l > 0:
    1: e - s <= E   2: -e - s <= E   3: d <= D   4: -d <= D   5: u <= U   6: -u <= U
where s softens the limit on e: the problem always has a solution if the angle now is within +-D.
"""

from typing import NamedTuple


class HorizonStage(NamedTuple):
    """Prediction of one stage."""

    a: float
    """Speed times step time [m]."""
    g: float
    """Heading gained per angle [1]."""
    c: float
    """Lateral error gained per angle [m]."""
    r: float
    """Front-wheel angle of the path [rad]."""
    on: float
    """Share of the weights on the state: 1 within the horizon, 0 beyond."""


class Weights(NamedTuple):
    """Weights and limits, the same for all stages."""

    q_e: float
    q_psi: float
    q_d: float
    q_u: float
    q_s: float
    limit_e: float
    limit_d: float
    limit_u: float


class Six(NamedTuple):
    """One number for each of the six constraints."""

    c1: float
    c2: float
    c3: float
    c4: float
    c5: float
    c6: float


class Node(NamedTuple):
    """Iterate at one stage: state reached, input, softening, slacks t, multipliers l."""

    e: float
    psi: float
    d: float
    u: float
    s: float
    t: Six
    l: Six  # noqa: E741


class CostToGo(NamedTuple):
    """Quadratic cost to go x'Px/2 + p'x, P symmetric."""

    p11: float
    p12: float
    p13: float
    p22: float
    p23: float
    p33: float
    p1: float
    p2: float
    p3: float


class Gain(NamedTuple):
    """Newton step of the input as an affine function of that of the state before: k0 + k x."""

    k0: float
    k1: float
    k2: float
    k3: float


class Back(NamedTuple):
    """What the backward sweep gives at one stage."""

    value: CostToGo
    gain: Gain


def violation(node: Node, w: Weights) -> Six:
    """Return g + t - h of each constraint: zero once slacks and constraints agree."""
    t = node.t
    return Six(
        node.e - node.s + t.c1 - w.limit_e,
        -node.e - node.s + t.c2 - w.limit_e,
        node.d + t.c3 - w.limit_d,
        -node.d + t.c4 - w.limit_d,
        node.u + t.c5 - w.limit_u,
        -node.u + t.c6 - w.limit_u,
    )


def affine_multipliers(node: Node, w: Weights, mu: float) -> Six:
    """Return l + (l r - (l t - mu)) / t = (l r + mu) / t: multipliers if the state did not move."""
    r = violation(node, w)
    t, m = node.t, node.l
    return Six(
        (m.c1 * r.c1 + mu) / t.c1,
        (m.c2 * r.c2 + mu) / t.c2,
        (m.c3 * r.c3 + mu) / t.c3,
        (m.c4 * r.c4 + mu) / t.c4,
        (m.c5 * r.c5 + mu) / t.c5,
        (m.c6 * r.c6 + mu) / t.c6,
    )


def softening_step(node: Node, w: Weights, push: Six, step_e: float) -> float:
    """Return the Newton step of s that belongs to one of e."""
    b1, b2 = node.l.c1 / node.t.c1, node.l.c2 / node.t.c2
    return -(w.q_s * node.s - push.c1 - push.c2 + (b2 - b1) * step_e) / (w.q_s + b1 + b2)


def backward(after: CostToGo, node: Node, stage: HorizonStage, w: Weights, mu: float) -> Back:
    """Return value and gain of a stage from the value after it: one step of the Riccati recursion.

    Node costs and barrier terms are added to the value after, s is eliminated, the dynamics x+ = A (d + u)
    substituted, and the result minimised over u.
    """
    push = affine_multipliers(node, w, mu)
    t, m = node.t, node.l
    b1, b2 = m.c1 / t.c1, m.c2 / t.c2
    h_es, h_ss = b2 - b1, w.q_s + b1 + b2
    g_s = w.q_s * node.s - push.c1 - push.c2
    m11 = after.p11 + stage.on * w.q_e + b1 + b2 - h_es * h_es / h_ss
    m22 = after.p22 + stage.on * w.q_psi
    m33 = after.p33 + stage.on * w.q_d + m.c3 / t.c3 + m.c4 / t.c4
    g1 = after.p1 + stage.on * w.q_e * node.e + push.c1 - push.c2 - h_es * g_s / h_ss
    g2 = after.p2 + stage.on * w.q_psi * node.psi
    g3 = after.p3 + stage.on * w.q_d * (node.d - stage.r) + push.c3 - push.c4
    moved = _through_dynamics(CostToGo(m11, after.p12, after.p13, m22, after.p23, m33, g1, g2, g3), stage)
    h_uu = w.q_u + m.c5 / t.c5 + m.c6 / t.c6 + moved.p33
    g_u = w.q_u * node.u + push.c5 - push.c6 + moved.p3
    gain = Gain(-g_u / h_uu, -moved.p13 / h_uu, -moved.p23 / h_uu, -moved.p33 / h_uu)
    return Back(_minimise(moved, gain, g_u), gain)


def _through_dynamics(v: CostToGo, stage: HorizonStage) -> CostToGo:
    """Return A'PA and A'p for A = [[1, a, c], [0, 1, g], [0, 0, 1]]."""
    a, g, c = stage.a, stage.g, stage.c
    b1, b2 = a * v.p11 + v.p12, a * v.p12 + v.p22
    c1 = c * v.p11 + g * v.p12 + v.p13
    c2 = c * v.p12 + g * v.p22 + v.p23
    c3 = c * v.p13 + g * v.p23 + v.p33
    return CostToGo(
        v.p11, b1, c1, a * b1 + b2, a * c1 + c2, c * c1 + g * c2 + c3, v.p1, a * v.p1 + v.p2, c * v.p1 + g * v.p2 + v.p3
    )


def _minimise(v: CostToGo, k: Gain, g_u: float) -> CostToGo:
    """Return the value before the input from that after it, with the best input put in."""
    return CostToGo(
        v.p11 + v.p13 * k.k1,
        v.p12 + v.p13 * k.k2,
        v.p13 + v.p13 * k.k3,
        v.p22 + v.p23 * k.k2,
        v.p23 + v.p23 * k.k3,
        v.p33 + v.p33 * k.k3,
        v.p1 + k.k1 * g_u,
        v.p2 + k.k2 * g_u,
        v.p3 + k.k3 * g_u,
    )


def forward(before: Node, gain: Gain, node: Node, stage: HorizonStage, w: Weights, mu: float) -> Node:
    """Return the Newton step of a stage, in the shape of a node, from the step of the stage before."""
    u = gain.k0 + gain.k1 * before.e + gain.k2 * before.psi + gain.k3 * before.d
    d = before.d + u
    psi = before.psi + stage.g * d
    e = before.e + stage.a * before.psi + stage.c * d
    push = affine_multipliers(node, w, mu)
    s = softening_step(node, w, push, e)
    r = violation(node, w)
    t = Six(-r.c1 - e + s, -r.c2 + e + s, -r.c3 - d, -r.c4 + d, -r.c5 - u, -r.c6 + u)
    return Node(e, psi, d, u, s, t, _multiplier_step(node, t, mu))


def _multiplier_step(node: Node, step: Six, mu: float) -> Six:
    """Return (mu - l t - l dt) / t for each constraint."""
    t, m = node.t, node.l
    return Six(
        (mu - m.c1 * (t.c1 + step.c1)) / t.c1,
        (mu - m.c2 * (t.c2 + step.c2)) / t.c2,
        (mu - m.c3 * (t.c3 + step.c3)) / t.c3,
        (mu - m.c4 * (t.c4 + step.c4)) / t.c4,
        (mu - m.c5 * (t.c5 + step.c5)) / t.c5,
        (mu - m.c6 * (t.c6 + step.c6)) / t.c6,
    )


def move_node(node: Node, step: Node, length: float) -> Node:
    """Return the node moved along its step."""
    return Node(
        node.e + length * step.e,
        node.psi + length * step.psi,
        node.d + length * step.d,
        node.u + length * step.u,
        node.s + length * step.s,
        _along(node.t, step.t, length),
        _along(node.l, step.l, length),
    )


def _along(x: Six, dx: Six, length: float) -> Six:
    return Six(
        x.c1 + length * dx.c1,
        x.c2 + length * dx.c2,
        x.c3 + length * dx.c3,
        x.c4 + length * dx.c4,
        x.c5 + length * dx.c5,
        x.c6 + length * dx.c6,
    )


def longest(node: Node, step: Node, length: float) -> float:
    """Return ``length`` or what of it keeps every slack and multiplier of the node positive."""
    return _within(node.l, step.l, _within(node.t, step.t, length))


def _within(x: Six, dx: Six, length: float) -> float:
    for index in range(6):
        if x[index] + length * dx[index] < 0.0:
            length = -x[index] / dx[index]
    return length


def complementarity(node: Node) -> float:
    """Return the sum of l t over the six constraints."""
    t, m = node.t, node.l
    return m.c1 * t.c1 + m.c2 * t.c2 + m.c3 * t.c3 + m.c4 * t.c4 + m.c5 * t.c5 + m.c6 * t.c6


def infeasibility(node: Node, w: Weights) -> float:
    """Return the largest disagreement of a slack with its constraint."""
    r = violation(node, w)
    worst = 0.0
    for index in range(6):
        if abs(r[index]) > worst:
            worst = abs(r[index])
    return worst
