"""A protobuf message type for the variables of a slave, made from their names, types, units and meanings.

``pose.x`` becomes field ``x`` of a nested message ``pose``; ``ultrasonic[3]`` the third element of a
repeated field. The unit and meaning stand as a comment at each field, the names of the states of a
mode as an enum. Field numbers follow the order of the variables.
"""

import re
from enum import IntEnum
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
Tree = dict[str, Any]
"""Field name -> place of a variable (int), message (Tree), or list of these."""
PACKAGE = "apa"


def tree(names: list[str]) -> Tree:
    """Return the nested structure that ``names`` spell, with the place of each name at its leaf."""
    root: Tree = {}
    for place, name in enumerate(names):
        parts = [int(part) if part.isdigit() else part for part in TOKEN.findall(name)]
        _put(root, parts, place)
    return _lists(root)  # type: ignore[no-any-return]


def file_descriptor(message: str, variables: list[Variable], notes: list[str]) -> FileDescriptorProto:
    """Return a .proto file with ``message``; ``notes`` says of each variable what it is to the model."""
    file = FileDescriptorProto(name=f"{PACKAGE}/{message}.proto", package=PACKAGE, syntax="proto3")
    states = {item.signal.states.__name__: item.signal.states for item in variables if item.signal.states is not None}
    for name, enum in sorted(states.items()):
        file.message_type.append(_enum_holder(name, enum))
    root = file.message_type.add(name=message)
    _add_fields(file, root, [4, len(file.message_type) - 1], tree([item.name for item in variables]), variables, notes)
    return file


def descriptor_set(file: FileDescriptorProto) -> bytes:
    """Return the serialized FileDescriptorSet that an MCAP schema record wants."""
    return FileDescriptorSet(file=[file]).SerializeToString(deterministic=True)


def comment(variable: Variable, note: str) -> str:
    """Return one line: unit, meaning, states, what it is to the model."""
    states = variable.signal.states
    names = "" if states is None else " (" + ", ".join(f"{int(item)} {item.name}" for item in states) + ")"
    return f"[{variable.signal.unit}] {variable.signal.text}{names}; {note}"


def _put(node: Tree, parts: list[Any], place: int) -> None:
    for part in parts[:-1]:
        node = node.setdefault(part, {})
    node[parts[-1]] = place


def _lists(node: Any) -> Any:
    if not isinstance(node, dict):
        return node
    if node and all(isinstance(key, int) for key in node):
        return [_lists(node[key]) for key in sorted(node)]
    return {str(key): _lists(value) for key, value in node.items()}


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
