"""What a 64-bit little-endian ELF library needs and what it asks of others, read from its dynamic section."""

import struct
from typing import Any

NEEDED, STRING_TABLE, SYMBOL_TABLE = 1, 5, 6


def dynamic(content: Any) -> Any:
    """Return (names of needed libraries, names of undefined symbols, names of defined symbols)."""
    assert content[:6] == b"\x7fELF\x02\x01"
    (headers,) = struct.unpack_from("<Q", content, 0x20)
    size, count = struct.unpack_from("<HH", content, 0x36)
    segments = [struct.unpack_from("<IIQQQQQQ", content, headers + k * size) for k in range(count)]

    def offset(address: Any) -> Any:
        for kind, _, at, virtual, _, length, _, _ in segments:
            if kind == 1 and virtual <= address < virtual + length:
                return at + address - virtual
        raise ValueError(hex(address))

    (begin, length) = next((s[2], s[5]) for s in segments if s[0] == 2)
    entries = [struct.unpack_from("<QQ", content, begin + k) for k in range(0, length, 16)]
    values = dict(entries)
    strings, symbols = offset(values[STRING_TABLE]), offset(values[SYMBOL_TABLE])

    def text(at: Any) -> Any:
        return content[strings + at : content.index(b"\0", strings + at)].decode()

    needed = [text(value) for tag, value in entries if tag == NEEDED]
    undefined: list[str] = []
    defined: list[str] = []
    for place in range(symbols + 24, min(strings, len(content)) if strings > symbols else len(content), 24):
        name, info, _, section = struct.unpack_from("<IBBH", content, place)
        if info >> 4 not in (1, 2):
            break
        (defined if section else undefined).append(text(name))
    return needed, undefined, defined
