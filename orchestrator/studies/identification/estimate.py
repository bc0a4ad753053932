"""Weighted least squares with unknown noise, and the intervals of the result.

    minimise  sum r(theta)' r(theta) / s^2  +  sum ((theta - theta_0) / (20 a))^2

The noise ``s`` of each signal is that of its residuals. The second term, with the useful accuracy ``a``, keeps the
solution finite where a drive has no information. The variance of a parameter is the larger of two: that of white noise
times the integrated autocorrelation time of the residuals (Geyer's initial positive sequence), and that of scores
which are independent from window to window (cluster-robust, Liang and Zeger 1986) with Student's quantile.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.identification.parameter import PRIOR_RANGE, FitParameter
from orchestrator.studies.identification.playback import DEAD_TIME, dead_time_resolution
from orchestrator.studies.identification.problem import Problem
from orchestrator.studies.identification.signals import NOISE_FLOOR, TYPICAL_NOISE, unit_of

NORMAL_95 = 1.959963984540054
"""Two-sided 95 % quantile of the normal distribution."""
NOISE_ROUNDS = 2
DEAD_TIMES = (0.0, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3)
"""Starts [s] of a search that has many minima."""
MAX_LAG_SHARE = 0.25
"""Longest correlation time that is looked for, as a share of the samples."""
PARAMETER_TOLERANCE, COST_TOLERANCE = 1e-6, 1e-8
MAX_ITERATIONS = 12
"""Of one round; along a direction that the log does not determine there is no end."""


class Estimate(NamedTuple):
    """The solution, in the order of the candidates."""

    theta: Array
    half_widths: Array
    """Of the 95 % intervals."""
    noise: dict[str, float]
    """Standard deviation of each compared signal [SI]."""
    information: Array
    """Fisher information of the drive about the parameters, without prior [1/unit^2]."""
    correlation_times: dict[str, float]
    """Of the residuals of each signal [samples]; 1: white."""


def estimate(problem: Problem) -> Estimate:
    """Return the solution for a drive."""
    noise = {name: TYPICAL_NOISE[unit_of(name)] for name in problem.drive.compared}
    theta = _first_guess(problem, noise)
    for _ in range(NOISE_ROUNDS):
        theta = _solution(problem, theta, noise)
        noise = _noise(problem, theta, noise)
    theta = _solution(problem, theta, noise)
    residuals, jacobian = problem.residuals(theta, noise), problem.jacobian(theta, noise)
    times = {name: correlation_time(values) for name, values in residuals.items()}
    widened = np.concatenate([np.full(len(residuals[name]), times[name] ** -0.5) for name in noise])
    information = (jacobian * widened[:, None]).T @ (jacobian * widened[:, None])
    white = NORMAL_95 * np.sqrt(np.diag(covariance(information, problem.candidates)))
    weighted = np.concatenate([values / noise[name] for name, values in residuals.items()])
    half_widths = np.maximum(white, _cluster_half_widths(problem, jacobian, weighted)).astype(np.float64)
    for place, item in enumerate(problem.candidates):
        if item.name == DEAD_TIME:
            half_widths[place] += dead_time_resolution(float(theta[place]))
    return Estimate(theta, half_widths, noise, information, times)


def covariance(information: Array, candidates: list[FitParameter]) -> Array:
    """Return the covariance of the parameters after a drive with this information."""
    scale = np.array([item.accuracy for item in candidates])
    scaled = information * np.outer(scale, scale) + np.eye(len(scale)) / PRIOR_RANGE**2
    inverse: Array = np.linalg.inv(scaled).astype(np.float64)
    return inverse * np.outer(scale, scale)


def _cluster_half_widths(problem: Problem, jacobian: Array, weighted: Array) -> Array:
    """Return half widths of 95 % from the scores of the windows."""
    from scipy.stats import t as student

    count = problem.window_count
    scores = np.zeros((count, jacobian.shape[1]))
    np.add.at(scores, problem.windows, jacobian * weighted[:, None])
    inverse = covariance(jacobian.T @ jacobian, problem.candidates)
    spread = inverse @ (scores.T @ scores * count / (count - 1.0)) @ inverse
    half_widths: Array = float(student.ppf(0.975, count - 1)) * np.sqrt(np.diag(spread))
    return half_widths


def correlation_time(values: Array) -> float:
    """Return the integrated autocorrelation time [samples] of residuals, 1 at least."""
    centred = values - values.mean()
    power = float(centred @ centred)
    if power == 0.0 or len(values) < 4:
        return 1.0
    size = 1 << (2 * len(values) - 1).bit_length()
    spectrum = np.fft.rfft(centred, size)
    rho = np.fft.irfft(spectrum * spectrum.conj(), size)[: int(MAX_LAG_SHARE * len(values)) + 2] / power
    pairs = rho[: len(rho) // 2 * 2].reshape(-1, 2).sum(axis=1)
    ends = np.flatnonzero(pairs <= 0.0)
    return max(1.0, 2.0 * float(pairs[: ends[0] if len(ends) else len(pairs)].sum()) - 1.0)


def _first_guess(problem: Problem, noise: Mapping[str, float]) -> Array:
    """Return where to begin: the start values, and of several dead times the best."""
    theta = np.array([item.start for item in problem.candidates])
    names = [item.name for item in problem.candidates]
    if DEAD_TIME not in names:
        return theta
    starts = np.repeat(theta[None, :], len(DEAD_TIMES), axis=0)
    starts[:, names.index(DEAD_TIME)] = DEAD_TIMES
    costs = [float((problem.residual_vector(start, noise) ** 2).sum()) for start in starts]
    best: Array = starts[int(np.argmin(costs))]
    return best


def _solution(problem: Problem, theta: Array, noise: Mapping[str, float]) -> Array:
    from scipy.optimize import least_squares

    starts = np.array([item.start for item in problem.candidates])
    ranges = np.array([item.accuracy for item in problem.candidates]) * PRIOR_RANGE
    low, high = np.array([item.bounds for item in problem.candidates]).T

    def residuals(point: Array) -> Array:
        return np.append(problem.residual_vector(point, noise), (point - starts) / ranges)

    def jacobian(point: Array) -> Array:
        return np.vstack([problem.jacobian(point, noise), np.diag(1.0 / ranges)])

    found = least_squares(
        residuals,
        np.clip(theta, low + 1e-9, high - 1e-9),
        jac=jacobian,
        bounds=(low, high),
        x_scale=ranges,
        xtol=PARAMETER_TOLERANCE,
        ftol=COST_TOLERANCE,
        max_nfev=MAX_ITERATIONS,
    )
    solution: Array = found.x
    return solution


def _noise(problem: Problem, theta: Array, noise: Mapping[str, float]) -> dict[str, float]:
    """Return the standard deviation of each signal; each has its share of the freedom that the solution takes."""
    residuals = problem.residuals(theta, noise)
    total = sum(len(values) for values in residuals.values())
    taken = len(theta) + 3 * problem.window_count * len(problem.drive.frames)
    left = max(total - taken, 1) / total
    return {
        name: max(float(np.sqrt((values**2).mean() / left)), NOISE_FLOOR[unit_of(name)])
        for name, values in residuals.items()
    }
