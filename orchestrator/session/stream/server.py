"""A run shown as it goes, over the WebSocket that Foxglove and Lichtblick read: the channels of the log, live.

What is sent once, or seldom, is sent again to whoever comes later. A viewer may change parameters after it has set
``apa.token`` to the word that the command prints. Needs the package ``foxglove-sdk``.
"""

import secrets
from collections.abc import Callable
from typing import Any

import numpy as np
from mcap_protobuf.schema import build_file_descriptor_set
from numpy.typing import NDArray

from fmus.installation import missing_package
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.mcap_file import HEADER_SIZE
from orchestrator.presentation.log.sink import MessageSink
from orchestrator.session.stream.gate import Gate, hidden_host
from orchestrator.session.stream.tuning import Tuning

HOST = "127.0.0.1"
TOKEN = "apa.token"
PICTURES = ("/scene", "/path", "/trail")
"""Those of which whoever subscribes gets the latest message at once."""


class LiveChannels:
    """The face of a log file over a WebSocket server: channels and messages go to whoever looks on."""

    def __init__(self, port: int, name: str, tuning: Tuning) -> None:
        try:
            import foxglove
        except ImportError as error:
            raise BadInput(missing_package("foxglove-sdk", "live"), key="--live") from error
        self._foxglove: Any = foxglove
        self._context = foxglove.Context()
        self._channels: list[Any] = []
        self._latest: dict[int, tuple[bytes, int]] = {}
        self._told: dict[str, float | int | bool] = {}
        self.tuning = tuning
        self.open = True
        listener: Any = _Listener(self)
        self.token = secrets.token_hex(4)
        """What a viewer must set the parameter ``apa.token`` to before it changes another."""
        try:
            inner = hidden_host()
            self._server = foxglove.start_server(
                name=name,
                host=inner,
                port=0,
                capabilities=[foxglove.Capability.Time, foxglove.Capability.Parameters],
                server_listener=listener,
                context=self._context,
            )
            self._gate = Gate(HOST, port, (inner, self._server.port))
        except (RuntimeError, OSError, OverflowError) as error:
            if hasattr(self, "_server"):
                self._server.stop()
            raise BadInput(f"port {port} cannot be opened: {error}", key="--live") from error
        self.address = f"ws://{HOST}:{self._gate.port}"

    def metadata(self, name: str, values: dict[str, str]) -> None:
        """Nothing: what a file says of a whole run has no place in a stream."""

    def add_channel(self, topic: str, message: type[Any]) -> int:
        """Return a new channel for a generated protobuf message class."""
        descriptors = build_file_descriptor_set(message).SerializeToString(deterministic=True)
        return self.channel(topic, message.DESCRIPTOR.full_name, descriptors, {})

    def channel(self, topic: str, schema: str, descriptors: bytes, metadata: dict[str, str]) -> int:
        """Return a new channel for messages of a type in a serialized FileDescriptorSet."""
        described = self._foxglove.Schema(name=schema, encoding="protobuf", data=descriptors)
        made = self._foxglove.Channel(
            topic, schema=described, message_encoding="protobuf", context=self._context, metadata=metadata
        )
        self._channels.append(made)
        return len(self._channels) - 1

    def write(self, channel: int, t_ns: int, data: bytes) -> None:
        """Send one message at ``t_ns`` of simulated time."""
        to = self._channels[channel]
        if to.topic() in PICTURES or to.topic().count("/") > 1:  # parameters and structures
            self._latest[to.id()] = data, t_ns
        to.log(data, log_time=t_ns)

    def write_rows(self, channel: int, t_ns: NDArray[np.int64], rows: NDArray[np.uint8]) -> None:
        """Send messages of equal size, one per row, behind room for its header in a file."""
        for t, row in zip(t_ns.tolist(), rows[:, HEADER_SIZE:], strict=True):
            self.write(channel, t, row.tobytes())

    def later(self, write: Callable[[MessageSink], None]) -> None:
        """Send the messages that ``write`` writes."""
        write(self)

    def flush(self) -> None:
        """Tell what parameters are now, if any was changed."""
        values = self.tuning.values()
        if values != self._told:
            changed = [name for name, value in values.items() if self._told.get(name) != value]
            self._server.publish_parameter_values(self.parameters(changed))
            self._told = values

    def at(self, t_ns: int) -> None:
        """Tell the simulated time."""
        self._server.broadcast_time(t_ns)

    def close(self) -> None:
        """Say goodbye and stop. Safe to call twice."""
        if self.open:
            self.open = False
            self._gate.close()
            self._server.stop()

    def parameters(self, names: list[str]) -> list[Any]:
        """Return parameters as they are now; all, if no name is given."""
        values = self.tuning.values()
        return [
            self._foxglove.Parameter(name, value=value if isinstance(value, bool) else float(value))
            for name, value in values.items()
            if not names or name in names
        ] + ([self._foxglove.Parameter(TOKEN, value="")] if not names or TOKEN in names else [])

    def again(self, channel: int) -> None:
        """Send the latest message of a channel on which there are few."""
        made = next((item for item in self._channels if item.id() == channel), None)
        if made is not None and channel in self._latest:
            data, t_ns = self._latest[channel]
            made.log(data, log_time=t_ns)

    def refuse(self, why: str) -> None:
        """Show a viewer why a value is not taken."""
        self._server.publish_status(why, self._foxglove.StatusLevel.Error)


class _Listener:
    """What lookers-on ask for; called from threads of the server."""

    def __init__(self, live: LiveChannels) -> None:
        self._live = live
        self._trusted: set[int] = set()
        """Viewers who know the token."""

    def on_subscribe(self, client: Any, channel: Any) -> None:
        self._live.again(channel.id)

    def on_get_parameters(self, client: Any, param_names: list[str], request_id: str | None = None) -> list[Any]:
        return self._live.parameters(param_names)

    def on_set_parameters(self, client: Any, parameters: list[Any], request_id: str | None = None) -> list[Any]:
        for item in parameters:
            why = self._set(client.id, item.name, item.get_value())
            if why:
                self._live.refuse(why)
        return self._live.parameters([item.name for item in parameters])

    def _set(self, client: int, name: str, value: Any) -> str:
        """Take a value; return why it is refused, empty if it is not."""
        if name == TOKEN:
            if not secrets.compare_digest(str(value).encode(), self._live.token.encode()):
                return f"{TOKEN} is another one: it is printed where the run was started"
            self._trusted.add(client)
            return ""
        if client not in self._trusted:
            return f"{name} is not changed: set {TOKEN} first, to the word that is printed where the run was started"
        return self._live.tuning.ask(name, value, f"viewer {client}")
