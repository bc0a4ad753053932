"""The icon of an FMU, drawn by code: a block with its ports and a settling response, in a colour of its name."""

import colorsys
import hashlib
import math
import struct
import zlib
from functools import lru_cache

SIZE = 96
SAMPLES = 2
Colour = tuple[int, int, int, int]
CLEAR: Colour = (255, 255, 255, 0)
EDGE: Colour = (60, 64, 72, 255)
PAPER: Colour = (250, 250, 248, 255)


@lru_cache
def icon(name: str, inputs: int, outputs: int) -> bytes:
    """Return a PNG of 96 by 96 pixels; at most five ports are drawn on a side."""
    hue = hashlib.sha256(name.encode()).digest()[0] / 256.0
    red, green, blue = (round(255 * part) for part in colorsys.hls_to_rgb(hue, 0.42, 0.65))
    ink = (red, green, blue, 255)
    rows = []
    for row in range(SIZE):
        pixels = [_pixel(row, column, ink, min(inputs, 5), min(outputs, 5)) for column in range(SIZE)]
        rows.append(b"\0" + b"".join(bytes(pixel) for pixel in pixels))
    header = struct.pack(">IIBBBBB", SIZE, SIZE, 8, 6, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(b"".join(rows), 9)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, content) for kind, content in chunks)


def _chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def _pixel(row: int, column: int, ink: Colour, inputs: int, outputs: int) -> Colour:
    """Return the mean colour of a pixel, from SAMPLES by SAMPLES points."""
    places = [(step + 0.5) / SAMPLES for step in range(SAMPLES)]
    found = [_colour((column + a) / SIZE, (row + b) / SIZE, ink, inputs, outputs) for a in places for b in places]
    opacity = sum(colour[3] for colour in found)
    if opacity == 0:
        return CLEAR
    red, green, blue = (round(sum(colour[part] * colour[3] for colour in found) / opacity) for part in range(3))
    return red, green, blue, round(opacity / len(found))


def _colour(x: float, y: float, ink: Colour, inputs: int, outputs: int) -> Colour:
    """Return the colour at (x, y), both from 0 at the top left to 1."""
    if _port(x - 0.03, y, inputs) or _port(x - 0.87, y, outputs):
        return ink
    across, down = abs(x - 0.5) - 0.29, abs(y - 0.5) - 0.34
    distance = math.hypot(max(across, 0.0), max(down, 0.0)) + min(max(across, down), 0.0)
    if distance > 0.08:
        return CLEAR
    if distance > 0.05:
        return EDGE
    along = (x - 0.24) / 0.52
    if 0.0 <= along <= 1.0:
        height = 0.72 - 0.38 * (1.0 - math.exp(-5.0 * along) * math.cos(9.0 * along))
        slope = 0.38 * math.exp(-5.0 * along) * (5.0 * math.cos(9.0 * along) + 9.0 * math.sin(9.0 * along)) / 0.52
        if abs(y - height) < 0.03 * math.hypot(1.0, slope):
            return ink
        if abs(y - 0.34) < 0.006:
            return EDGE
    return PAPER


def _port(x: float, y: float, count: int) -> bool:
    """Return whether a point lies in one of ``count`` arrow heads of width 0.1, stacked over the block's height."""
    tops = (0.5 + 0.14 * (place - (count - 1) / 2.0) for place in range(count))
    return any(0.0 <= x <= 0.10 and abs(y - top) <= 0.05 * (1.0 - x / 0.10) for top in tops)
