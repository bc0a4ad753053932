"""Lines of C: without what nothing looks at, indented and wrapped."""

import re
import textwrap
from collections.abc import Collection, Iterator, Sequence
from typing import Any

MAX_LINE_LENGTH = 120
INDENT = "    "
LINE_BREAKS = ((", ", 2, 0), (" && ", 1, 1), (" || ", 1, 1), (" ? ", 1, 1), (" : ", 1, 1), (" = ", 3, 3)) + tuple(
    (f" {sign} ", 1, cost) for cost, signs in ((3, "+-"), (4, "*/")) for sign in signs
)
"""Where a line may be broken: at which text, how many characters of it stay before the break, and how ugly it is."""
DECLARATION = re.compile(r"(?!return )(?:const )?\w+ (?:\*|\(\*)?(\w+)\)?(?:\[\d+\])*(?: = .*)?;")
VARIABLE = re.compile(r"(?<![\w.])(?<!->)[A-Za-z_]\w*")
"""A name that is no member of a struct."""
EMPTY = (
    (re.compile(r"if \(.*\) \{"), re.compile(r"\}")),
    (re.compile(r"if \(.*\) \{"), re.compile(r"\} else \{"), re.compile(r"\}")),
    (re.compile(r"for \(.*\) \{"), re.compile(r"\}")),
)


def flat(lines: Sequence[Any]) -> Iterator[str]:
    """Yield the lines of nested lists."""
    for item in lines:
        if isinstance(item, str):
            yield item
        else:
            yield from flat(item)


def indent_and_wrap(lines: Sequence[str], depth: int = 0) -> list[str]:
    """Return lines indented by their braces and wrapped; comments and empty lines come as they are."""
    done = []
    for line in lines:
        if line.startswith(("#", "/*", " *")) or not line:
            done.append((INDENT * depth + line) if line and not line.startswith("#") else line)
            continue
        if line.startswith("}"):
            depth -= 1
        labelled = line.startswith(("case ", "default:"))
        done += wrap_line(line, INDENT * (depth - 1 if labelled else depth))
        if line.endswith("{"):
            depth += 1
    return done


def wrap_line(line: str, indent: str) -> list[str]:
    """Return one statement as lines no longer than ``MAX_LINE_LENGTH``."""
    done = []
    rest = indent + line
    while len(rest) > MAX_LINE_LENGTH:
        at = _best_break(rest, len(rest) - len(rest.lstrip()))
        if at is None:
            break
        done.append(rest[:at].rstrip())
        rest = indent + INDENT * 2 + rest[at:].lstrip()
    return [*done, rest]


def _best_break(text: str, start: int) -> int | None:
    best: tuple[float, int] | None = None
    depth = 0
    place = start
    while place < min(MAX_LINE_LENGTH, len(text)):
        character = text[place]
        depth += (character in "([{") - (character in ")]}")
        if place > start + 8:
            for mark, kept, cost in LINE_BREAKS:
                if text.startswith(mark, place) and place + kept <= MAX_LINE_LENGTH:
                    rank = (depth * 10 + cost - 0.05 * (place - start), -place)
                    if best is None or rank < best:
                        best = rank
                        found = place + kept
        place += 1
    return found if best else None


def comment(text: str, depth: int = 0) -> list[str]:
    """Return ``text`` as a C comment, paragraphs and indented lines kept."""
    safe = text.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?").rstrip()
    room = MAX_LINE_LENGTH - 4 - len(INDENT) * depth
    lines: list[str] = []
    for line in safe.splitlines():
        lines += (
            [part.rstrip() for part in textwrap.wrap(line, room, break_long_words=False) or [""]]
            if len(line) > room
            else [line.rstrip().rstrip("\\")]
        )
    if len(lines) == 1 and len(lines[0]) <= room - 4:
        return [f"/* {lines[0]} */"]
    first, *others = lines or [""]
    return [f"/* {first}", *(f" * {line}".rstrip() for line in others), " */"]


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
            for word in VARIABLE.findall(line):
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
