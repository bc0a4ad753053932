"""Source text of a whole run as one function: models, exchange, ending and the numbers kept of it.

The exchange is the Python master's, step by step: fetch the outputs of the models that are due, hand
them to the inputs of the same name, note what is kept, ask whether the run is over, step what is due.
Everything is made from the types; only :class:`Ending` and :class:`Kept` name signals.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, NamedTuple

from fmus.flat_entry import scalars
from modelkit.model import Model
from modelkit.variables import Variable, constructor_source, variables

How = Literal["last", "largest", "greatest", "smallest", "travel"]
KEEP: dict[str, tuple[str, str]] = {
    "last": ("0.0", "{kept} = {now}"),
    "largest": ("0.0", "if abs({now}) > abs({kept}) or {now} != {now}:\n    {kept} = {now}"),
    "greatest": ("{now}", "if {now} > {kept} or {now} != {now}:\n    {kept} = {now}"),
    "smallest": ("{now}", "if {now} < {kept} or {now} != {now}:\n    {kept} = {now}"),
    "travel": ("0.0", "{kept} += abs({now} - {before})\n{before} = {now}"),
}
"""How -> (value at first, what to do at every exchange)."""
STOP_TIME, STANDSTILL = 0, 1
FIRST_KEPT = 2
"""A row begins with the end (one of the two above) and its time [ns]."""


class Kept(NamedTuple):
    """One number kept of a run."""

    how: How
    """``last``; ``largest`` absolute value, with its sign; ``greatest``; ``smallest``; ``travel``: sum of absolute changes."""
    signal: str
    """An output, ``vehicle.speed``; or an input as its model saw it."""


class Ending(NamedTuple):
    """A run is over when a mode has a final value and a speed has been small for a time."""

    mode: str
    final: tuple[int, ...]
    speed: str
    still: float
    """Largest absolute speed that counts as standing."""
    time_ns: int


def run_source(models: Mapping[str, Model], ending: Ending | None, kept: Sequence[Kept], scope: dict[str, Any]) -> str:
    """Return the text of ``run(p, times, row)``; the names it needs are put into ``scope``.

    ``p``: the parameters of all models, one after the other, as doubles. ``times``: step [ns], stop
    [ns], then the decimation of each model. ``row`` receives the end, its time [ns] and ``kept``.
    Raises ``KeyError`` for a signal that does not exist, ``TypeError`` if connected types differ.
    """
    writer = _Writer(models, scope)
    notes = [writer.note(item, f"k{place}", f"b{place}") for place, item in enumerate(kept)]
    loop = [*writer.exchange(), *_joined(lines for _, lines in notes), "t_ns = count * step_ns"]
    loop += [*writer.over(ending), "if count == last:", "    break", *writer.steps(), "count += 1"]
    lines = [*writer.beginning(), *_joined(lines for lines, _ in notes)]
    lines += ["since = -1", "count = 0", f"end = {STOP_TIME}", "while True:", *_indented(loop)]
    lines += ["row[0] = float(end)", "row[1] = float(count * step_ns)"]
    lines += [f"row[{place + FIRST_KEPT}] = k{place}" for place in range(len(kept))]
    return "\n".join(["def run(p, times, row):", *_indented(lines)]) + "\n"


class _Writer:
    """Writes the parts. Model 0 has parameters p0, state s0, inputs u0, outputs y0, fetched o0, decimation every0."""

    def __init__(self, models: Mapping[str, Model], scope: dict[str, Any]) -> None:
        self._models = list(models.values())
        self._owners = list(models)
        self._scope = scope
        self._signals: dict[str, str] = {}
        for number, (owner, model) in enumerate(models.items()):
            for cls, name in ((model.inputs, f"u{number}"), (model.outputs, f"o{number}")):
                names = [f"{owner}.{variable.name}" for variable in variables(cls)]
                self._signals.update(zip(names, scalars(cls(), name), strict=True))
        self._inputs = [self._input(number) for number in range(len(self._models))]

    def beginning(self) -> list[str]:
        """Return the lines up to the exchange in Initialization Mode."""
        lines = ["step_ns = times[0]", "last = times[1] // step_ns"]
        at = 0
        for number, model in enumerate(self._models):
            params, at = constructor_source(model.params(), self._class, "p", at)
            initialize = self._name(model.initialize, "initialize")
            lines += [f"p{number} = {params}", f"every{number} = times[{number + 2}]"]
            lines += [f"s{number}, y{number} = {initialize}(p{number})", f"o{number} = y{number}"]
        return lines + [f"u{number} = {inputs}" for number, inputs in enumerate(self._inputs)]

    def exchange(self) -> list[str]:
        """Return the lines that fetch and hand over; a model that is not due keeps what it gave and has."""
        fetch = [_due(number, f"o{number} = y{number}") for number in range(len(self._models))]
        return _joined(fetch + [_due(number, f"u{number} = {inputs}") for number, inputs in enumerate(self._inputs)])

    def steps(self) -> list[str]:
        """Return the lines that step what is due."""
        lines = []
        for number, model in enumerate(self._models):
            step = self._name(model.step, "step")
            arguments = f"s{number}, u{number}, p{number}, every{number} * step_ns"
            lines += _due(number, f"s{number}, y{number} = {step}({arguments})")
        return lines

    def note(self, item: Kept, kept: str, before: str) -> tuple[list[str], list[str]]:
        """Return the lines that begin, and those that at every exchange go on with, one kept number."""
        names = {"kept": kept, "before": before, "now": self._float(item.signal)}
        first, always = KEEP[item.how]
        begin = [f"{kept} = {first.format(**names)}"]
        if "{before}" in always:
            begin.append(f"{before} = {names['now']}")
        return begin, always.format(**names).split("\n")

    def over(self, ending: Ending | None) -> list[str]:
        """Return the lines that leave the loop once the car has stood long enough in a final mode."""
        if ending is None or not ending.final:
            return []
        final = " or ".join(f"{self._signals[ending.mode]} == {value}" for value in ending.final)
        return [
            f"if not ({final}) or abs({self._float(ending.speed)}) > {ending.still!r}:",
            "    since = -1",
            "else:",
            "    if since < 0:",
            "        since = t_ns",
            f"    if t_ns - since >= {ending.time_ns}:",
            f"        end = {STANDSTILL}",
            "        break",
        ]

    def _input(self, number: int) -> str:
        """Return the expression of one model's inputs: connected by equal names, others at their start values."""
        inputs = self._models[number].inputs
        texts = [self._source(number, variable) for variable in variables(inputs)]
        shape, _ = constructor_source(inputs(), self._class, "input")
        plain = re.sub(r"(?:bool|int)\((input\[\d+\])\)", r"\1", shape)
        return re.sub(r"input\[(\d+)\]", lambda match: texts[int(match[1])], plain)

    def _source(self, number: int, wanted: Variable) -> str:
        name = wanted.name
        for other, model in enumerate(self._models):
            offered = {variable.name: variable.kind for variable in variables(model.outputs)}
            if other != number and name in offered:
                if offered[name] is not wanted.kind:
                    raise TypeError(f"{self._owners[other]}.{name} and {self._owners[number]}.{name} differ in type")
                return self._signals[f"{self._owners[other]}.{name}"]
        return repr(wanted.start)

    def _float(self, signal: str) -> str:
        return f"float({self._signals[signal]})"

    def _class(self, cls: type[Any]) -> str:
        return self._name(cls, cls.__name__)

    def _name(self, item: Any, name: str) -> str:
        """Return the name of ``item`` in the scope, where it is put if it is not there."""
        for known, found in self._scope.items():
            if found is item:
                return known
        while name in self._scope:
            name += "_"
        self._scope[name] = item
        return name


def _due(number: int, line: str) -> list[str]:
    return [f"if count % every{number} == 0:", f"    {line}"]


def _joined(groups: Iterable[list[str]]) -> list[str]:
    return [line for group in groups for line in group]


def _indented(lines: list[str]) -> list[str]:
    return [f"    {line}" for line in lines]
