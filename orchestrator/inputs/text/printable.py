"""Text of third parties without the characters that a terminal obeys."""

import re

CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
"""C0 but line feed and tab, delete, C1, and what turns the direction of writing."""


def printable(text: str) -> str:
    """Return a text in which control characters are written as numbers: ``\\x1b``."""
    return CONTROL.sub(lambda found: _number(ord(found[0])), text)


def readable(name: str) -> str:
    """Return the name of a file with a question mark in place of each byte that is no UTF-8, so it can be written."""
    return name.encode(errors="surrogateescape").decode(errors="replace")


def is_printable(text: str) -> bool:
    """Return whether a text is one line without control characters."""
    return CONTROL.search(text) is None and "\n" not in text and "\t" not in text


def _number(code: int) -> str:
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"
