"""Reading YAML so that a mistake in the file is one clear sentence: the only door for it.

What is read is bounded before it is built: size, nesting, aliases (counted as what they stand for), tags, digits. A key
written twice is refused. Where each key stands is kept, so that a mistake found later is reported with its line.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, get_args

import yaml
from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from orchestrator.inputs.text.errors import (
    LINES,
    BadInput,
    format_value,
    rename_hint,
    suggestion,
    suggestion_or_choices,
    why_no_file,
)

MOST_BYTES = 500_000
MOST_NODES = 50_000
"""Values in a file, each alias counted as all that it stands for."""
MAX_NESTING = 40
MOST_DIGITS = 40
TEXT = "tag:yaml.org,2002:str"
NUMBERS = ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float")
OTHER_BASE = re.compile(r"[-+]?(?:0[0-7_]+|[\d_]+(?::[\d_]+)+(?:\.[\d_]*)?)")
"""How YAML 1.1 writes 8 (``010``) and 90 (``1:30``): whoever writes that means another number."""
AS_TEXT = ("tag:yaml.org,2002:timestamp", "tag:yaml.org,2002:value")
"""What YAML would make of texts that look like it, and nobody means here."""
RESOLVERS = {
    first: [(tag, pattern) for tag, pattern in found if tag not in AS_TEXT]
    for first, found in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
NO_TEXT = re.compile("[\0\ud800-\udfff]")


class _BoundedComposer(yaml.composer.Composer, yaml.constructor.SafeConstructor):
    """Builds safe YAML, refuses a key written twice and what is larger than anybody means."""

    peek_event: Any
    """Of the parser below."""

    def bound(self) -> None:
        """Begin to count, and resolve as this project does."""
        self.yaml_implicit_resolvers = RESOLVERS
        self._depth, self._count = 0, 0
        self._sizes: dict[str, int] = {}

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()
        if isinstance(event, yaml.AliasEvent):
            if event.anchor in self.anchors and event.anchor not in self._sizes:
                raise _mistake(f"*{event.anchor} stands within itself", event)
            self._check_count(self._sizes.get(str(event.anchor), 0), event)
            return super().compose_node(parent, index)
        tag = getattr(event, "tag", None)
        if tag not in (None, "!", TEXT):
            raise _mistake(f"the tag {format_value(tag)} has no meaning here", event)
        before, self._depth = self._count, self._depth + 1
        if self._depth > MAX_NESTING:
            raise _mistake(f"nested deeper than {MAX_NESTING}", event)
        self._check_count(1, event)
        node = super().compose_node(parent, index)
        self._depth -= 1
        if event.anchor is not None:
            self._sizes[event.anchor] = self._count - before
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[object] = set()
        for key_node, _ in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                raise _mistake("expected a word as key", key_node)
            key = self.construct_object(key_node, deep=True)
            if key in seen:
                raise _mistake(f"key {format_value(key)} is written twice", key_node)
            seen.add(key)
        return super().construct_mapping(node, deep)

    def construct_scalar(self, node: Any) -> Any:
        if node.tag != TEXT and len(str(node.value)) > MOST_DIGITS:
            raise _mistake(f"{format_value(node.value)} has more digits than any number here", node)
        if node.tag in NUMBERS and OTHER_BASE.fullmatch(str(node.value)):
            raise _mistake(
                f"{node.value} is a number of base 8 or 60 for YAML; write it in base 10, or in quotes", node
            )
        value: Any = super().construct_scalar(node)
        if isinstance(value, str) and not _is_text(value):
            raise _mistake(f"{format_value(value)} is no text that can be written as UTF-8", node)
        return value

    def _check_count(self, count: int, event: Any) -> None:
        self._count += count
        if self._count > MOST_NODES:
            raise _mistake(f"more than {MOST_NODES} values, aliases counted as what they stand for", event)


class _Loader(_BoundedComposer, yaml.SafeLoader):
    """Reads in Python, with the errors that messages quote."""

    def __init__(self, text: str) -> None:
        yaml.SafeLoader.__init__(self, text)
        self.bound()


FAST: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""libyaml where PyYAML has it: a sixth of the time."""


class _FastLoader(_BoundedComposer, FAST):  # type: ignore[misc]
    """Reads with libyaml."""

    def __init__(self, text: str) -> None:
        FAST.__init__(self, text)
        self.anchors: dict[str, yaml.Node] = {}
        self.bound()


def _mistake(text: str, where: Any) -> yaml.MarkedYAMLError:
    return yaml.constructor.ConstructorError(None, None, text, where.start_mark)


def _is_text(value: str) -> bool:
    """Return whether ``value`` has a place in a file: no half of a letter, no zero byte."""
    return (value.isascii() and "\0" not in value) or NO_TEXT.search(value) is None


def read_yaml(path: Path) -> Any:
    """Return the content of a YAML file. Raises ``BadInput`` with the line if it cannot be read."""
    try:
        if not path.is_file():
            raise BadInput(why_no_file(path), file=path)
        if path.stat().st_size > MOST_BYTES:
            raise BadInput(f"is larger than {MOST_BYTES} bytes", file=path)
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise BadInput(f"cannot be read: {error.strerror}", file=path) from error
    except UnicodeDecodeError as error:
        raise BadInput("is not UTF-8 text", file=path) from error
    try:
        return _parse(text, str(path))
    except (yaml.YAMLError, ValueError) as error:
        raise _explain_syntax(error, path) from error


