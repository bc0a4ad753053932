"""A viewer as Foxglove's WebSocket protocol has it: subscribes, keeps messages, gets and sets parameters."""

import json
import struct
import time
from collections import defaultdict
from typing import Any

from websockets import Subprotocol
from websockets.sync.client import connect

PROTOCOLS = [Subprotocol("foxglove.sdk.v1"), Subprotocol("foxglove.websocket.v1")]
MESSAGE, TIME = 1, 2


class Viewer:
    def __init__(self, address: str) -> None:
        self._context = connect(address, subprotocols=PROTOCOLS, max_size=None, open_timeout=120)
        self.socket = self._context.__enter__()
        self.channels: dict[int, dict[str, Any]] = {}
        self.messages: dict[str, list[tuple[int, bytes]]] = defaultdict(list)
        self.times: list[int] = []
        self.said: list[dict[str, Any]] = []

    def close(self) -> None:
        self._context.__exit__(None, None, None)

    def take(self) -> None:
        """Take the next frame."""
        frame = self.socket.recv(timeout=120)
        if isinstance(frame, str):
            reported = json.loads(frame)
            self.said.append(reported)
            for item in reported.get("channels", []) if reported["op"] == "advertise" else []:
                self.channels[item["id"]] = item
        elif frame[0] == MESSAGE:
            subscription, t_ns = struct.unpack_from("<IQ", frame, 1)
            self.messages[self.channels[subscription]["topic"]].append((t_ns, frame[13:]))
        elif frame[0] == TIME:
            self.times.append(struct.unpack_from("<Q", frame, 1)[0])

    def until(self, holds: Any, seconds: float = 30.0) -> None:
        end = time.monotonic() + seconds
        while not holds():
            assert time.monotonic() < end, "never came"
            self.take()

    def subscribe(self) -> None:
        """Ask for everything; the number of a subscription is that of its channel."""
        wanted = [{"id": number, "channelId": number} for number in self.channels]
        self.send(op="subscribe", subscriptions=wanted)

    def send(self, **message: Any) -> None:
        self.socket.send(json.dumps(message))

    def answers(self, op: str) -> list[dict[str, Any]]:
        return [item for item in self.said if item["op"] == op]
