"""What stands between two marks of a page, ``<!-- name -->`` and ``<!-- /name -->``, and is written by a script."""

import re
from pathlib import Path


def put(page: Path, name: str, lines: list[str]) -> None:
    """Put ``lines``, and an empty line before and after them, between the marks called ``name`` of ``page``."""
    text = page.read_text(encoding="utf-8")
    made = "\n".join(["", *lines, "", ""])
    written, count = re.subn(rf"(?<=<!-- {name} -->\n).*?(?=<!-- /{name} -->)", lambda _: made, text, flags=re.S)
    if count != 1:
        raise ValueError(f"{page.name} has {count} blocks <!-- {name} --> ... <!-- /{name} -->, not one")
    page.write_text(written, encoding="utf-8")
