"""Numbers and texts as one compact piece of text for a page: JSON and float32 arrays, deflated, base64.

Layout before deflating: uint32 length of the JSON, the JSON, then the arrays one after the other.
Each array is split into four planes (all first bytes, all second bytes...), which deflates better.
The reader is ``template/data.js``.
"""

import base64
import json
import math
import zlib
from typing import Any

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array


class Arrays:
    """The arrays of a page; equal ones are stored once."""

    def __init__(self) -> None:
        self._blocks: list[bytes] = []
        self._places: dict[bytes, int] = {}
        self.lengths: list[int] = []

    def add(self, values: Array) -> int:
        """Return the number under which the page finds ``values`` (rounded to float32, infinite beyond)."""
        with np.errstate(over="ignore"):
            single = np.ascontiguousarray(values, dtype="<f4")
        block = single.view(np.uint8).reshape(-1, 4).T.tobytes()
        if block not in self._places:
            self._places[block] = len(self._blocks)
            self._blocks.append(block)
            self.lengths.append(len(single))
        return self._places[block]

    def pack(self, header: dict[str, Any]) -> str:
        """Return ``header`` and the arrays as base64 text. Not-a-number in the header becomes null."""
        content = json.dumps({**_plain(header), "lengths": self.lengths}, allow_nan=False, separators=(",", ":"))
        data = content.encode()
        raw = len(data).to_bytes(4, "little") + data + b"".join(self._blocks)
        return base64.b64encode(zlib.compress(raw)).decode()


def _plain(value: Any) -> Any:
    """Return ``value`` with only what JSON knows: numpy numbers unpacked, infinities and NaN as null."""
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
