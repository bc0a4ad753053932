"""From nested YAML sections to flat names: ``{driver: {profile: [[0, 1.5]]}}`` -> ``driver.profile[1].at``."""

import re
from collections.abc import Iterable, Mapping
from functools import lru_cache
from itertools import pairwise
from typing import Any, NamedTuple

from orchestrator.inputs.text.errors import BadInput, format_value, suggestion

SEPARATOR = re.compile(r"[.\[]")
"""Between the steps of a name: ``driver``, ``driver.profile``, ``driver.profile[1]``, ``driver.profile[1].at``."""


def flatten_section(
    section: Mapping[str, object], names: Iterable[str], *, file: object, key: str
) -> dict[str, object]:
    """Return flat name -> raw value. A list may stand for a NamedTuple (in field order) or for an array.

    Raises ``BadInput`` for a name the model does not have, with the closest ones.
    """
    return flatten_layer(section, names, file=file, key=key).values


class FlatLayer(NamedTuple):
    """A section of one file by flat names."""

    values: dict[str, object]
    arrays: frozenset[str]
    """Arrays that it writes as lists; of others it names entries at most."""


def flatten_layer(section: Mapping[str, object], names: Iterable[str], *, file: object, key: str) -> FlatLayer:
    """Return what :func:`flatten_section` does, with the arrays that are written as a whole."""
    known = dict.fromkeys(names)
    found = _Found(known, _members(tuple(known)), {}, set(), file, key)
    for name, value in section.items():
        _flatten(str(name), value, found)
    return FlatLayer(found.values, frozenset(found.arrays))


def merge_flat(below: Mapping[str, object], above: Mapping[str, object], arrays: Iterable[str]) -> dict[str, object]:
    """Return ``below`` overridden by ``above``; ``arrays``, written as a whole above, lose all entries below.

    Of an entry named above (``boxes[2].length``) all else stays, as do the other entries.
    """
    begins = tuple(f"{name}[" for name in arrays)
    return {**{name: value for name, value in below.items() if not name.startswith(begins)}, **above}


def merge_nested(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Return ``below`` overridden by ``above``; sections are merged key by key, anything else is replaced whole."""
    result = dict(below)
    for key, value in above.items():
        old = result.get(key)
        result[key] = merge_nested(old, value) if isinstance(old, dict) and isinstance(value, Mapping) else value
    return result


class _Found(NamedTuple):
    known: Mapping[str, None]
    """The names, in order."""
    members: Mapping[str, list[str]]
    """See ``_members``."""
    values: dict[str, object]
    arrays: set[str]
    file: object
    key: str


def _flatten(name: str, value: object, found: _Found) -> None:
    known, file, key = found.known, found.file, found.key
    if name in known:
        found.values[name] = value
        return
    children = found.members.get(name)
    if children is None:
        close = suggestion(name, known, f"{key}.")
        raise BadInput(f"unknown{close or '; known are ' + _roots(known)}", file=file, key=f"{key}.{name}")
    if isinstance(value, Mapping):
        for child, item in value.items():
            _flatten(f"{name}.{child}", item, found)
    elif isinstance(value, list):
        if children[0].startswith(f"{name}["):
            found.arrays.add(name)
        if len(value) > len(children):
            raise BadInput(
                f"{len(value)} values given, expected at most {len(children)}", file=file, key=f"{key}.{name}"
            )
        for child, item in zip(children, value, strict=False):
            _flatten(child, item, found)
    else:
        parts = ", ".join(child.removeprefix(name).lstrip(".") for child in children[:6])
        raise BadInput(
            f"{format_value(value)} is one value, expected a mapping or list of {parts}", file=file, key=f"{key}.{name}"
        )


@lru_cache(maxsize=64)
def _members(known: tuple[str, ...]) -> Mapping[str, list[str]]:
    """Return each group and array of ``known`` -> the full names of its members, in order."""
    found: dict[str, dict[str, None]] = {}
    for name in known:
        steps = [*(name[: mark.start()] for mark in SEPARATOR.finditer(name)), name]
        for group, member in pairwise(steps):
            found.setdefault(group, {})[member] = None
    return {group: list(members) for group, members in found.items()}


def _roots(known: Iterable[str]) -> str:
    roots = dict.fromkeys(name.split(".")[0].split("[")[0] for name in known)
    return ", ".join(roots)
