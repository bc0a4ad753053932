"""docs/tables/embedded.md: what does not depend on the machine is as the page says; how its script counts."""

import struct
import sys
from typing import Any

import pytest

from fmus.native.compilers import can_compile
from tests.docs.scripts import DOCS, script

PAGE = (DOCS / "tables" / "embedded.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def embedded() -> Any:
    return script("embedded")


@pytest.mark.skipif(not can_compile() or sys.maxsize < 2**32, reason="needs a C compiler, 64 bits")
def test_memory_is_as_the_page_says(embedded: Any) -> None:
    assert "\n".join(embedded.memory()) in PAGE, "run docs/embedded.py"


def test_depth_is_the_deepest_way_through_the_calls(embedded: Any) -> None:
    sizes = {"step": 100, "a": 30, "b": 20, "c": 50}
    calls = [("step", "a"), ("step", "b"), ("b", "c"), ("a", "sin"), ("step", "b")]
    graph = "".join(f'node: {{ title: "{n}" label: "{n}\\nX.c:1:2\\n{s} bytes (static)" }}\n' for n, s in sizes.items())
    graph += "".join(f'edge: {{ sourcename: "{a}" targetname: "{b}" label: "X.c:3:4" }}\n' for a, b in calls)
    assert embedded.deepest(graph) == {"step": 170, "a": 30, "b": 70, "c": 50, "sin": 0}


def test_sections_are_summed_by_what_they_hold(embedded: Any) -> None:
    kinds = [(1, 6, 400), (1, 2, 30), (1, 3, 8), (8, 3, 64), (1, 0, 999)]
    wide = b"\x7fELF\x02" + bytes(0x28 - 5) + struct.pack("<Q", 64) + bytes(10) + struct.pack("<HH", 64, len(kinds))
    wide = wide.ljust(64, b"\0")
    for kind, flags, size in kinds:
        wide += struct.pack("<IIQQQQ", 0, kind, flags, 0, 0, size).ljust(64, b"\0")
    assert embedded.sections(wide) == (400, 30, 8, 64)


def test_a_table_is_replaced_and_the_rest_stays(embedded: Any) -> None:
    page = "a\n<!-- size -->\n\n| old |\n|---|\n\nb\n"
    assert embedded.replaced(page, "size", ["| new |", "|---|"]) == "a\n<!-- size -->\n\n| new |\n|---|\n\nb\n"
    assert embedded.replaced("a\n<!-- size -->\n\nb\n", "size", ["| x |"]) == "a\n<!-- size -->\n\n| x |\n\nb\n"


def test_every_table_is_there() -> None:
    for name in ("memory", "stack", "size", "time", "misra"):
        assert f"<!-- {name} -->\n\n| " in PAGE, name
