"""The overview picture is drawn for any run: parked, failed, far away, broken."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from fmus.children import LIVING
from orchestrator.drawing.beside import PictureBeside
from orchestrator.drawing.figure import overview, picture
from orchestrator.drawing.seen import overview_of
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario
from orchestrator.verdict.frame import in_frame
from orchestrator.verdict.geometry import CarOutline, place, sample_path
from orchestrator.verdict.summary import summarize

DEMO = str(Path(__file__).with_name("demo.yaml"))


@pytest.mark.parametrize(
    "sets",
    [
        ["stop_time=8"],
        ["stop_time=8", "vehicle.start=[1e4, -2e4, 200 deg]", "target=[1e4, -2e4, 200 deg]"],
        ["stop_time=1", "faults=[{signal: vehicle.odometry.x, kind: override, value: nan, start: 0.5}]"],
        ["stop_time=0.01"],
    ],
)
def test_a_picture_of_any_run(tmp_path: Path, sets: list[str]) -> None:
    scenario = load_scenario(DEMO, sets)
    ran = run_scenario(scenario)
    file = tmp_path / "a.png"
    file.write_bytes(picture(overview_of(ran.recording, summarize(ran.recording, scenario, 1.0), scenario)))
    pixels = imread(file)
    assert pixels.shape[:2] == (1080, 1560)
    assert pixels[..., :3].std() > 0.05


def test_a_long_title_is_not_cut_off() -> None:
    scenario = load_scenario(DEMO, ["stop_time=0.01"])
    ran = run_scenario(scenario)
    seen = overview_of(ran.recording, summarize(ran.recording, scenario, 1.0), scenario)
    ends = []
    for title in ("short", "W" * 60, "W" * 150, "controller.car = {width: 1.9}, " * 9):
        figure = overview(seen._replace(title=title))
        drawn = next(text for text in figure.texts if text.get_text() == title)
        ends.append(drawn.get_window_extent().x1 / figure.bbox.width)
    assert ends[0] < 0.1
    assert 0.95 < min(ends[2:]) <= max(ends) < 1.0


def test_a_process_beside_draws_the_same() -> None:
    scenario = load_scenario(DEMO, ["stop_time=1"])
    ran = run_scenario(scenario)
    seen = overview_of(ran.recording, summarize(ran.recording, scenario, 1.0), scenario)
    with PictureBeside() as beside:
        beside.begin(seen)
        drawn = beside.picture()
    assert drawn == picture(seen)
    assert not LIVING


def test_what_goes_wrong_beside_is_told() -> None:
    with PictureBeside() as beside:
        beside.begin("no picture")  # type: ignore[arg-type]
        with pytest.raises(RuntimeError, match=r"(?s)the picture was not drawn.*'str' object"):
            beside.picture()


def test_nobody_is_left_of_a_picture_that_nobody_wants() -> None:
    with PictureBeside() as beside:
        child = beside._child
        assert child in LIVING
    assert child.returncode is not None
    assert not LIVING


def test_the_sampled_path_ends_where_two_arcs_do() -> None:
    values = {"path.start.x": 0.0, "path.start.y": 0.0, "path.start.heading": 0.0}
    angle = np.arcsin(3.804 / 5.5)
    for number, curvature in ((1, -1 / 5.5), (2, 1 / 5.5)):
        values[f"path.segments[{number}].length"] = 5.5 * angle
        values[f"path.segments[{number}].curvature"] = curvature
    end = sample_path(values)[-1]
    assert end == pytest.approx([-2 * 3.804, -2 * 5.5 * (1 - np.cos(angle))], abs=1e-12)
    assert sample_path({}).shape == (0, 2)


def test_frames_go_there_and_back() -> None:
    points = CarOutline.of(
        {"car.wheelbase": 2.4, "car.front_overhang": 0.8, "car.rear_overhang": 0.6, "car.width": 1.6}
    ).outline()
    assert points.min(axis=0).tolist() == [-0.6, -0.8]
    assert points.max(axis=0) == pytest.approx([3.2, 0.8])
    x, y = place(points[:1], 5.0, 6.0, 2.0)[0]
    assert in_frame(x, y, 2.5, (5.0, 6.0, 2.0)) == pytest.approx((*points[0], 0.5))
