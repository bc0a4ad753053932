"""Damaged and forged logs and tables: what is damaged is not believed, what is forged takes no command down."""

import json
import random
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import Channel, McapRecord, Metadata

from orchestrator.presentation.log.records import (
    CHUNK,
    HEAD,
    MESSAGE,
    chunk_records,
    parse_record,
    read_record,
    record_heads,
)
from tests.fuzz.inputs import VALUES
from tests.fuzz.limits import ask

MAGIC = b"\x89MCAP0\r\n"
METADATA, CHUNK_CODE, CHANNEL, MESSAGE_CODE, MESSAGE_INDEX, DATA_END = 12, 6, 4, 5, 7, 15


def damaged(data: bytes, draw: random.Random) -> bytes:
    """Return a file with something wrong that no checksum can miss."""
    size, way = len(data), draw.randrange(7)
    at = draw.randrange(size)
    if way <= 1:
        return data[:at] + bytes([data[at] ^ 1 << draw.randrange(8)]) + data[at + 1 :]
    if way == 2:
        return data[:at]
    if way == 3:
        return data[:at] + bytes(draw.randrange(1, 5000)) + data[at:]
    if way == 4:
        return data[:at] + data[at + draw.randrange(1, 5000) :]
    if way == 5:
        return data[:at] + draw.randbytes(draw.randrange(1, 300)) + data[at + 200 :]
    return data[:at] + struct.pack("<Q", draw.choice((0, 1 << 20, 1 << 40, (1 << 64) - 1))) + data[at + 8 :]


def retold(data: bytes, key: str, text: str) -> bytes:
    """Return a file whose description of the run says something else, as tools of others may write it."""
    out = MAGIC
    for piece in (read_record(data, head) for head in record_heads(data)):
        body = bytes(piece.body)
        if piece.opcode == METADATA:
            record = parse_record(Metadata, piece)
            kept = {name: reported for name, reported in record.metadata.items() if name != "checksum"}
            body = _body(Metadata(name=record.name, metadata={**kept, key: text} if record.name == "apa" else kept))
        if piece.opcode == DATA_END:
            break
        if piece.opcode != MESSAGE_INDEX:
            out += HEAD.pack(piece.opcode, len(body)) + body
    return ended(out)


def ended(data: bytes) -> bytes:
    """Return records with the end of a file without index behind them."""
    data += HEAD.pack(DATA_END, 4) + struct.pack("<I", zlib.crc32(data))
    return data + HEAD.pack(2, 20) + bytes(20) + MAGIC


def forged(data: bytes, draw: random.Random) -> bytes:
    """Return a file whose checksums are right and whose content is not."""
    out = MAGIC
    for piece in (read_record(data, head) for head in record_heads(data)):
        body = bytes(piece.body)
        if piece.opcode == DATA_END:
            break
        if piece.opcode == METADATA and draw.random() < 0.7:
            body = _metadata(parse_record(Metadata, piece), draw)
        elif piece.opcode == CHUNK_CODE and draw.random() < 0.5:
            body = _chunk([(item.opcode, bytes(item.body)) for item in chunk_records(piece)], draw)
        elif piece.opcode == MESSAGE_INDEX:
            continue
        out += HEAD.pack(piece.opcode, len(body)) + body
    return ended(out)


def _metadata(record: Metadata, draw: random.Random) -> bytes:
    texts = {key: text for key, text in record.metadata.items() if key != "checksum"}
    key = draw.choice(list(texts))
    texts[key] = _json(texts[key], draw)
    return _body(Metadata(name=record.name, metadata=texts))


