"""What can be named: parameters, signals and systems of the models, with what they mean, for lists and references."""

import ast
import inspect
import textwrap
from collections.abc import Iterator
from fnmatch import fnmatchcase
from typing import Any, NamedTuple

from modelkit.states import parts_of
from modelkit.variables import Variable, variables
from orchestrator.inputs.scenario.models import MODELS, apart_models
from orchestrator.inputs.text.quantities import RAD_PER_DEGREE

UNBOUNDED_LIMIT = 1e300


class Entry(NamedTuple):
    """One variable of a model, standing for all elements of an array that differ in their number alone."""

    owner: str
    role: str
    """``parameter``, ``input`` or ``output``."""
    variable: Variable
    elements: int
    """Elements it stands for."""

    @property
    def name(self) -> str:
        """Name as ``--set`` and the log have it."""
        return f"{self.owner}.{self.variable.name}"

    def plain(self) -> dict[str, Any]:
        """Return the entry as plain data; a range without an end has null there."""
        item = self.variable
        low, high = (None if abs(end) > UNBOUNDED_LIMIT else end for end in (item.signal.low, item.signal.high))
        states = {state.name.lower(): int(state) for state in item.signal.states or ()}
        return {
            **{"name": self.name, "role": self.role, "type": item.kind.__name__, "unit": item.signal.unit},
            **{"text": item.signal.text, "start": item.start, "low": low, "high": high, "states": states},
            **{"source": item.signal.source, "elements": self.elements},
        }


def entries(*roles: str) -> list[Entry]:
    """Return what both models have in these roles: parameter, input, output."""
    found = []
    for owner, model in MODELS.items():
        groups = {"parameter": model.params, "input": model.inputs, "output": model.outputs}
        for role in roles:
            found += [Entry(owner, role, item, count) for item, count in collapse_arrays(variables(groups[role]))]
    return found + _apart(roles, {(item.role, item.name) for item in found})


def _apart(roles: tuple[str, ...], known: set[tuple[str, str]]) -> list[Entry]:
    """Return what controllers of their own have besides."""
    found = []
    for model in apart_models().values():
        groups = {"parameter": model.params, "input": model.inputs, "output": model.outputs}
        for role in roles:
            items = [item for item in variables(groups[role]) if (role, f"controller.{item.name}") not in known]
            found += [Entry("controller", role, item, count) for item, count in collapse_arrays(items)]
    return found


def match_entries(found: list[Entry], word: str | None) -> list[Entry]:
    """Return the entries whose name fits the pattern ``word``; a plain word fits anywhere in name or meaning."""
    if word is None:
        return found
    if any(sign in word for sign in "*?"):
        return [item for item in found if fnmatchcase(item.name, word.replace("[", "[[]"))]
    small = word.lower()
    return [item for item in found if small in item.name.lower() or small in item.variable.signal.text.lower()]


def systems() -> dict[str, str]:
    """Return name -> meaning of the systems that ``controller.system`` chooses from."""
    known = next(item for item in variables(MODELS["controller"].params) if item.name == "system").signal.states
    assert known is not None
    texts = {name: text for part in parts_of(known) for name, text in texts_of(part).items()}
    return {item.name.lower(): texts.get(item.name, "") for item in known}


def collapse_arrays(items: list[Variable]) -> Iterator[tuple[Variable, int]]:
    """Return variables and how many array elements each stands for: those of element 1 stand for all alike."""
    counts: dict[str, int] = {}
    for item in items:
        key, number = split_index(item.name)
        counts[key] = max(counts.get(key, 1), number)
    for item in items:
        key, number = split_index(item.name)
        if number == 1:
            yield item, counts[key]


def split_index(name: str) -> tuple[str, int]:
    """Return (name without its first index, that index or 1)."""
    if "[" not in name:
        return name, 1
    head, rest = name.split("[", 1)
    number, tail = rest.split("]", 1)
    return f"{head}[]{tail}", int(number)


def start_text(item: Variable) -> str:
    """Return the default for people: angles in degrees as well, modes by name."""
    if item.signal.states is not None:
        return item.signal.states(item.start).name.lower()
    if item.kind is bool:
        return str(item.start).lower()
    if item.signal.unit.startswith("rad"):
        return f"{item.start:.6g} ({item.start / RAD_PER_DEGREE:.5g} {item.signal.unit.replace('rad', 'deg')})"
    return f"{item.start:.6g}"


def range_text(item: Variable) -> str:
    """Return the range allowed, empty if there is none."""
    low, high = item.signal.low, item.signal.high
    if low < -UNBOUNDED_LIMIT and high > UNBOUNDED_LIMIT:
        return ""
    if high > UNBOUNDED_LIMIT:
        return f"from {low:g}"
    return f"{low:g} to {high:g}" if low > -UNBOUNDED_LIMIT else f"to {high:g}"


def texts_of(cls: type[Any]) -> dict[str, str]:
    """Return name -> the text that stands under a field, or a member, in its class."""
    body = ast.parse(textwrap.dedent(inspect.getsource(cls))).body[0]
    assert isinstance(body, ast.ClassDef)
    found = {}
    for node, after in zip(body.body, body.body[1:], strict=False):
        targets = [node.target] if isinstance(node, ast.AnnAssign) else getattr(node, "targets", [None])
        target = targets[0]
        if isinstance(target, ast.Name) and isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
            found[target.id] = " ".join(str(after.value.value).split())
    return found
