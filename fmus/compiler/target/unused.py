"""Lines of a C function without what nothing looks at: a part of a value that was worked out and is not needed."""

import re
from collections.abc import Collection

DECLARATION = re.compile(r"(?!return )(?:const )?\w+ (?:\*|\(\*)?(\w+)\)?(?:\[\d+\])*(?: = .*)?;")
EMPTY = (
    (re.compile(r"if \(.*\) \{"), re.compile(r"\}")),
    (re.compile(r"if \(.*\) \{"), re.compile(r"\} else \{"), re.compile(r"\}")),
    (re.compile(r"for \(.*\) \{"), re.compile(r"\}")),
)


def without_unused(lines: list[str], kept_calls: Collection[str] = ()) -> list[str]:
    """Return the lines without variables that are never read, and without blocks that do nothing then.

    Lines with a call of one of ``kept_calls`` stay: the function does more than to give its result.
    """
    while True:
        kept = _without_unread(lines, kept_calls)
        if len(kept) == len(lines):
            return lines
        lines = _without_empty_blocks(kept)


def _without_unread(lines: list[str], kept_calls: Collection[str]) -> list[str]:
    mentions: dict[str, list[int]] = {}
    for place, line in enumerate(lines):
        if not line.startswith("/*"):
            for word in re.findall(r"[A-Za-z_]\w*", line):
                mentions.setdefault(word, []).append(place)
    dropped: set[int] = set()
    for place, line in enumerate(lines):
        match = DECLARATION.fullmatch(line)
        if match:
            others = list(mentions[match[1]])
            others.remove(place)
            written = all(others.count(other) == 1 and _is_store(lines[other], match[1]) for other in others)
            if written and not any(_calls(lines[item], kept_calls) for item in (place, *others)):
                dropped |= {place, *others}
    return [line for place, line in enumerate(lines) if place not in dropped]


def _calls(line: str, names: Collection[str]) -> bool:
    return bool(names) and any(word in names for word in re.findall(r"([A-Za-z_]\w*)\(", line))


def _is_store(line: str, name: str) -> bool:
    return re.match(rf"{name}(?:[.\[][^=]*)? = ", line) is not None


def _without_empty_blocks(lines: list[str]) -> list[str]:
    place = 0
    lines = list(lines)
    while place < len(lines):
        for shape in EMPTY:
            part = lines[place : place + len(shape)]
            if len(part) == len(shape) and all(one.fullmatch(line) for one, line in zip(shape, part, strict=True)):
                del lines[place : place + len(shape)]
                place = max(place - 3, -1)
                break
        place += 1
    return lines