def read_nodes(text: str, path: Path) -> yaml.Node | None:
    """Return the nodes of a YAML text, which say where in it they stand; None if it is empty. Raises ``BadInput``."""
    try:
        return _Loader(text).get_single_node()
    except (yaml.YAMLError, ValueError) as error:
        raise _explain_syntax(error, path) from error


def _explain_syntax(error: Exception, path: Path) -> BadInput:
    mark = getattr(error, "problem_mark", None)
    line = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
    problem = " ".join(str(getattr(error, "problem", None) or error).split())
    return BadInput(f"{line}{problem}", file=path)


def read_value(text: str, key: str) -> Any:
    """Return what ``text`` on the command line means as YAML; itself if it is none. Raises ``BadInput``."""
    if not _is_text(text) or not _is_text(key):
        raise BadInput(
            f"{format_value(text)} is no text that can be written as UTF-8", file="--set", key=ascii(key)[1:-1]
        )
    if len(text) > MOST_BYTES // 100:
        raise BadInput(f"{len(text)} letters are more than a value can have", file="--set", key=key)
    try:
        return _parse(text)
    except (yaml.YAMLError, ValueError):
        return text


def _parse(text: str, file: str = "") -> Any:
    """Return the only document in ``text``, and note where the keys of ``file`` stand.

    libyaml says a mistake in words of its own: what it refuses is read again in Python, which says what to write.
    """
    try:
        return _read_by(_FastLoader(text), file)
    except (yaml.YAMLError, ValueError):
        return _read_by(_Loader(text), file)


def _read_by(loader: _BoundedComposer, file: str) -> Any:
    node = loader.get_single_node()
    if node is None:
        return None
    if file:
        LINES[file] = lambda: _lines(node, "", {})
    return loader.construct_document(node)


def _lines(node: Any, key: str, found: dict[str, int]) -> dict[str, int]:
    """Return key -> line: keys as messages have them, ``faults[1].signal``."""
    if isinstance(node, yaml.MappingNode):
        for name, value in node.value:
            full = f"{key}.{name.value}".lstrip(".")
            found[full] = name.start_mark.line + 1
            _lines(value, full, found)
    elif isinstance(node, yaml.SequenceNode):
        for number, value in enumerate(node.value, start=1):
            found[f"{key}[{number}]"] = value.start_mark.line + 1
            _lines(value, f"{key}[{number}]", found)
    return found


def read_mapping(path: Path) -> dict[str, Any]:
    """Return the mapping in a YAML file; an empty file is an empty mapping."""
    content = read_yaml(path)
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise BadInput("expected a mapping of keys to values", file=path)
    return {str(key): value for key, value in content.items()}


def explain(
    error: ValidationError,
    file: object,
    model: type[BaseModel],
    known: Iterable[str] | None = None,
    section: str = "",
) -> BadInput:
    """Return pydantic's first complaint of a ``model`` as one sentence: file, key, value and what would be right.

    ``known``: the keys of the model, where they are not its fields. ``section``: the key that the model stands under.
    """
    first = _first(error)
    key = f"{section}.{place_in(error)}".strip(".")
    value = first.get("input")
    if first["type"] == "extra_forbidden":
        is_nested = known is None or len(first["loc"]) > 1
        names = _keys_beside(first["loc"], model) if is_nested else known
        hint = suggestion(key, ()) or suggestion_or_choices(str(first["loc"][-1]), names or ())
        return BadInput(f"unknown{hint}", file=file, key=key)
    if first["type"] == "missing":
        return BadInput("is missing", file=file, key=key)
    cause = first.get("ctx", {}).get("error")
    if isinstance(cause, BadInput):
        text = str(cause)
    elif first["type"] == "string_pattern_mismatch":
        text = f"{format_value(value)}: expected letters and digits without accents, '_', '-' and '.'"
    else:
        message = first["msg"].replace(" after validation", "")
        text = f"{format_value(value)}: {message[0].lower()}{message[1:]}"
    return BadInput(text + rename_hint(key, value), file=file, key=key)


def _first(error: ValidationError) -> ErrorDetails:
    """Return the complaint that is said: a key that is unknown, if there is one, before the one that it lacks."""
    return min(error.errors(), key=lambda item: item["type"] != "extra_forbidden")


def _keys_beside(place: Sequence[int | str], model: type[BaseModel]) -> list[str]:
    """Return the keys that are valid where the last part of ``place`` stands, from the fields of ``model``."""
    models = [model]
    for part in place[:-1]:
        fields = [field for item in models for name, field in _fields_by_key(item).items() if name == part]
        models = [item for field in fields for item in _models_in(field.annotation)] or models
    return [name for item in models for name in _fields_by_key(item)]


def _fields_by_key(model: type[BaseModel]) -> dict[str, FieldInfo]:
    return {str(field.validation_alias or name): field for name, field in model.model_fields.items()}


def _models_in(annotation: object) -> Iterator[type[BaseModel]]:
    """Yield the models in an annotation such as ``dict[str, Model | None]``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models_in(part)


def place_in(error: ValidationError) -> str:
    """Return the key that pydantic's first complaint is about: ``faults[1].signal``. Parts in <> are not written."""
    parts = [part for part in _first(error)["loc"] if not str(part).startswith("<")]
    return "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in parts).lstrip(".")
