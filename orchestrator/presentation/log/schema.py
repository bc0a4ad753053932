"""A protobuf message type for the variables of an instance, made from their names, types, units and meanings.

``pose.x`` becomes field ``x`` of a nested message ``pose``; ``ultrasonic[3]`` the third element of a
repeated field. The unit and meaning stand as a comment at each field, the names of the states of a
mode as an enum. Field numbers follow the order of the variables.
"""

import re
from collections.abc import Iterator
from enum import IntEnum
from functools import lru_cache
from typing import Any

from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    EnumDescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)

from modelkit.variables import Variable

TOKEN = re.compile(r"[^.\[\]]+")
PLAIN = re.compile(r"[A-Za-z]\w*(?:\.[A-Za-z]\w*|\[\d+\])*", re.ASCII)
Tree = dict[str, Any]
"""Field name -> place of a variable (int), message (Tree), or list of these."""
PACKAGE = "apa"
MIN_STRUCTURE_SIZE = 8
"""Values of a structure that has a channel of its own: with fewer, a message costs more than they do."""
PARAMETERS = "parameters"
"""End of the topic of an instance's parameters."""


@lru_cache(maxsize=64)
def tree(names: tuple[str, ...]) -> Tree:
    """Return the nested structure that ``names`` spell, with the place of each name at its leaf.

    Names that spell none - ``der(x)``, ``a`` beside ``a.b``, ``x[2]`` without ``x[1]`` - become fields of their own.
    """
    root: dict[str, list[tuple[str, int]]] = {}
    for place, name in enumerate(names):
        first = (TOKEN.findall(name) or [name])[0]
        root.setdefault(str(first), []).append((name, place))
    made: Tree = {}
    taken: set[str] = set()
    for first, items in root.items():
        content = _structure(items)
        scope: set[str] = {first, _camel(first)} if isinstance(_element(content), dict) else {first}
        if content is not None and not scope & taken:
            made[first] = content
            taken |= scope
        else:
            for name, place in items:
                made[_own_name(name, taken)] = place
    return made


def channel_places(names: list[str]) -> dict[str, list[int]]:
    """Return the channels of an instance's signals: end of the topic -> places of their names.

    A large structure has a channel of its own; the empty name, the last, has all others.
    """
    channels: dict[str, list[int]] = {}
    others: list[int] = []
    for first, content in tree(tuple(names)).items():
        places = sorted(_leaves(content))
        if isinstance(content, dict) and len(places) >= MIN_STRUCTURE_SIZE and first != PARAMETERS:
            channels[first] = places
        else:
            others += places
    return channels | {"": sorted(others)}


def name_prefix(channel: str) -> str:
    """Return what the names on a channel (see ``channel_places``) lack of those of the instance's variables."""
    return f"{channel}." if channel not in ("", PARAMETERS) else ""


def _leaves(content: Any) -> Iterator[int]:
    if isinstance(content, int):
        yield content
    else:
        for item in content.values() if isinstance(content, dict) else content:
            yield from _leaves(item)


def _structure(items: list[tuple[str, int]]) -> Any:
    """Return what names that begin alike spell: a place, a message, a list; None if they cannot be both."""
    if not all(PLAIN.fullmatch(name) for name, _ in items):
        return None
    root: dict[Any, Any] = {}
    for name, place in items:
        node, parts = root, [int(part) if part.isdigit() else part for part in TOKEN.findall(name)]
        for part in parts[:-1]:
            node = node.setdefault(part, {})
            if not isinstance(node, dict):
                return None
        if parts[-1] in node:
            return None
        node[parts[-1]] = place
    content = _lists(next(iter(root.values())))
    return content if _is_regular(content) else None


def _is_regular(content: Any) -> bool:
    """Return whether every list has elements alike, that are no lists, and no name has two meanings."""
    if isinstance(content, list):
        return (
            len({_shape(item) for item in content}) == 1
            and not isinstance(content[0], list)
            and _is_regular(content[0])
        )
    if not isinstance(content, dict):
        return True
    if any(isinstance(key, int) for key in content):
        return False
    types = [_camel(key) for key, item in content.items() if isinstance(_element(item), dict)]
    return len({*types, *content}) == len(types) + len(content) and all(map(_is_regular, content.values()))


def _shape(content: Any) -> Any:
    if isinstance(content, dict):
        return tuple((key, _shape(item)) for key, item in content.items())
    return tuple(map(_shape, content)) if isinstance(content, list) else None


