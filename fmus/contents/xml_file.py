"""XML as this project writes it into files: indented, in UTF-8, with a declaration."""

from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element


def xml_bytes(root: Element) -> bytes:
    """Return the content of the file whose outermost element is ``root``."""
    ElementTree.indent(root)
    content: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    return content + b"\n"


def as_text(value: Any) -> str:
    """Return a number or truth value as XML has it; floats with all their digits."""
    return str(value).lower() if isinstance(value, bool) else repr(value)
