"""How runs came out: the one judge, of a single run and of a table of them."""

import math
from typing import NamedTuple

from modelkit.variables import Variable
from orchestrator.evaluation.verdict.truth import Bools
from orchestrator.inputs.scenario.end_condition import states_of
from orchestrator.inputs.scenario.requirements import library_requirements
from orchestrator.inputs.scenario.scenario import CONTACT_FREE, MISSED, SUCCESS, Outcome, Scenario
from orchestrator.simulation.cosim.fmu_instance import Array

BEYOND = "beyond its limit: "
"""Begins why a run has not done its task whose controller reports success, but which misses requirements."""


CONTACT_ID = library_requirements(CONTACT_FREE)[0].id


class Ends(NamedTuple):
    """How runs ended, an entry for each run."""

    broken: list[str]
    """Why it was broken off; empty if it was not."""
    mode: Array
    """What the controller said last of how far it is; NaN: nothing."""
    reason: Array
    """What it said last of why it has given up."""
    speed: Array
    """How fast the car is then [m/s]."""


class RequiredCheck(NamedTuple):
    """One requirement that a run must meet to have done its task, an entry for each run."""

    id: str
    missed: Bools
    unmeasured: Bools
    """Missed as there is no value to judge."""


def outcomes(
    scenario: Scenario,
    ends: Ends,
    asked: list[RequiredCheck],
    mode: Variable | None = None,
    reason: Variable | None = None,
) -> list[tuple[Outcome, str]]:
    """Return (outcome, why) of each run of ``scenario``; ``mode`` and ``reason`` as an FMU declares them, if it does.

    A run has done its task (``parked``, ``finished``) if the controller reports it, the car stands, and every
    requirement in ``asked`` is met, among them that its outline is in the slot. What was not measured is not met.
    """
    words = _Words(scenario, mode, reason)
    found = []
    for run, end in enumerate(zip(ends.broken, ends.mode, ends.reason, ends.speed, strict=True)):
        missed = [(item.id, bool(item.unmeasured[run])) for item in asked if item.missed[run]]
        found.append(words.outcome(*end, missed))
    return found


class _Words:
    """What the values of a scenario's modes mean."""

    def __init__(self, scenario: Scenario, mode: Variable | None, reason: Variable | None) -> None:
        ending = scenario.stop_condition
        self._success, self._missed = SUCCESS[scenario.task], MISSED[scenario.task]
        self._is_run = scenario.task == "open_loop"
        self._still = ending.still
        done = [] if self._is_run else ending.succeeded
        self._done, self._failed, self._over = (
            ending.values(states, mode) for states in (done, ending.failed, ending.ended)
        )
        self._output = ending.signal.partition(".")[2]
        self._modes = states_of(ending.signal, mode)
        self._word = "" if self._is_run else ending.text(ending.succeeded[0], mode)
        self._reasons = states_of(ending.reason, reason)

    def outcome(
        self, broken: str, mode: float, reason: float, speed: float, missed: list[tuple[str, bool]]
    ) -> tuple[Outcome, str]:
        """Return how a run came out, and why; ``missed`` are names of requirements and whether there is no value."""
        if broken:
            return "aborted", broken
        if self._is_run and mode not in (*self._failed, *self._over):
            why = self._why_not(0.0, missed)
            return (self._missed, why) if why else (self._success, "all checks passed")
        if not math.isfinite(mode):
            return (
                self._missed,
                f"the controller has no output {self._output}, of which {self._word} says that it is done",
            )
        if mode in self._failed:
            return "failed", state_name(self._reasons, reason).lower()
        name = state_name(self._modes, mode).lower()
        if mode in self._over:
            return self._missed, name
        if mode not in self._done:
            return self._missed, f"stop time reached in {name}"
        why = self._why_not(speed, missed)
        return (self._missed, why) if why else (self._success, "all checks passed")

    def _why_not(self, speed: float, missed: list[tuple[str, bool]]) -> str:
        """Return what a run lacks whose controller says that it is done; empty if nothing."""
        touched = (CONTACT_ID, False) in missed
        missed = [item for item in missed if item != (CONTACT_ID, False)]
        unknown = list(dict.fromkeys(name for name, is_unknown in missed if is_unknown))
        beyond = list(dict.fromkeys(name for name, is_unknown in missed if not is_unknown))
        parts = ["contact"] if touched else []
        if abs(speed) > self._still:
            parts.append(f"the car still moves: {speed:.3g} m/s")
        if math.isnan(speed):
            unknown = ["the car's speed", *unknown]
        parts += [f"{BEYOND}{', '.join(beyond)}"] if beyond else []
        parts += [f"not measured: {', '.join(unknown)}"] if unknown else []
        return "; ".join(parts)


def state_name(names: dict[int, str], value: float) -> str:
    """Return the name of a mode's value; the number where it has none."""
    return names.get(int(value), f"{value:g}") if math.isfinite(value) else "nan"