def _json(text: str, draw: random.Random) -> str:
    """Return JSON with another value somewhere, or no JSON."""
    odd: list[Any] = [1e308, -1, 10**400, None, [], {}, "", "x" * 300, True, "\ud800", [[]] * 50, {"a": 1}]
    odd.append(draw.choice(VALUES))
    if draw.random() < 0.2:
        return draw.choice(["", "{", "[" * 5000, "nan", text[: len(text) // 2], "1" * 6000])
    content = json.loads(text)
    node, path = content, None
    while isinstance(node, dict | list) and node:
        path = node, draw.choice(list(node)) if isinstance(node, dict) else draw.randrange(len(node))
        if draw.random() < 0.3:
            break
        node = node[path[1]]
    if path is None:
        return json.dumps(draw.choice(odd[:-1]) if draw.random() < 0.9 else "x")
    path[0][path[1]] = draw.choice(odd)
    try:
        return json.dumps(content)
    except ValueError:
        return "null"


def _chunk(records: list[tuple[int, bytes]], draw: random.Random) -> bytes:
    way, at = draw.randrange(8), draw.randrange(len(records))
    opcode, body = records[at]
    if way == 0:
        del records[at]
    elif way == 1:
        records.insert(at, (draw.randrange(1, 20), draw.randbytes(draw.randrange(60))))
    elif way == 2:
        records[at] = opcode, body[: draw.randrange(len(body) + 1)]
    elif way == 3 and opcode == MESSAGE_CODE:
        head = list(MESSAGE.unpack_from(body))
        head[draw.choice((0, 2))] = draw.choice((0, 7, 65535))
        records[at] = opcode, MESSAGE.pack(*head) + body[MESSAGE.size :]
    elif way <= 5:
        places = [place for place, item in enumerate(records) if item[0] == CHANNEL]
        if places:
            place = draw.choice(places)
            channel = _channel(records[place][1])
            described = {key: _json(text, draw) for key, text in channel.metadata.items()}
            records[place] = CHANNEL, _body(Channel(**{**vars(channel), "metadata": described}))
    elif way == 6:
        records = [(opcode, body)] * draw.choice((2, 1000))
    data = b"".join(HEAD.pack(code, len(item)) + item for code, item in records)
    if way == 7:
        data = bytes(draw.choice((1 << 20, 1 << 25, 1 << 27)))
    packed = zstandard.ZstdCompressor().compress(data)
    said = draw.choice((len(data), len(data), len(data), 1, 1 << 62))
    header = CHUNK.pack(0, 0, said, zlib.crc32(data), 4) + b"zstd"
    return header + struct.pack("<Q", len(packed)) + packed


def _channel(body: bytes) -> Channel:
    import io

    from mcap.data_stream import ReadDataStream

    return Channel.read(ReadDataStream(io.BytesIO(body)))


def _body(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return builder.end()[HEAD.size :]


def fuzz(folder: Path, log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """Try one damaged log after the other without end; yield the words and what was wrong, empty if nothing."""
    data = log.read_bytes()
    table = log.with_name("table.parquet")
    rows = table.read_bytes() if table.is_file() else b""
    odd, out = folder / "odd.mcap", folder / "out"
    out.mkdir(exist_ok=True)
    while True:
        if rows and draw.random() < 0.15:
            (folder / "odd.parquet").write_bytes(damaged(rows, draw))
            words = ["replay", str(folder / "odd.parquet"), "--row", "1", "--no-page", "--out", str(out)]
            yield words, ask(words).mistake
            continue
        honest = draw.random() < 0.5
        content = damaged(data, draw) if honest else forged(data, draw)
        odd.write_bytes(content)
        words = draw.choice(
            (
                ["check", str(odd), "project"],
                ["report", str(odd), "--out", str(out / "page.html")],
                ["compare", str(log), str(odd)],
                ["export", "csv", str(odd), "--out", str(out / "table.csv")],
                ["recover", str(odd)],
            )
        )
        answer = ask(words)
        mistake = answer.mistake
        if not mistake and honest and content != data and words[0] != "recover" and answer.code != 2:
            mistake = f"a damaged log is believed: code {answer.code}"
        for left in folder.glob("odd.recovered*"):
            left.unlink()
        yield words, mistake
