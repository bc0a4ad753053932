"""The icon of an FMU, generated: a block with its ports and a settling response, in a colour of its name."""

import colorsys
import hashlib
import struct
import zlib
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

ICON_PIXELS = 96
SAMPLES_PER_PIXEL = 2
CLEAR = (255.0, 255.0, 255.0, 0.0)
EDGE = (60.0, 64.0, 72.0, 255.0)
PAPER = (250.0, 250.0, 248.0, 255.0)
"""Red, green, blue and opacity, 0 to 255."""
Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@lru_cache
def icon(name: str, inputs: int, outputs: int) -> bytes:
    """Return a PNG of 96 by 96 pixels; at most five ports are drawn on a side."""
    hue = hashlib.sha256(name.encode()).digest()[0] / 256.0
    red, green, blue = (round(255 * part) for part in colorsys.hls_to_rgb(hue, 0.42, 0.65))
    pixels = _average(_points((red, green, blue, 255.0), min(inputs, 5), min(outputs, 5)))
    header = struct.pack(">IIBBBBB", ICON_PIXELS, ICON_PIXELS, 8, 6, 0, 0, 0)
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows, 9)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, content) for kind, content in chunks)


def _chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def _average(points: Array) -> NDArray[np.uint8]:
    """Return the mean colour of each pixel, shape (SIZE, SIZE, 4), from its SAMPLES by SAMPLES points."""
    cells = (
        points.reshape(ICON_PIXELS, SAMPLES_PER_PIXEL, ICON_PIXELS, SAMPLES_PER_PIXEL, 4)
        .swapaxes(1, 2)
        .reshape(ICON_PIXELS, ICON_PIXELS, SAMPLES_PER_PIXEL * SAMPLES_PER_PIXEL, 4)
    )
    opacity = cells[..., 3:].sum(axis=2)
    mean = (cells[..., :3] * cells[..., 3:]).sum(axis=2) / np.maximum(opacity, 1.0)
    colour = np.where(opacity > 0.0, mean, CLEAR[:3])
    pixels: NDArray[np.uint8] = np.rint(np.concatenate([colour, opacity / SAMPLES_PER_PIXEL**2], axis=2)).astype(
        np.uint8
    )
    return pixels


def _points(ink: tuple[float, ...], inputs: int, outputs: int) -> Array:
    """Return the colour of each point, rows from the top, shape (SIZE * SAMPLES, SIZE * SAMPLES, 4)."""
    places = (np.arange(ICON_PIXELS * SAMPLES_PER_PIXEL) + 0.5) / (ICON_PIXELS * SAMPLES_PER_PIXEL)
    x, y = np.meshgrid(places, places)
    across, down = np.abs(x - 0.5) - 0.29, np.abs(y - 0.5) - 0.34
    distance = np.hypot(np.maximum(across, 0.0), np.maximum(down, 0.0)) + np.minimum(np.maximum(across, down), 0.0)
    along = (x - 0.24) / 0.52
    fade, turn = 0.38 * np.exp(-5.0 * along), 9.0 * along
    height = 0.34 + fade * np.cos(turn)
    slope = fade * (5.0 * np.cos(turn) + 9.0 * np.sin(turn)) / 0.52
    inside = (along >= 0.0) & (along <= 1.0)
    layers = (
        (_ports(x - 0.03, y, inputs) | _ports(x - 0.87, y, outputs), ink),
        (distance > 0.08, CLEAR),
        (distance > 0.05, EDGE),
        (inside & (np.abs(y - height) < 0.03 * np.hypot(1.0, slope)), ink),
        (inside & (np.abs(y - 0.34) < 0.006), EDGE),
    )
    colours = [np.array(colour) for _, colour in layers]
    points: Array = np.select([mask[..., None] for mask, _ in layers], colours, np.array(PAPER))
    return points


def _ports(x: Array, y: Array, count: int) -> Mask:
    """Return which points lie in one of ``count`` arrow heads of width 0.1, stacked over the block's height."""
    tops = (0.5 + 0.14 * (place - (count - 1) / 2.0) for place in range(count))
    half = 0.05 * (1.0 - x / 0.10)
    heads: Mask = np.any([np.zeros_like(x, bool), *(np.abs(y - top) <= half for top in tops)], axis=0)
    return heads & (x >= 0.0) & (x <= 0.10)
