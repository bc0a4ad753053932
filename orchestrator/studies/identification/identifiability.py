"""Which parameters a log identifies; which it cannot separate or does not respond to; and what to drive instead.

With the Fisher information scaled by useful accuracies, a direction with singular value s is known to 1.96 / s useful
accuracies (95 %). Directions worse than 1 are undetermined, and the parameters with a large part in them are named.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.identification.estimate import NORMAL_95, Estimate, covariance
from orchestrator.studies.identification.manoeuvres import (
    MANOEUVRES,
    Manoeuvre,
    further_information,
    has_effect,
    manoeuvre_information,
)
from orchestrator.studies.identification.parameter import PRIOR_RANGE
from orchestrator.studies.identification.problem import Problem

LARGE_PART = 0.3
"""A parameter belongs to a direction if its part is so large, relative to the largest."""
HIGH_CORRELATION = 0.95


class Undetermined(NamedTuple):
    """Parameters that the log does not identify, and what would."""

    names: tuple[str, ...]
    """One: the log does not respond to it enough. Several: only a combination is determined."""
    manoeuvre: str
    """What to drive, logged as this drive was; empty if none of the known ones helps."""
    further_signals: str
    """What to drive with all signals logged, where ``manoeuvre`` is empty; empty if that does not help either."""
    half_widths: Mapping[str, float]
    """95 % half widths that both logs together would give."""
    is_without_effect: bool
    """Whether no manoeuvre and no signal shows any effect: it acts on nothing in this vehicle."""


class Identifiability(NamedTuple):
    """The information of a log about the parameters."""

    identified: tuple[bool, ...]
    singular_values: Array
    """Of the residuals' derivatives, by useful accuracies; falling."""
    directions: Array
    """Row k: the direction of singular value k."""
    correlations: Array
    """Of the estimates."""
    undetermined: list[Undetermined]


def identifiability(problem: Problem, found: Estimate) -> Identifiability:
    """Return which parameters a log identifies, and for the others what would."""
    candidates = problem.candidates
    accuracy = np.array([item.accuracy for item in candidates])
    identified = [bool(item) for item in found.half_widths <= accuracy]
    values, vectors = np.linalg.eigh(found.information * np.outer(accuracy, accuracy))
    values = np.maximum(values, 0.0)
    spread = covariance(found.information, candidates)
    sigma = np.sqrt(np.diag(spread))
    unknown = [place for place, item in enumerate(identified) if not item]
    groups = _groups(unknown, values, vectors)
    for place in (place for group in groups for place in group):
        identified[place] = False
    return Identifiability(
        tuple(identified),
        np.sqrt(values[::-1]),
        vectors.T[::-1],
        spread / np.outer(sigma, sigma),
        _with_manoeuvres(problem, found, groups),
    )


def _groups(unknown: Sequence[int], values: Array, vectors: Array) -> list[tuple[int, ...]]:
    """Return the parameters that are not identified, those together that share their worst direction."""
    found: dict[tuple[int, ...], None] = {}
    for place in unknown:
        worst = int(np.argmax(vectors[place] ** 2 / (values + PRIOR_RANGE**-2)))
        parts = np.abs(vectors[:, worst])
        is_known_alone = (vectors[place] ** 2 * values).sum() >= NORMAL_95**2
        members = np.flatnonzero(parts >= LARGE_PART * parts.max()).tolist()
        found[tuple({*members, place}) if is_known_alone else (place,)] = None
    merged: list[set[int]] = []
    for group in map(set, found):
        same = [other for other in merged if other & group]
        merged = [other for other in merged if other not in same] + [group.union(*same)]
    return sorted(tuple(sorted(group)) for group in merged)


def _with_manoeuvres(problem: Problem, found: Estimate, groups: list[tuple[int, ...]]) -> list[Undetermined]:
    """Return for each group the manoeuvre that identifies it best."""
    if not groups:
        return []
    arguments = problem, found.theta, found.noise
    planned = [(item, manoeuvre_information(*arguments, item)) for item in MANOEUVRES]
    complete: list[tuple[Manoeuvre, Array]] = []
    result = []
    for group in groups:
        names = tuple(problem.candidates[place].name for place in group)
        choice, further = _best_manoeuvre(problem, found, group, planned), None
        without = choice is None and not any(has_effect(problem, found.theta, place) for place in group)
        if choice is None and not without:
            complete = complete or [(item, further_information(*arguments, item)) for item in MANOEUVRES]
            further = _best_manoeuvre(problem, found, group, complete)
        best = choice or further
        result.append(
            Undetermined(
                names,
                "" if choice is None else choice[0].text,
                "" if further is None else further[0].text,
                {} if best is None else dict(zip(names, best[1], strict=True)),
                without,
            )
        )
    return result


def _best_manoeuvre(
    problem: Problem, found: Estimate, group: tuple[int, ...], planned: list[tuple[Manoeuvre, Array]]
) -> tuple[Manoeuvre, list[float]] | None:
    """Return the best manoeuvre if it identifies all parameters of a group, with their half widths."""
    accuracy = np.array([problem.candidates[place].accuracy for place in group])
    best: tuple[float, Manoeuvre, list[float]] | None = None
    for item, information in planned:
        sigma = np.sqrt(np.diag(covariance(found.information + information, problem.candidates)))
        half_widths = NORMAL_95 * sigma[list(group)]
        worst = float((half_widths / accuracy).max())
        if worst <= 1.0 and (best is None or worst < best[0]):
            best = worst, item, half_widths.tolist()
    return None if best is None else best[1:]
