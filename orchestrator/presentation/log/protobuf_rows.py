"""Protobuf bytes of an instance's values, made by filling a template: every message has the same layout.

All scalars are written at fixed width (double, sfixed32, one byte for a bool, five bytes for an enum:
a varint may be padded), zeros included, so that many messages are a few array operations.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from modelkit.variables import Variable
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.schema import tree
from orchestrator.simulation.cosim.fmu_instance import Array

VARINT, FIXED64, LENGTH, FIXED32 = 0, 1, 2, 5
WIDTHS = {"double": 8, "int": 4, "enum": 5, "bool": 1}
WIRE_TYPES = {"double": FIXED64, "int": FIXED32, "enum": VARINT, "bool": VARINT}
SHIFTS = np.array([0, 7, 14, 21, 28], dtype=np.int64)
CONTINUES = np.array([0x80, 0x80, 0x80, 0x80, 0x00], dtype=np.int64)
LOW_BITS = np.array([0x7F, 0x7F, 0x7F, 0x7F, 0x0F], dtype=np.int64)


class Encoder:
    """From an array of values to the bytes of their protobuf message (see ``schema``)."""

    def __init__(self, variables: list[Variable]) -> None:
        self._kinds = [_kind(variable) for variable in variables]
        self._offsets: list[tuple[int, int]] = []
        template = self._message(tree([variable.name for variable in variables]), 0)
        self._template: NDArray[np.uint8] = np.frombuffer(template, dtype=np.uint8)[None, :]
        self.size = len(template)
        self.layout = {kind: self._scatter(kind) for kind in WIDTHS}
        """Kind -> (places of the variables, byte offsets of their values)."""

    def encode(self, values: Array) -> bytes:
        """Return the message for ``values``, in the order of the variables."""
        return self.rows(values[None, :]).tobytes()

    def rows(self, values: Array) -> NDArray[np.uint8]:
        """Return one message per row of ``values`` (n, variables), all of the same size."""
        count = len(values)
        messages = np.repeat(self._template, count, axis=0)
        for kind, (places, where) in self.layout.items():
            if not len(places):
                continue
            chosen = np.take(values, places, axis=1)
            if kind == "double":
                raw = chosen.view(np.uint8)
            elif kind == "int":
                raw = chosen.astype(np.int32).view(np.uint8)
            elif kind == "bool":
                raw = (chosen != 0.0).astype(np.uint8)
            else:
                bits = chosen.astype(np.int64)[:, :, None] >> SHIFTS
                raw = ((bits & LOW_BITS) | CONTINUES).astype(np.uint8)
            messages[:, where.ravel()] = raw.reshape(count, -1)
        return messages

    def _message(self, fields: dict[str, Any], start: int) -> bytes:
        """Return the template of a message whose first byte stands at ``start``; note where values go."""
        parts = b""
        for number, content in enumerate(fields.values(), start=1):
            parts += self._field(number, content, start + len(parts))
        return parts

    def _field(self, number: int, content: Any, start: int) -> bytes:
        if isinstance(content, dict):
            return self._submessage(number, content, start)
        if not isinstance(content, list):
            tag = _varint(number << 3 | WIRE_TYPES[self._kinds[content]])
            return tag + self._scalar(content, start + len(tag))
        if isinstance(content[0], dict):
            parts = b""
            for item in content:
                parts += self._submessage(number, item, start + len(parts))
            return parts
        size = sum(WIDTHS[self._kinds[item]] for item in content)
        head = _varint(number << 3 | LENGTH) + _varint(size)
        body = b""
        for item in content:
            body += self._scalar(item, start + len(head) + len(body))
        return head + body

    def _submessage(self, number: int, fields: dict[str, Any], start: int) -> bytes:
        noted = len(self._offsets)
        size = len(self._message(fields, 0))
        del self._offsets[noted:]
        head = _varint(number << 3 | LENGTH) + _varint(size)
        return head + self._message(fields, start + len(head))

    def _scalar(self, place: int, start: int) -> bytes:
        self._offsets.append((place, start))
        return bytes(WIDTHS[self._kinds[place]])

    def _scatter(self, kind: str) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        chosen = [(place, offset) for place, offset in self._offsets if self._kinds[place] == kind]
        places = np.array([place for place, _ in chosen], dtype=np.intp)
        offsets = np.array([offset for _, offset in chosen], dtype=np.intp)
        return places, offsets[:, None] + np.arange(WIDTHS[kind], dtype=np.intp)


def _kind(variable: Variable) -> str:
    if variable.kind is float:
        return "double"
    if variable.kind is bool:
        return "bool"
    return "enum" if variable.signal.states is not None else "int"


def _varint(value: int) -> bytes:
    parts = bytearray()
    while value > 0x7F:
        parts.append(value & 0x7F | 0x80)
        value >>= 7
    parts.append(value)
    return bytes(parts)


class Decoder:
    """From messages that ``Encoder`` wrote back to an array; any protobuf reader gives the same values."""

    def __init__(self, variables: list[Variable]) -> None:
        self._encoder = Encoder(variables)
        self._width = len(variables)

    def rows(self, messages: NDArray[np.uint8], file: object) -> Array:
        """Return one row of values for each message (n, bytes). Raises ``BadInput`` if they have another layout."""
        if messages.shape[1] != self._encoder.size:
            raise BadInput("holds messages that are not laid out as apa writes them", file=file)
        rows = np.empty((len(messages), self._width))
        self._into(rows, messages)
        return rows

    def _into(self, rows: Array, data: NDArray[np.uint8]) -> None:
        for kind, (places, where) in self._encoder.layout.items():
            if not len(places):
                continue
            raw = np.ascontiguousarray(data[:, where.ravel()])
            if kind == "double":
                rows[:, places] = raw.view(np.float64)
            elif kind == "int":
                rows[:, places] = raw.view(np.int32)
            elif kind == "bool":
                rows[:, places] = raw
            else:
                bits = raw.reshape(len(rows), len(places), 5).astype(np.int64) & LOW_BITS
                rows[:, places] = (bits << SHIFTS).sum(axis=2).astype(np.uint32).view(np.int32)
