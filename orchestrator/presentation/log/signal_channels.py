"""The channels of an instance's signals: some written at each exchange, some when a value changes."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from modelkit.signal import Role
from modelkit.variables import Variable
from orchestrator.presentation.log.mcap_file import CHUNK_SIZE, HEADER_SIZE
from orchestrator.presentation.log.protobuf_rows import Encoder
from orchestrator.presentation.log.read_log import VARIABLES
from orchestrator.presentation.log.schema import PACKAGE, channel_places, descriptor_set, file_descriptor, name_prefix
from orchestrator.presentation.log.sink import MessageSink, Sink
from orchestrator.simulation.cosim.compiled_master import EXCHANGES_PER_CALL
from orchestrator.simulation.cosim.fmu_instance import Array, FmuInstance, places_of
from orchestrator.simulation.cosim.recording import to_json
from orchestrator.simulation.cosim.signal_blocks import Times

ROWS_SIZE, MAX_ROWS_SIZE = CHUNK_SIZE // 2, 4 * CHUNK_SIZE
"""Bytes of the signals in one chunk: expected, and if all of them change at each exchange."""


class RowChanges:
    """Where values differ from those of the row above, bit by bit; all of the first row if there is none above."""

    def __init__(self, rows: Array, before: Array | None) -> None:
        bits = rows.view(np.int64)
        self._first = np.ones(bits.shape[1], dtype=bool) if before is None else bits[0] != before.view(np.int64)
        self._later = bits[1:] != bits[:-1]
        self._changing = self._first | self._later.any(axis=0)

    @property
    def columns(self) -> NDArray[np.intp]:
        """Return those in which a value differs."""
        return np.flatnonzero(self._changing)

    def rows_of(self, columns: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return the rows in which one of some columns differs."""
        changing: NDArray[np.intp] = columns[self._changing[columns]]
        if not len(changing):
            return changing
        later = np.flatnonzero(self._later[:, changing].any(axis=1)) + 1
        return np.append(0, later) if self._first[changing].any() else later


class SignalChannel:
    """A channel of some inputs and outputs of an instance, by its place among those of ``channel_places``.

    ``signals``: variable, what it is to the model, its column in a row of all values.
    """

    def __init__(self, file: Sink, instance: str, place: str, signals: Sequence[tuple[Variable, str, int]]) -> None:
        prefix = name_prefix(place)
        variables = [item._replace(name=item.name.removeprefix(prefix)) for item, _, _ in signals]
        self.columns = np.array([column for _, _, column in signals], dtype=np.intp)
        topic = f"/{instance}/{place}" if place else f"/{instance}"
        notes = [note for _, note, _ in signals]
        self._channel = add_channel(file, topic, message_name(instance, place), variables, notes)
        self._encoder = Encoder(variables, self.columns.tolist(), HEADER_SIZE)
        self.is_on_change = bool(place)
        self._latest = b""
        """Its latest message, if it is written on change."""
        self.size = HEADER_SIZE + self._encoder.size

    def write(self, to: MessageSink, times: Times, rows: Array) -> None:
        """Write a message for each of ``times``."""
        messages = self._encoder.rows(rows)
        self._latest = messages[-1, HEADER_SIZE:].tobytes()
        to.write_rows(self._channel, times, messages)

    def repeat(self, to: MessageSink, t_ns: int) -> None:
        """Write the latest message once more."""
        to.write(self._channel, t_ns, self._latest)


class SignalChannels:
    """All channels of signals of a log.

    ``is_repeated``: what is written on change is also written at the first of the rows that are handed over.
    """

    def __init__(self, file: Sink, instances: Sequence[FmuInstance], *, is_repeated: bool) -> None:
        parts = places_of(instances)
        self._channels = [
            channel
            for number, instance in enumerate(instances)
            for channel in signal_channels(file, instance, parts[2 * number : 2 * number + 2])
        ]
        self._is_repeated = is_repeated
        self._channel_of_column = np.zeros(parts[-1].stop if parts else 0, dtype=np.intp)
        for number, channel in enumerate(self._channels):
            self._channel_of_column[channel.columns] = number

    def write(self, to: MessageSink, times: Times, rows: Array, changes: RowChanges) -> None:
        """Write the messages of rows."""
        touched = set(self._channel_of_column[changes.columns].tolist())
        for number, channel in enumerate(self._channels):
            if not channel.is_on_change:
                channel.write(to, times, rows)
            elif number in touched:
                chosen = changes.rows_of(channel.columns)
                if self._is_repeated and chosen[0]:
                    chosen = np.append(0, chosen)
                channel.write(to, times[chosen], rows[chosen])
            elif self._is_repeated:
                channel.repeat(to, int(times[0]))

    def rows_per_chunk(self) -> int:
        """Return how many rows go into a chunk: few enough for one in which every value changes in each row.

        They are whole blocks of the compiled master if they can be: what comes in one needs no copy.
        """
        expected = sum(channel.size for channel in self._channels if not channel.is_on_change)
        count = min(ROWS_SIZE // expected, MAX_ROWS_SIZE // sum(channel.size for channel in self._channels))
        return count // EXCHANGES_PER_CALL * EXCHANGES_PER_CALL or max(1, count)


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


def message_name(instance: str, place: str) -> str:
    """Return the name of the message type of a channel."""
    return f"{instance}_{place}".title().replace("_", "")


def add_channel(file: Sink, topic: str, message: str, variables: list[Variable], notes: list[str]) -> int:
    """Return a new channel whose schema is made from ``variables``."""
    descriptors, text = _describe(message, tuple(variables), tuple(notes))
    return file.channel(topic, f"{PACKAGE}.{message}", descriptors, {VARIABLES: text})


@lru_cache(maxsize=64)
def _describe(message: str, variables: tuple[Variable, ...], notes: tuple[str, ...]) -> tuple[bytes, str]:
    """Return the types of a message, serialized, and the description of its variables: the same in each run."""
    described = list(variables), list(notes)
    return descriptor_set(file_descriptor(message, *described)), to_json(*described)
