"""Messages made many at a time are those that a protobuf library makes one by one."""

from enum import IntEnum
from typing import Any

import numpy as np
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

from modelkit.signal import Signal
from modelkit.variables import Variable
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.protobuf_rows import Decoder, Encoder
from orchestrator.presentation.log.schema import PACKAGE, descriptor_set, file_descriptor


class Mode(IntEnum):
    IDLE = 0
    BUSY = 3
    DONE = 200


def variable(name: str, kind: type, states: Any = None) -> Variable:
    return Variable(name, kind, Signal("1", "a signal", states=states), kind())


VARIABLES = [
    variable("speed", float),
    variable("mode", int, Mode),
    variable("pose.x", float),
    variable("pose.y", float),
    variable("ready", bool),
    variable("count", int),
    variable("other", int, Mode),
    *(variable(f"echo[{k}]", float) for k in range(1, 6)),
    variable("late", bool),
]
LIMITS = np.array([
    [1.5, 3, -0.0, np.inf, 1, -7, 200, 1, 2, 3, 4, 5, 0],
    [0.0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
    [-1e300, -1, 5e-324, 7, 1, 2**31 - 1, -(2**31), 9, 8, 7, 6, 5, 1],
    [2.5, 2**31 - 1, 1, 2, 0, -(2**31), 128, 1, 1, 1, 1, 1, 1],
])  # fmt: skip


def message_class() -> Any:
    found = descriptor_pb2.FileDescriptorSet.FromString(
        descriptor_set(file_descriptor("Plant", VARIABLES, ["output"] * len(VARIABLES)))
    )
    pool = descriptor_pool.DescriptorPool()
    for file in found.file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(f"{PACKAGE}.Plant"))


def test_a_protobuf_library_reads_the_values() -> None:
    plant = message_class()
    for row, message in zip(LIMITS.tolist(), Encoder(VARIABLES).rows(LIMITS), strict=True):
        read = plant.FromString(message.tobytes())
        found = [read.speed, read.mode, read.pose.x, read.pose.y, read.ready, read.count, read.other, *read.echo]
        assert [*found, read.late] == row


def test_values_come_back() -> None:
    assert np.array_equal(Decoder(VARIABLES).rows(Encoder(VARIABLES).rows(LIMITS), "x"), LIMITS)


def test_any_number_of_rows_has_the_same_messages() -> None:
    encoder = Encoder(VARIABLES)
    expected = [Encoder(VARIABLES).encode(row) for row in LIMITS]
    for count in (2, 4, 1, 3):  # smaller and larger than the room that there is
        for begin in range(len(LIMITS) - count + 1):
            rows = encoder.rows(LIMITS[begin : begin + count])
            assert [row.tobytes() for row in rows] == expected[begin : begin + count]


def test_columns_and_room_in_front_of_a_message() -> None:
    columns = np.random.default_rng(3).permutation(20)[: len(VARIABLES)]
    wide = np.zeros((len(LIMITS), 20))
    wide[:, columns] = LIMITS
    rows = Encoder(VARIABLES, columns.tolist(), 31).rows(wide)
    assert rows[:, 31:].tobytes() == Encoder(VARIABLES).rows(LIMITS).tobytes()


def test_messages_of_another_layout_are_refused() -> None:
    with pytest.raises(BadInput, match="not laid out as apa writes"):
        Decoder(VARIABLES).rows(Encoder(VARIABLES[:-1]).rows(LIMITS[:, :-1]), "x")
