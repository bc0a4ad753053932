"""How far tests have been through the modes of FMUs that nobody can look into: from signals alone.

A mode is what ``system: modes:`` lists, else what plays the role ``mode``, else the ``phase`` of a controller that has
our names. Transitions between two exchanges are seen as one.
"""

from collections import Counter
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.scenario.wiring.modes import ANY, ModeList, word
from orchestrator.inputs.scenario.wiring.system_text import Feed, terms
from orchestrator.session.foreign import Files
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.testing.coverage.covered import ChartCoverage, RowCoverage

PHASE = "controller.phase"
"""The mode of a controller of which nothing is said."""


class Modes:
    """The modes of FMUs of others, and what of them was seen so far."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, str], _ModeSeen] = {}
        self.ours: set[str] = set()
        """Instances that were ours in one test at least."""

    def look(self, scenario: Scenario, files: Files, recording: Recording) -> None:
        """Count what a run has been through; ``files``: instance -> third-party FMU."""
        there = {name.partition(".")[0] for name in recording.signals}
        self.ours |= there & set(scenario.places) - set(files)
        for signal, listed in modes_of(scenario, files, recording).items():
            instance, _, name = signal.partition(".")
            file = files[instance].name if instance in files else instance
            self._found.setdefault((file, name), _ModeSeen()).add(listed, recording, signal)

    def chart_coverages(self) -> list[ChartCoverage]:
        """Return each mode as a chart whose guards nobody knows."""
        return [mode.chart_coverages(*names) for names, mode in sorted(self._found.items())]


def modes_of(scenario: Scenario, files: Files, recording: Recording) -> dict[str, ModeList]:
    """Return signal -> what is listed of it, for each mode of a run that a third-party FMU reports."""
    system = scenario.system
    if system is not None and system.modes:
        return {name: listed for name, listed in system.modes.items() if name in recording.signals}
    role = None if system is None else system.roles.get("mode")
    if role is not None and role.from_:
        signal = terms(role.from_)[0].name
        return {signal: _of_role(role)} if signal.partition(".")[0] in files else {}
    return {PHASE: ModeList()} if "controller" in files and PHASE in recording.signals else {}


def _of_role(role: Feed) -> ModeList:
    """Return the states that a role names: its own, or those of ours that it is mapped onto."""
    if role.states is not None:
        return ModeList(states=role.states)
    values: Mapping[int | str, object] = role.map or {}
    return ModeList(states={word(name): int(value) for value, name in values.items() if _is_number(value)})


def _is_number(value: object) -> bool:
    return str(value).lstrip("-").isdecimal()


class _Seen(NamedTuple):
    """What was seen of a mode: how often each value, and each change of it."""

    values: Counter[float]
    changes: Counter[tuple[float, float]]


class _ModeSeen:
    """One mode over all tests."""

    def __init__(self) -> None:
        self._told: dict[float, str] = {}
        self._listed: dict[float, str] = {}
        self._pairs: dict[tuple[str, ...], None] = {}
        self._seen = _Seen(Counter(), Counter())

    def add(self, listed: ModeList, recording: Recording, signal: str) -> None:
        reported = {name: value for value, name in recording.states(signal).items()}
        names = self._listed if listed.transitions else self._told
        names |= {float(value): word(name) for name, value in (listed.states or reported).items()}
        self._pairs |= dict.fromkeys(listed.pairs)
        values = recording.signals[signal]
        self._seen.values.update(values.tolist())
        rows = np.flatnonzero(np.diff(values))
        self._seen.changes.update(zip(values[rows].tolist(), values[rows + 1].tolist(), strict=True))

    def chart_coverages(self, file: str, signal: str) -> ChartCoverage:
        """Return what was seen; the transitions that nobody listed are ``beside``, or all if none is listed."""
        states = dict.fromkeys((self._listed or self._told).values(), 0)
        for value, count in sorted(self._seen.values.items()):
            states[self._name(value)] = states.get(self._name(value), 0) + count
        taken: Counter[tuple[str, ...]] = Counter()
        beside = []
        for (before, after), count in sorted(self._seen.changes.items()):
            source, target = self._name(before), self._name(after)
            pair = next((item for item in ((source, target), (ANY, target)) if item in self._pairs), None)
            if pair is None:
                beside.append(RowCoverage(source, "", target, count, 0))
            else:
                taken[pair] += count
        listed = [RowCoverage(source, "", target, taken[source, target], 0) for source, target in self._pairs]
        rows, beside = (listed, beside) if listed else (beside, [])
        return ChartCoverage(file, signal, states, rows, False, bool(listed), beside)

    def _name(self, value: float) -> str:
        """Return what a state is called where its transitions are listed, else by its FMU or its role."""
        return self._listed.get(value) or self._told.get(value) or f"{value:g}"