def _element(content: Any) -> Any:
    return content[0] if isinstance(content, list) and content else content


def _own_name(name: str, taken: set[str]) -> str:
    """Return a name for a field that no other has."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
    plain = plain if plain[:1].isalpha() else f"v_{plain}"
    while plain in taken:
        plain += "_"
    taken.add(plain)
    return plain


def file_descriptor(message: str, variables: list[Variable], notes: list[str]) -> FileDescriptorProto:
    """Return a .proto file with ``message``; ``notes`` says of each variable what it is to the model."""
    file = FileDescriptorProto(name=f"{PACKAGE}/{message}.proto", package=PACKAGE, syntax="proto3")
    states = {item.signal.states.__name__: item.signal.states for item in variables if item.signal.states is not None}
    for name, enum in sorted(states.items()):
        file.message_type.append(_enum_holder(name, enum))
    root = file.message_type.add(name=message)
    _add_fields(
        file, root, [4, len(file.message_type) - 1], tree(tuple(item.name for item in variables)), variables, notes
    )
    return file


def descriptor_set(file: FileDescriptorProto) -> bytes:
    """Return the serialized FileDescriptorSet that an MCAP schema record wants."""
    return FileDescriptorSet(file=[file]).SerializeToString(deterministic=True)


def comment(variable: Variable, note: str) -> str:
    """Return one line: unit, meaning, states, what it is to the model."""
    states = variable.signal.states
    names = "" if states is None else " (" + ", ".join(f"{int(item)} {item.name}" for item in states) + ")"
    return f"[{variable.signal.unit}] {variable.signal.text}{names}; {note}"


def _lists(node: Any) -> Any:
    """Return the same with lists where the keys count from 1."""
    if not isinstance(node, dict):
        return node
    if node and set(node) == set(range(1, len(node) + 1)):
        return [_lists(node[key]) for key in sorted(node)]
    return {key: _lists(value) for key, value in node.items()}


def _enum_holder(name: str, enum: type[IntEnum]) -> DescriptorProto:
    """Return a message that holds the enum: protobuf's value names are global beside their enum."""
    values = EnumDescriptorProto(name="Value")
    members = sorted(enum, key=lambda item: (int(item) != 0, int(item)))
    if int(members[0]) != 0:
        values.value.add(name="UNSPECIFIED", number=0)
    for member in members:
        values.value.add(name=member.name, number=int(member))
    return DescriptorProto(name=name, enum_type=[values])


def _add_fields(
    file: FileDescriptorProto,
    message: DescriptorProto,
    path: list[int],
    fields: Tree,
    variables: list[Variable],
    notes: list[str],
) -> None:
    prefix = ".".join(["", PACKAGE, *_names_on(file, path)])
    for number, (name, content) in enumerate(fields.items(), start=1):
        field = message.field.add(name=name, number=number, label=FieldDescriptorProto.LABEL_OPTIONAL)
        if isinstance(content, list):
            field.label = FieldDescriptorProto.LABEL_REPEATED
            content = content[0]
        if isinstance(content, dict):
            nested = message.nested_type.add(name=_camel(name))
            field.type = FieldDescriptorProto.TYPE_MESSAGE
            field.type_name = f"{prefix}.{nested.name}"
            _add_fields(file, nested, [*path, 3, len(message.nested_type) - 1], content, variables, notes)
        else:
            _set_type(field, variables[content])
            text = comment(variables[content], notes[content])
            file.source_code_info.location.add(
                path=[*path, 2, number - 1], span=[0, 0, 0], leading_comments=f" {text}\n"
            )


def _set_type(field: FieldDescriptorProto, variable: Variable) -> None:
    if variable.kind is float:
        field.type = FieldDescriptorProto.TYPE_DOUBLE
    elif variable.kind is bool:
        field.type = FieldDescriptorProto.TYPE_BOOL
    elif variable.signal.states is not None:
        field.type = FieldDescriptorProto.TYPE_ENUM
        field.type_name = f".{PACKAGE}.{variable.signal.states.__name__}.Value"
    else:
        field.type = FieldDescriptorProto.TYPE_SFIXED32


def _names_on(file: FileDescriptorProto, path: list[int]) -> list[str]:
    message = file.message_type[path[1]]
    names = [message.name]
    for index in path[3::2]:
        message = message.nested_type[index]
        names.append(message.name)
    return names


def _camel(name: str) -> str:
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))
