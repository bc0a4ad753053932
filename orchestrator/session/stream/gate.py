"""The door of a live run: lets viewers in, and no foreign page that a browser happens to show.

A browser says of which page a connection is (``Origin``); the server of the viewer protocol does not look at it. So it
listens at a loopback address that nobody can guess, and this door, at the address that is announced, looks first.
"""

import secrets
import socket
import sys
import threading
from collections.abc import Iterable
from contextlib import suppress
from urllib.parse import urlsplit

MAX_HEAD, HEAD_TIMEOUT, MAX_CONNECTIONS = 1 << 14, 5.0, 16
"""Bytes of a request [bytes], how long it may take [s], and how many viewers at a time."""
READ_BYTES = 1 << 16
VIEWERS = ("https://app.foxglove.dev", "https://studio.foxglove.dev")
"""Pages that may connect, beside those of this machine."""
LOCAL = ("127.0.0.1", "localhost", "::1")
LOCAL_SCHEMES = ("file", "app", "foxglove", "lichtblick")
"""Of viewers that are programs of this machine."""
REFUSED = b"HTTP/1.1 403 Forbidden\r\nConnection: close\r\nContent-Length: 0\r\n\r\n"


def hidden_host() -> str:
    """Return a loopback address that is hard to guess, where the system has more than one."""
    if not sys.platform.startswith("linux"):
        return LOCAL[0]
    draw = secrets.SystemRandom()
    return f"127.{draw.randint(1, 254)}.{draw.randint(0, 255)}.{draw.randint(1, 254)}"


def is_welcome(head: bytes, allowed: Iterable[str] = VIEWERS) -> bool:
    """Return whether a request is of a viewer: to this machine by its name, and of no foreign page."""
    lines = head.decode("latin-1").split("\r\n")
    if not lines[0].startswith("GET ") or not lines[0].endswith(" HTTP/1.1"):
        return False
    fields: dict[str, list[str]] = {}
    for line in lines[1:]:
        name, colon, value = line.partition(":")
        if colon:
            fields.setdefault(name.strip().lower(), []).append(value.strip())
    hosts, origins = fields.get("host", []), fields.get("origin", [])
    if len(hosts) != 1 or len(origins) > 1 or _name_of(f"//{hosts[0]}") not in LOCAL:
        return False
    if not origins or origins[0] in allowed:
        return True
    scheme = origins[0].partition(":")[0].lower()
    return scheme in LOCAL_SCHEMES or (scheme in ("http", "https") and _name_of(origins[0]) in LOCAL)


def _name_of(address: str) -> str:
    try:
        return urlsplit(address).hostname or ""
    except ValueError:
        return ""


class Gate:
    """Listens at ``host:port`` and connects those who are welcome with ``inner``. Raises ``OSError``."""

    def __init__(self, host: str, port: int, inner: tuple[str, int]) -> None:
        self._inner = inner
        self._listening = socket.create_server((host, port))
        self.port = int(self._listening.getsockname()[1])
        self._places = threading.BoundedSemaphore(MAX_CONNECTIONS)
        self._open: set[socket.socket] = set()
        threading.Thread(target=self._accept, daemon=True).start()

    def close(self) -> None:
        """Let nobody in any more, and end who is in."""
        for item in (self._listening, *list(self._open)):
            with suppress(OSError):
                item.shutdown(socket.SHUT_RDWR)
            item.close()

    def _accept(self) -> None:
        while True:
            try:
                outer, _ = self._listening.accept()
            except OSError:
                return
            if not self._places.acquire(blocking=False):
                outer.close()
                continue
            threading.Thread(target=self._serve, args=(outer,), daemon=True).start()

    def _serve(self, outer: socket.socket) -> None:
        self._open.add(outer)
        try:
            with outer, suppress(OSError):
                head = _head_of(outer)
                if not is_welcome(head):
                    outer.sendall(REFUSED)
                    return
                with socket.create_connection(self._inner, HEAD_TIMEOUT) as inner:
                    inner.settimeout(None)
                    inner.sendall(head)
                    back = threading.Thread(target=_pass_on, args=(inner, outer), daemon=True)
                    back.start()
                    _pass_on(outer, inner)
                    back.join()
        finally:
            self._open.discard(outer)
            self._places.release()


def _head_of(outer: socket.socket) -> bytes:
    """Return a request up to its empty line, and what came with it; empty if it is none in time."""
    outer.settimeout(HEAD_TIMEOUT)
    head = b""
    while b"\r\n\r\n" not in head:
        part = outer.recv(READ_BYTES)
        head += part
        if not part or len(head) > MAX_HEAD:
            return b""
    outer.settimeout(None)
    return head


def _pass_on(source: socket.socket, target: socket.socket) -> None:
    """Hand over what comes until there is nothing more, and signal the end."""
    with suppress(OSError):
        while part := source.recv(READ_BYTES):
            target.sendall(part)
    with suppress(OSError):
        target.shutdown(socket.SHUT_WR)
    with suppress(OSError):
        source.shutdown(socket.SHUT_RD)
