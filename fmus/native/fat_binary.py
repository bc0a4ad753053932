"""Two Mac libraries in one file: the "universal binary" that Intel and Apple processors both load."""

import struct
from collections.abc import Sequence

FAT_MAGIC = 0xCAFEBABE
SLICE_ALIGNMENT_BITS = 14
"""Slices start at multiples of 2^14 bytes, the page size of Apple processors."""


def fat_binary(slices: Sequence[bytes]) -> bytes:
    """Return the fat Mach-O file of ``slices``, each a 64-bit Mach-O file for another processor.

    Header, all big-endian: magic, count; then per slice: processor, its subtype, offset, size, alignment.
    """
    step = 1 << SLICE_ALIGNMENT_BITS
    header = struct.pack(">II", FAT_MAGIC, len(slices))
    at, body = step, b""
    for piece in slices:
        magic, processor, subtype = struct.unpack_from("<III", piece)
        if magic != 0xFEEDFACF:
            raise ValueError(f"a slice starts with {magic:#x}, not as a 64-bit Mach-O file")
        header += struct.pack(">IIIII", processor, subtype, at, len(piece), SLICE_ALIGNMENT_BITS)
        padded = piece + bytes(-len(piece) % step)
        body += padded
        at += len(padded)
    return header.ljust(step, b"\0") + body
