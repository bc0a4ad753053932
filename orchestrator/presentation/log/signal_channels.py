"""The channels of an instance's signals: some written at each exchange, some when a value changes."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from modelkit.signal import Role
from modelkit.variables import Variable
from orchestrator.presentation.log.mcap_file import CHUNK_SIZE, HEADER_SIZE
from orchestrator.presentation.log.protobuf_rows import Encoder
from orchestrator.presentation.log.read_log import VARIABLES
from orchestrator.presentation.log.schema import PACKAGE, channel_places, descriptor_set, file_descriptor, name_prefix
from orchestrator.presentation.log.sink import Sink
from orchestrator.simulation.cosim.fmu_instance import Array, FmuInstance
from orchestrator.simulation.cosim.recording import to_json
from orchestrator.simulation.cosim.signal_blocks import Times

ROWS_SIZE, MAX_ROWS_SIZE = CHUNK_SIZE // 4, 4 * CHUNK_SIZE
"""Bytes of the signals in one chunk: expected, and if all of them change at each exchange."""


class RowChanges:
    """Where values differ from those of the row above, bit by bit; all of the first row if there is none above."""

    def __init__(self, rows: Array, before: Array | None) -> None:
        bits = rows.view(np.int64)
        self._first = np.ones(bits.shape[1], dtype=bool) if before is None else bits[0] != before.view(np.int64)
        self._later = bits[1:] != bits[:-1]
        self._columns = self._first | self._later.any(axis=0)

    def rows_of(self, columns: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return the rows in which one of some columns differs."""
        if not self._columns.take(columns).any():
            return np.empty(0, dtype=np.intp)
        changing = columns[self._columns[columns]]
        later = np.flatnonzero(self._later[:, changing].any(axis=1)) + 1
        return np.append(0, later) if self._first[changing].any() else later


class SignalChannel:
    """A channel of some inputs and outputs of an instance, by its place among those of ``channel_places``.

    ``signals``: variable, what it is to the model, its column in a row of all values.
    """

    def __init__(self, file: Sink, instance: str, place: str, signals: Sequence[tuple[Variable, str, int]]) -> None:
        prefix = name_prefix(place)
        variables = [item._replace(name=item.name.removeprefix(prefix)) for item, _, _ in signals]
        self._columns = np.array([column for _, _, column in signals], dtype=np.intp)
        topic = f"/{instance}/{place}" if place else f"/{instance}"
        notes = [note for _, note, _ in signals]
        self._channel = add_channel(file, topic, message_name(instance, place), variables, notes)
        self._encoder = Encoder(variables, self._columns.tolist(), HEADER_SIZE)
        self._file = file
        self.is_on_change = bool(place)
        self._latest = b""
        """Its latest message, if it is written on change."""
        self.size = HEADER_SIZE + self._encoder.size

    def write(self, times: Times, rows: Array, changes: RowChanges, *, from_first: bool) -> None:
        """Hand a message for each of ``times`` to the file, or for each at which a value changes.

        ``from_first``: also for the first, changed or not.
        """
        if not self.is_on_change:
            self._file.write_rows(self._channel, times, self._encoder.rows(rows))
            return
        chosen = changes.rows_of(self._columns)
        if from_first and not len(chosen):
            self._file.write(self._channel, int(times[0]), self._latest)
        if not len(chosen):
            return
        if from_first and chosen[0]:
            chosen = np.append(0, chosen)
        messages = self._encoder.rows(rows[chosen])
        self._latest = messages[-1, HEADER_SIZE:].tobytes()
        self._file.write_rows(self._channel, times[chosen], messages)


def signal_channels(file: Sink, instance: FmuInstance, columns: Sequence[slice]) -> list[SignalChannel]:
    """Return the channels of an instance, those on change first: a reader knows their values at each exchange.

    ``columns``: its inputs and its outputs in a row of all values.
    """
    inputs, outputs = columns
    variables = [*instance.outputs.variables, *instance.inputs.variables]
    notes = ["local" if Role.LOCAL in item.roles else "output" for item in instance.outputs.variables]
    notes += ["input"] * len(instance.inputs.names)
    numbers = [*range(outputs.start, outputs.stop), *range(inputs.start, inputs.stop)]
    signals = list(zip(variables, notes, numbers, strict=True))
    return [
        SignalChannel(file, instance.name, name, [signals[place] for place in places])
        for name, places in channel_places([item.name for item in variables]).items()
    ]


def rows_per_chunk(channels: Sequence[SignalChannel]) -> int:
    """Return how many rows go into a chunk: few enough for one in which every value changes in each row."""
    expected = sum(channel.size for channel in channels if not channel.is_on_change)
    return max(1, min(ROWS_SIZE // expected, MAX_ROWS_SIZE // sum(channel.size for channel in channels)))


def message_name(instance: str, place: str) -> str:
    """Return the name of the message type of a channel."""
    return f"{instance}_{place}".title().replace("_", "")


def add_channel(file: Sink, topic: str, message: str, variables: list[Variable], notes: list[str]) -> int:
    """Return a new channel whose schema is made from ``variables``."""
    descriptors = descriptor_set(file_descriptor(message, variables, notes))
    return file.channel(topic, f"{PACKAGE}.{message}", descriptors, {VARIABLES: to_json(variables, notes)})
