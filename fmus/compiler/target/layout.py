"""Lines of C indented and wrapped."""

import textwrap
from collections.abc import Iterator, Sequence
from typing import Any

WIDTH = 120
INDENT = "    "
BREAKS = ((", ", 2, 0), (" && ", 1, 1), (" || ", 1, 1), (" ? ", 1, 1), (" : ", 1, 1), (" = ", 3, 3)) + tuple(
    (f" {sign} ", 1, cost) for cost, signs in ((3, "+-"), (4, "*/")) for sign in signs
)
"""Where a line may be broken: at which text, how many characters of it stay before the break, and how ugly it is."""


def flat(lines: Sequence[Any]) -> Iterator[str]:
    """Yield the lines of nested lists."""
    for item in lines:
        if isinstance(item, str):
            yield item
        else:
            yield from flat(item)


def laid_out(lines: Sequence[str], depth: int = 0) -> list[str]:
    """Return lines indented by their braces and wrapped; comments and empty lines come as they are."""
    done = []
    for line in lines:
        if line.startswith(("#", "/*", " *")) or not line:
            done.append((INDENT * depth + line) if line and not line.startswith("#") else line)
            continue
        if line.startswith("}"):
            depth -= 1
        labelled = line.startswith(("case ", "default:"))
        done += wrapped(line, INDENT * (depth - 1 if labelled else depth))
        if line.endswith("{"):
            depth += 1
    return done


def wrapped(line: str, indent: str) -> list[str]:
    """Return one statement as lines no longer than ``WIDTH``."""
    done = []
    rest = indent + line
    while len(rest) > WIDTH:
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
    while place < min(WIDTH, len(text)):
        character = text[place]
        depth += (character in "([{") - (character in ")]}")
        if place > start + 8:
            for mark, kept, cost in BREAKS:
                if text.startswith(mark, place) and place + kept <= WIDTH:
                    rank = (depth * 10 + cost - 0.05 * (place - start), -place)
                    if best is None or rank < best:
                        best = rank
                        found = place + kept
        place += 1
    return found if best else None


def comment(text: str, depth: int = 0) -> list[str]:
    """Return ``text`` as a C comment, paragraphs and indented lines kept."""
    safe = text.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?").rstrip()
    room = WIDTH - 4 - len(INDENT) * depth
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
