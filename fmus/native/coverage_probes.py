"""Where a model's charts decide, in its C: a line there tells a host that looks on what they decide on.

For ``c/live.c`` alone; all other C of a model is without it.
"""

import re
from collections.abc import Sequence

from modelkit.model import Chart

DECLARED = """#include <stdint.h>
void live_decides(int32_t chart, int64_t state, int64_t guards);
"""
SECTION = re.compile(r"^(?=/\* -{8} )", re.MULTILINE)
"""Where the part of the C begins that a Python file has become: its name is in the first line."""
DECIDER = re.compile(r"\(int64_t (\w+),[^;{}]*\bint64_t guards\b[^;{}]*\)\n\{\n")
"""The beginning of a function that takes a state and, later, the guards as bits: it is named so in each chart."""


def instrument(source: str, charts: Sequence[Chart], first: int) -> str:
    """Return the C of a model in which each of its charts tells what it decides on, numbered from ``first`` on."""
    numbers = {_file(chart): number for number, chart in enumerate(charts, first)}
    return "".join(_probe(section, numbers.get(_title(section), -1)) for section in SECTION.split(source))


def _file(chart: Chart) -> str:
    return f"{chart.guards.__module__.replace('.', '/')}.py"


def _title(section: str) -> str:
    return section.split(" ", 3)[2] if section.startswith("/* --------") else ""


def _probe(section: str, number: int) -> str:
    return section if number < 0 else DECIDER.sub(rf"\g<0>    live_decides({number}, \1, guards);\n", section)
