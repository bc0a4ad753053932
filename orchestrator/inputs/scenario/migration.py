"""Rewriting files of an earlier version: old names in a scenario, study or test become the new ones.

Only the renamed words change: comments, order, quotes and line ends stay as they are.
"""

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import yaml

from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.renamed_names import SCENARIO_KEYS, VALUES, current_name
from orchestrator.inputs.text.yaml_file import read_nodes, read_yaml

SECTIONS_OF_A_TEST = ("inputs", "parameters", "ranges")
"""Of an open-loop test, which names the variables of its model without their owner."""
SECTIONS_OF_A_STUDY = ("set", "runs")
DESIGNS = ("grid", "monte_carlo", "latin_hypercube")
"""Keys below ``runs``; below them stand names with their owner."""
NAME = re.compile(r"[A-Za-z_][\w.]*(?:\[\d+\][\w.]*)*")


class Change(NamedTuple):
    """One word that is replaced."""

    line: int
    old: str
    new: str


class Migrated(NamedTuple):
    """A file with its old names replaced."""

    text: str
    changes: list[Change]


class _Edit(NamedTuple):
    start: int
    end: int
    line: int
    new: str


def migrate(path: Path) -> Migrated:
    """Return the text of a YAML file with new names, and what changed. Raises ``BadInput`` if it cannot be read."""
    read_yaml(path)
    with path.open(encoding="utf-8", newline="") as file:
        text = file.read()
    root = read_nodes(text, path)
    edits = sorted(set(_edits(root, text))) if root is not None else []
    changes = [Change(edit.line, text[edit.start : edit.end], edit.new) for edit in edits]
    for edit in reversed(edits):
        text = text[: edit.start] + edit.new + text[edit.end :]
    return Migrated(text, changes)


def check_migrated(path: Path, found: Migrated) -> None:
    """Raise ``BadInput`` if a rewritten file would have a key twice, as it already had old and new name."""
    for node in _mappings(read_nodes(found.text, path)):
        counts = Counter(key.value for key, _ in node.value)
        twice = next((key for key, count in counts.items() if count > 1), None)
        if twice is not None:
            raise BadInput("has the old and the new name of this key; keep one of them", file=path, key=str(twice))


def _mappings(node: yaml.Node | None) -> Iterator[yaml.MappingNode]:
    if isinstance(node, yaml.MappingNode):
        yield node
        for key, value in node.value:
            yield from _mappings(key)
            yield from _mappings(value)
    elif isinstance(node, yaml.SequenceNode):
        for item in node.value:
            yield from _mappings(item)


def _edits(root: yaml.Node, text: str) -> Iterator[_Edit]:
    top = {key.value: value for key, value in root.value} if isinstance(root, yaml.MappingNode) else {}
    model = top.get("model")
    if isinstance(model, yaml.ScalarNode):
        yield from _test(root, text, str(model.value))
    else:
        yield from _walk(root, text, (), is_study="runs" in top and "scenario" in top)


def _test(root: yaml.Node, text: str, owner: str) -> Iterator[_Edit]:
    """Yield the edits of an open-loop test of the model ``owner``; its own keys have kept their names."""
    for key, value in root.value:
        if key.value in SECTIONS_OF_A_TEST and isinstance(value, yaml.MappingNode):
            yield from _walk(value, text, (owner,))
        elif key.value == "expect":
            for node in _mappings(value):
                for name, scalar in node.value:
                    if name.value == "signal" and isinstance(scalar, yaml.ScalarNode):
                        yield from _names(scalar, text, f"{owner}.")


def _walk(node: yaml.Node, text: str, path: tuple[str, ...], *, is_study: bool = False) -> Iterator[_Edit]:
    if isinstance(node, yaml.SequenceNode):
        for item in node.value:
            if isinstance(item, yaml.ScalarNode):
                yield from _value(_key_of_list(path), item, text, is_item=True)
            yield from _walk(item, text, path, is_study=is_study)
    if not isinstance(node, yaml.MappingNode):
        return
    for key, value in node.value:
        within = _within(path, str(key.value), is_study=is_study)
        if within is not None:
            yield from _key(key, text, path)
        if isinstance(value, yaml.ScalarNode):
            yield from _value(str(key.value), value, text)
        yield from _walk(value, text, path if within is None else within, is_study=is_study)


def _key_of_list(path: tuple[str, ...]) -> str:
    """Return the key whose values the items of a list are; below ``within`` of a study are sets of requirements."""
    return "requirements" if path[:1] == ("within",) else path[-1] if path else ""


def _within(path: tuple[str, ...], key: str, *, is_study: bool) -> tuple[str, ...] | None:
    """Return the path of what stands below ``key``; None where the key itself is no name of a scenario's."""
    if is_study and not path and key in (*SECTIONS_OF_A_STUDY, *DESIGNS):
        return None
    return (*path, key)


def _key(key: yaml.Node, text: str, path: tuple[str, ...]) -> Iterator[_Edit]:
    """Yield the edits of a key: of each name in it, as it is called where it stands."""
    if not isinstance(key, yaml.ScalarNode):
        return
    start, end = key.start_mark.index, key.end_mark.index
    for match in NAME.finditer(text, start, end):
        word = match[0]
        full = ".".join([*path, word])
        new = current_name(full)
        if new == full and "." in word:
            full, new = word, current_name(word)
        if new != full:
            own = new.split(".")[-(word.count(".") + 1) :]
            yield _Edit(match.start(), match.end(), key.start_mark.line + 1, ".".join(own))


def _value(key: str, value: yaml.ScalarNode, text: str, *, is_item: bool = False) -> Iterator[_Edit]:
    new = VALUES.get(current_name(key), {}).get(str(value.value))
    raw = text[value.start_mark.index : value.end_mark.index]
    if new is not None and str(value.value) in raw:
        at = value.start_mark.index + raw.index(str(value.value))
        yield _Edit(at, at + len(str(value.value)), value.start_mark.line + 1, new)
    elif key == "signal" or "." in str(value.value) or is_item:
        yield from _names(value, text)


def _names(value: yaml.ScalarNode, text: str, owner: str = "") -> Iterator[_Edit]:
    """Yield the edits of a value that is the name of a signal, a parameter or a metric."""
    word = str(value.value)
    new = current_name(owner + word).removeprefix(owner)
    raw = text[value.start_mark.index : value.end_mark.index]
    if new != word and word not in SCENARIO_KEYS and word in raw:
        at = value.start_mark.index + raw.index(word)
        yield _Edit(at, at + len(word), value.start_mark.line + 1, new)
