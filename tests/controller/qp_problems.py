"""Random steering QPs, and the same as dense matrices for other solvers."""

from typing import Any

import numpy as np

from controller_fmu.zhang2022.qp import MAX_STAGES, Initial
from controller_fmu.zhang2022.qp_stage import HorizonStage, Weights

Problem = tuple[Initial, tuple[HorizonStage, ...], Weights]


def random_problem(rng: np.random.Generator) -> Problem:
    """Return start, stages, weights of a car at 0.1 to 3 m/s, forward or in reverse, on a winding path."""
    speed = rng.choice([-1, 1]) * rng.uniform(0.1, 3.0)
    time, wheelbase = rng.uniform(0.05, 0.3), rng.uniform(2.0, 3.5)
    lock, rate, corridor = rng.uniform(0.3, 0.7), rng.uniform(0.2, 1.5), rng.uniform(0.02, 0.3)
    costs = (rng.uniform(1, 200), rng.uniform(0.1, 50), rng.uniform(0, 1), rng.uniform(0.1, 50), rng.uniform(10, 1e4))
    weights = Weights._make([*map(float, costs), float(corridor), float(lock), float(rate * time)])
    stages, angle = [], rng.uniform(-lock, lock)
    for _ in range(MAX_STAGES):
        angle = float(np.clip(angle + rng.uniform(-0.1, 0.1), -lock, lock))
        gain = float(speed * time / (wheelbase * np.cos(angle) ** 2))
        stages.append(HorizonStage(float(speed * time), gain, 0.5 * float(speed * time) * gain, angle, 1.0))
    now = rng.uniform(-0.5, 0.5), rng.uniform(-0.4, 0.4), rng.uniform(-lock, lock)
    return Initial(float(now[0]), float(now[1]), float(now[2])), tuple(stages), weights


def dense(now: Initial, stages: tuple[HorizonStage, ...], w: Weights) -> tuple[Any, Any, Any, Any]:
    """Return H, f, G, h of min x'Hx/2 + f'x, Gx <= h with x = (u, s): the states are eliminated."""
    n = len(stages)
    hessian, gradient = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    rows, limits = [], []
    free, forced = np.array(now), np.zeros((3, 2 * n))
    for k, q in enumerate(stages):
        a = np.array([[1, q.a, q.c], [0, 1, q.g], [0, 0, 1]])
        free = a @ free - np.array([q.c, q.g, 0]) * q.r
        forced = a @ forced
        forced[:, k] += a[:, 2]
        cost = q.on * np.diag([w.q_e, w.q_psi, w.q_d])
        hessian += forced.T @ cost @ forced
        gradient += forced.T @ cost @ (free - np.array([0, 0, q.r]))
        hessian[k, k] += w.q_u
        hessian[n + k, n + k] += w.q_s
        soft, move = np.eye(2 * n)[n + k], np.eye(2 * n)[k]
        rows += [forced[0] - soft, -forced[0] - soft, forced[2], -forced[2], move, -move]
        limits += [
            w.limit_e - free[0],
            w.limit_e + free[0],
            w.limit_d - free[2],
            w.limit_d + free[2],
            w.limit_u,
            w.limit_u,
        ]
    return hessian, gradient, np.array(rows), np.array(limits)
