"""A study: runs of one scenario that differ in numbers, and what is kept of each. Made from a file or by a function."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

from orchestrator.evaluation.verdict.measures import Measure
from orchestrator.evaluation.verdict.numbers import Metric
from orchestrator.inputs.scenario.requirements import Requirement
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.study.design import Design
from orchestrator.studies.sweep.study.space import Space

Columns = Mapping[str, Any]
"""Columns of a table by name, as arrays."""


class DerivedParameter(NamedTuple):
    """Columns that a study makes of the others."""

    columns: Mapping[str, Metric]
    make: Callable[[Columns], Mapping[str, Array]]
    """Called with labels, numbers and measures of some runs."""
    words: Mapping[str, str] = MappingProxyType({})
    """Further columns, of words, and what they mean."""


class Objective(NamedTuple):
    """A requirement with the margin of each run: what a search of the study's ranges tries to break."""

    name: str
    text: str
    limits: Sequence[Requirement] = ()
    """The scenario of a run that breaks it is judged by these."""
    margins: Callable[[Columns], Array] | None = None
    """From the columns of some runs; 0 or less: broken. None: the least margin of ``limits``."""


NONE: Mapping[str, Any] = MappingProxyType({})
NOTHING = DerivedParameter({}, lambda columns: {})


class Study(NamedTuple):
    """All that a sweep needs; nothing in it depends on how the runs are done."""

    scenario: Scenario
    """What all runs share, limits included."""
    design: Design
    content: Mapping[str, Any]
    """What it was made from, as the table carries it: ``name``, ``title``, ``description``, ``map`` and more."""
    seeded: Sequence[tuple[str, str, int]] = ()
    """(model, parameter, place) of the parameters that take the run's seed."""
    measures: Mapping[str, Measure] = NONE
    """Kept beside those of the summary, by the names of their columns."""
    within: Mapping[str, list[Requirement]] = NONE
    """Sets of limits that do not decide about the outcome: each is a column ``within NAME``."""
    derived: DerivedParameter = NOTHING
    space: Space | None = None
    """What its numbers are made of, where a search may choose others."""
    goals: Sequence[Objective] = ()
    """What a search tries to break if nothing else is said, the first one first."""
    ends: str = "outcome"
    """The column that says how a run ended: that of the summary, or one of ``derived`` where the study judges."""

    @property
    def name(self) -> str:
        """Name of the study and of its table."""
        return str(self.content["name"])
