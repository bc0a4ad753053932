"""State charts as pictures: what is written can be read."""

import re
from typing import Any
from xml.etree import ElementTree

import pytest

from orchestrator.inputs.scenario.models import MODELS, apart_models
from orchestrator.presentation.drawing.chart_svg import chart_svg
from orchestrator.presentation.report.charts import charts_of_models

LETTER = 6.0
"""Mean width of a letter at 12 px."""
CHARTS = [
    pytest.param(data, id=data["file"]) for _, data in charts_of_models([*MODELS.values(), *apart_models().values()])
]


def boxes(svg: str) -> list[tuple[float, float, float, float]]:
    found = []
    for node in ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text"):
        wide, x, y = LETTER * len(node.text or ""), float(node.attrib["x"]), float(node.attrib["y"])
        left = {"start": x, "end": x - wide, "middle": x - 0.5 * wide}[node.attrib["text-anchor"]]
        found.append((left, y - 9.0, left + wide, y + 1.0))
    return found


@pytest.mark.parametrize("chart", CHARTS)
def test_no_label_covers_another_and_all_are_inside(chart: Any) -> None:
    texts = boxes(chart["svg"])
    for number, (left, top, right, bottom) in enumerate(texts):
        for other in texts[:number]:
            assert min(right, other[2]) <= max(left, other[0]) or min(bottom, other[3]) <= max(top, other[1])
    x, y, width, height = map(float, re.findall(r'viewBox="([-\d.]+) ([-\d.]+) ([-\d.]+) ([-\d.]+)"', chart["svg"])[0])
    assert min(box[0] for box in texts) >= x
    assert max(box[2] for box in texts) <= x + width
    assert max(box[3] for box in texts) <= y + height
    assert width <= 720.0


def test_rows_for_any_state_are_arrows_at_their_target() -> None:
    svg = chart_svg([("IDLE", "RUN", "start"), ("any state", "LOST", "fault")], ["IDLE", "RUN", "LOST"])
    assert 'data-state="any state"' not in svg
    assert 'data-from="any state" data-to="LOST" data-guards="fault"' in svg
    assert ">any state: fault<" in svg
