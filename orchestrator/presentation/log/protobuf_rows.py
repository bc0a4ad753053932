"""Protobuf bytes of an instance's values, made by filling a template: every message has the same layout.

All scalars are written at fixed width (double, sfixed32, one byte for a bool, five bytes for an enum:
a varint may be padded), zeros included, so that many messages are a few array operations: one for each run of values
at equal distances.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from modelkit.variables import Variable
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.schema import tree
from orchestrator.simulation.cosim.fmu_instance import Array

VARINT, FIXED64, LENGTH, FIXED32 = 0, 1, 2, 5
WIDTHS = {"double": 8, "int": 4, "enum": 5, "bool": 1}
TYPES = {"double": np.float64, "int": np.int32, "bool": np.uint8, "enum": np.uint8}
WIRE_TYPES = {"double": FIXED64, "int": FIXED32, "enum": VARINT, "bool": VARINT}
SHIFTS = np.array([0, 7, 14, 21, 28], dtype=np.int64)
CONTINUATION_BITS = 0x80808080
"""Bits of the first four bytes which say that another one follows."""
LOW_BITS = np.array([0x7F, 0x7F, 0x7F, 0x7F, 0x0F], dtype=np.int64)


class ValueRun(NamedTuple):
    """Values of one kind at equal distances in a message."""

    numbers: slice
    """Of those of their kind."""
    begin: int
    """Byte of the first in the message."""
    stride: int
    """Bytes from one to the next."""


class Encoder:
    """From an array of values to the bytes of their protobuf message (see ``schema``).

    ``columns``: of the values in the rows that it is given; None: in order. ``room``: bytes left free in front of each
    message.
    """

    def __init__(self, variables: list[Variable], columns: Sequence[int] | None = None, room: int = 0) -> None:
        self._kinds = [_kind(variable) for variable in variables]
        self._offsets: list[tuple[int, int]] = []
        template = self._message(tree(tuple(variable.name for variable in variables)), 0)
        self._template: NDArray[np.uint8] = np.frombuffer(bytes(room) + template, dtype=np.uint8)[None, :]
        self._room = room
        self.size = len(template)
        self.layout = {kind: self._fields(kind) for kind in WIDTHS}
        """Kind -> (places of the variables, in the order of their bytes; where these are)."""
        chosen = np.arange(len(variables)) if columns is None else np.asarray(columns, dtype=np.intp)
        self._columns = {kind: chosen[places] for kind, (places, _) in self.layout.items()}
        self._messages = np.empty((0, room + self.size), dtype=np.uint8)
        self._views: dict[str, list[tuple[slice, NDArray[Any]]]] = {}
        self._chosen: dict[str, Array] = {}

    def encode(self, values: Array) -> bytes:
        """Return the message for ``values``, in the order of the variables."""
        return self.rows(values[None, :])[:, self._room :].tobytes()

    def rows(self, values: Array) -> NDArray[np.uint8]:
        """Return one message per row of ``values``, all of the same size. The next call writes over them."""
        count = len(values)
        if count > len(self._messages):
            self._make_room(count)
        for kind, views in self._views.items():
            if not views:
                continue
            columns, chosen = self._columns[kind], self._chosen[kind][:count]
            values.take(columns, axis=1, out=chosen, mode="clip")
            if kind == "enum":
                _write_varints(views, chosen.astype(np.int64))
                continue
            if kind == "int":
                chosen = chosen.astype(np.int32)
            elif kind == "bool":
                chosen = chosen != 0.0
            for numbers, view in views:
                view[:count] = chosen[:, numbers]
        return self._messages[:count]

    def _make_room(self, count: int) -> None:
        self._messages = np.repeat(self._template, count, axis=0)
        self._views = {kind: _views(self._messages, self._room, kind, runs) for kind, (_, runs) in self.layout.items()}
        self._chosen = {kind: np.empty((count, len(columns))) for kind, columns in self._columns.items()}

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
        size = sum(WIDTHS[self._kinds[item]] for item in content)
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
        return bytes(WIDTHS[self._kinds[place]])

    def _fields(self, kind: str) -> tuple[NDArray[np.intp], list[ValueRun]]:
        chosen = [(place, offset) for place, offset in self._offsets if self._kinds[place] == kind]
        places = np.array([place for place, _ in chosen], dtype=np.intp)
        return places, _runs([offset for _, offset in chosen])


def _runs(offsets: list[int]) -> list[ValueRun]:
    """Return the numbers in ``offsets``, which rise, as runs of equal distance."""
    runs: list[ValueRun] = []
    begin = 0
    while begin < len(offsets):
        stride = offsets[begin + 1] - offsets[begin] if begin + 1 < len(offsets) else 0
        end = begin + 1
        while end < len(offsets) and offsets[end] - offsets[end - 1] == stride:
            end += 1
        runs.append(ValueRun(slice(begin, end), offsets[begin], stride))
        begin = end
    return runs


def _write_varints(views: list[tuple[slice, NDArray[Any]]], values: NDArray[np.int64]) -> None:
    """Write whole numbers as varints of five bytes: four in one word, then the fifth."""
    words = (values & 0x7F).astype(np.uint32) | np.uint32(CONTINUATION_BITS)
    last = np.zeros(values.shape, dtype=np.uint8)
    if values.size and (values.min() < 0 or values.max() > 0x7F):
        for byte in range(1, 4):
            words |= ((values << byte) & (0x7F << 8 * byte)).astype(np.uint32)
        last = (values >> 28 & 0x0F).astype(np.uint8)
    for numbers, view in views:
        place = view[: len(values)]
        place[:, :, :4].view("<u4")[:, :, 0] = words[:, numbers]
        place[:, :, 4] = last[:, numbers]


def _views(messages: NDArray[np.uint8], room: int, kind: str, runs: list[ValueRun]) -> list[tuple[slice, NDArray[Any]]]:
    """Return the values of each run in messages (n, room and bytes) as an array (n, count), an enum's (n, count, 5)."""
    size = messages.shape[1]
    found = []
    for numbers, begin, stride in runs:
        shape: tuple[int, ...] = (len(messages), numbers.stop - numbers.start)
        strides: tuple[int, ...] = (size, stride)
        if kind == "enum":
            shape, strides = (*shape, WIDTHS[kind]), (*strides, 1)
        found.append((numbers, np.ndarray(shape, TYPES[kind], messages.data, room + begin, strides)))
    return found


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
        for kind, (places, runs) in self._encoder.layout.items():
            for numbers, values in _views(np.ascontiguousarray(data), 0, kind, runs):
                if kind == "enum":
                    bits = (values.astype(np.int64) & LOW_BITS) << SHIFTS
                    values = bits.sum(axis=2).astype(np.uint32).view(np.int32)
                rows[:, places[numbers]] = values
