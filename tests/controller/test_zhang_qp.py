"""The steering QP against OSQP and DAQP, and against its own optimality conditions."""

from typing import Any

import daqp
import numpy as np
import osqp
import pytest
import scipy.sparse

from controller_fmu.zhang2022.qp import MAX_STAGES, Initial, Status, solve
from tests.controller.qp_problems import dense, random_problem


def steering(solution: Any) -> Any:
    return np.array([node.u for node in solution.nodes])


@pytest.mark.parametrize("count", [400, pytest.param(2000, marks=pytest.mark.release)])
def test_random_problems_against_daqp(count: int) -> None:
    rng = np.random.default_rng(2022)
    worst = 0.0
    for _ in range(count):
        problem = random_problem(rng)
        ours = solve(*problem, 1e-12, 60)
        assert ours.status == Status.SOLVED
        h, f, g, limit = dense(*problem)
        theirs, _, flag, _ = daqp.solve(h, f, g, limit, np.full_like(limit, -1e30))
        assert flag == 1
        worst = max(worst, np.abs(steering(ours) - theirs[:MAX_STAGES]).max())
    assert worst < 1e-6


@pytest.mark.parametrize("count", [100, pytest.param(300, marks=pytest.mark.release)])
def test_random_problems_against_osqp(count: int) -> None:
    rng = np.random.default_rng(7)
    worst, compared = 0.0, 0
    for _ in range(count):
        problem = random_problem(rng)
        h, f, g, limit = dense(*problem)
        solver = osqp.OSQP()
        solver.setup(
            scipy.sparse.triu(h, format="csc"), f, scipy.sparse.csc_matrix(g), np.full_like(limit, -np.inf), limit,
            eps_abs=1e-9, eps_rel=1e-9, max_iter=200_000, polishing=True, verbose=False,
        )  # fmt: skip
        theirs = solver.solve(raise_error=False)
        if theirs.info.status == "solved":
            compared += 1
            worst = max(worst, np.abs(steering(solve(*problem, 1e-12, 60)) - theirs.x[:MAX_STAGES]).max())
    assert compared > 0.96 * count
    assert worst < 1e-6


def test_limits_hold_and_the_soft_one_gives() -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        now, stages, w = random_problem(rng)
        found = solve(now._replace(e=1.5), stages, w, 1e-10, 60)
        assert found.status == Status.SOLVED
        for node in found.nodes:
            assert abs(node.d) <= w.limit_d + 1e-8
            assert abs(node.u) <= w.limit_u + 1e-8
            assert abs(node.e) <= w.limit_e + node.s + 1e-8


def test_iteration_cap_is_reported() -> None:
    problem = random_problem(np.random.default_rng(1))
    assert solve(*problem, 1e-12, 2).status == Status.ITERATION_CAP


@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
def test_bad_numbers_end_in_failed(bad: Any) -> None:
    now, stages, w = random_problem(np.random.default_rng(1))
    assert solve(now._replace(e=bad), stages, w, 1e-10, 40).status in (Status.FAILED, Status.ITERATION_CAP)


def test_mirrored_problem_has_the_mirrored_solution() -> None:
    rng = np.random.default_rng(5)
    for _ in range(20):
        now, stages, w = random_problem(rng)
        opposite = Initial(-now.e, -now.psi, -now.d)
        mirrored = tuple(stage._replace(r=-stage.r) for stage in stages)
        left, right = solve(now, stages, w, 1e-12, 60), solve(opposite, mirrored, w, 1e-12, 60)
        assert steering(left) == pytest.approx(-steering(right), abs=1e-9)
