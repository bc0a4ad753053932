"""The tables of ports and sizes in the docs are those of the models."""

import re
from typing import Any

import pytest

from fmus.native import fmu as native_fmu
from fmus.native.compilers import can_compile
from fmus.native.platforms import host, is_known
from tests.docs.scripts import DOCS, script

SIZE_TOLERANCE = 0.1
"""Share by which a size may differ from the one stated: it changes with every line of a model."""


def block(page: str, name: str) -> str:
    """Return what stands between the two marks called ``name`` of a page."""
    (found,) = re.findall(rf"<!-- {name} -->\n(.*?)<!-- /{name} -->", (DOCS / page).read_text("utf-8"), re.S)
    return str(found)


def test_ports_are_as_the_page_says() -> None:
    stated = block("use-in-your-tool.md", "ports").split("\n")
    assert [line for line in stated if line] == script("ports").ports(), "run docs/ports.py"


@pytest.mark.skipif(not can_compile() or not is_known() or host() != "linux64", reason="needs a C compiler, linux64")
def test_sizes_are_as_the_page_says(tmp_path: Any) -> None:
    ports = script("ports")
    rows = [line.split("|")[1:-1] for line in block("targets.md", "sizes").strip().splitlines()[2:]]
    stated = {cells[0].strip(" `"): [float(cell) for cell in cells[1:]] for cells in rows}
    assert stated.keys() == {model.name for model in ports.LARGE}
    vehicle = ports.LARGE[0]
    library, fmu, frame = ports.sizes_of(native_fmu.build(vehicle, tmp_path, ["linux64"]), vehicle)
    assert [library / 1e3, fmu / 1e3, frame] == pytest.approx(stated["Vehicle"], rel=SIZE_TOLERANCE), (
        "run docs/ports.py"
    )


@pytest.mark.release
@pytest.mark.skipif(not can_compile() or not is_known() or host() != "linux64", reason="needs a C compiler, linux64")
def test_all_sizes_are_as_the_page_says(tmp_path: Any) -> None:
    stated = block("targets.md", "sizes").strip().splitlines()
    for line, found in zip(stated, script("ports").sizes(tmp_path), strict=True):
        numbers, expected = (list(map(float, re.findall(r"\d+(?= \|)", text))) for text in (line, found))
        assert numbers == pytest.approx(expected, rel=SIZE_TOLERANCE), "run docs/ports.py"
