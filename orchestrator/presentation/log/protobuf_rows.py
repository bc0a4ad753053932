"""Protobuf bytes of an instance's values, made by filling a template: every message has the same layout.

All scalars are written at fixed width (double, sfixed32, one byte for a bool, five bytes for an enum:
a varint may be padded), zeros included, so that many messages are one assignment between structured arrays.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from modelkit.variables import Variable
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.schema import tree
from orchestrator.simulation.cosim.fmu_instance import Array

VARINT, FIXED64, LENGTH, FIXED32 = 0, 1, 2, 5
DTYPES: dict[str, np.dtype[Any]] = {
    kind: np.dtype(text) for kind, text in {"double": "<f8", "int": "<i4", "enum": "V5", "bool": "?"}.items()
}
WIRE_TYPES = {"double": FIXED64, "int": FIXED32, "enum": VARINT, "bool": VARINT}
BYTES = np.arange(5)
"""Of an enum."""
BYTE_SHIFTS = 7 * BYTES
CONTINUATION_BITS = np.array([0x80, 0x80, 0x80, 0x80, 0])
"""Of the bytes of an enum: another one follows."""
LOW_BITS = np.array([0x7F, 0x7F, 0x7F, 0x7F, 0x0F])


class Encoder:
    """From an array of values to the bytes of their protobuf message (see ``schema``).

    ``columns``: of the values in the rows that it is given; None: in order. ``room``: bytes left free in front of each
    message.
    """

    def __init__(self, variables: list[Variable], columns: Sequence[int] | None = None, room: int = 0) -> None:
        self._kinds = [_kind(variable) for variable in variables]
        self._offsets: list[tuple[int, int]] = []
        """Place of a variable, and of its first byte behind the room."""
        template = self._message(tree(tuple(variable.name for variable in variables)), 0)
        self._template = np.array([*bytes(room), *template], dtype=np.uint8)
        self._room = room
        self.size = len(template)
        fields = [(place, room + offset, DTYPES[self._kinds[place]]) for place, offset in self._offsets]
        chosen = range(len(variables)) if columns is None else columns
        plain = [item for item in fields if item[2].kind != "V"]
        self._row = _dtype([DTYPES["double"]] * len(plain), [8 * chosen[place] for place, _, _ in plain])
        self._message_row = _dtype([dtype for _, _, dtype in plain], [begin for _, begin, _ in plain])
        enums = [item for item in fields if item[2].kind == "V"]
        self._enum_columns = np.array([chosen[place] for place, _, _ in enums], dtype=np.intp)
        self._enum_bytes = np.array([begin for _, begin, _ in enums], dtype=np.intp)[:, None] + BYTES
        self._template[self._enum_bytes] = CONTINUATION_BITS

    def encode(self, values: Array) -> bytes:
        """Return the message for ``values``, in the order of the variables."""
        return self.rows(values[None, :])[:, self._room :].tobytes()

    def rows(self, values: Array) -> NDArray[np.uint8]:
        """Return one message per row of ``values``, all of the same size."""
        messages = np.empty((len(values), len(self._template)), dtype=np.uint8)
        messages[:] = self._template
        _records(messages, self._message_row)[:] = _records(values, self._row)
        if len(self._enum_columns):
            enums = values.take(self._enum_columns, axis=1).astype(np.int64)
            if enums.min() < 0 or enums.max() > 0x7F:
                messages[:, self._enum_bytes] = enums[:, :, None] >> BYTE_SHIFTS & LOW_BITS | CONTINUATION_BITS
            else:
                messages[:, self._enum_bytes[:, 0]] = enums | 0x80
        return messages

    def values(self, messages: NDArray[np.uint8]) -> Array:
        """Return one row of values for each message (n, bytes) that it has made."""
        rows = np.empty((len(messages), len(self._kinds)))
        _records(rows, self._row)[:] = _records(messages, self._message_row)
        varints = (messages[:, self._enum_bytes] & LOW_BITS) << BYTE_SHIFTS
        rows[:, self._enum_columns] = varints.sum(axis=2).astype(np.uint32).view(np.int32)
        return rows

    def _message(self, fields: dict[str, Any], start: int) -> bytes:
        """Return the template of a message whose first byte stands at ``start``; note where values go."""
        parts = b""
        for number, content in enumerate(fields.values(), start=1):
            parts += self._member(number, content, start + len(parts))
        return parts

    def _member(self, number: int, content: Any, start: int) -> bytes:
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
        size = sum(DTYPES[self._kinds[item]].itemsize for item in content)
        head = _varint(number << 3 | LENGTH) + _varint(size)
        body = b""
        for item in content:
            body += self._scalar(item, start + len(head) + len(body))
        return head + body

    def _submessage(self, number: int, fields: dict[str, Any], start: int) -> bytes:
        noted = len(self._offsets)
        body = self._message(fields, start)
        head = _varint(number << 3 | LENGTH) + _varint(len(body))
        self._offsets[noted:] = [(place, offset + len(head)) for place, offset in self._offsets[noted:]]
        return head + body

    def _scalar(self, place: int, start: int) -> bytes:
        self._offsets.append((place, start))
        return bytes(DTYPES[self._kinds[place]].itemsize)


def _dtype(fields: list[np.dtype[Any]], offsets: list[int]) -> np.dtype[Any]:
    """Return the type of a record with fields at offsets [bytes]."""
    names = [str(number) for number in range(len(fields))]
    return np.dtype({"names": names, "formats": fields, "offsets": offsets})


def _records(rows: NDArray[Any], dtype: np.dtype[Any]) -> NDArray[Any]:
    """Return rows as an array of records, each of which begins where its row does."""
    rows = np.ascontiguousarray(rows)
    return np.ndarray(len(rows), dtype, rows.data, strides=rows.strides[:1])


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

    def rows(self, messages: NDArray[np.uint8], file: object) -> Array:
        """Return one row of values for each message (n, bytes). Raises ``BadInput`` if they have another layout."""
        if messages.shape[1] != self._encoder.size:
            raise BadInput("holds messages that are not laid out as apa writes them", file=file)
        return self._encoder.values(messages)
