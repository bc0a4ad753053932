"""The overview picture is drawn for any run: parked, failed, far away, broken."""

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.image import imread
from matplotlib.transforms import Bbox

from fmus.children import LIVING
from orchestrator.evaluation.verdict.frame import in_frame
from orchestrator.evaluation.verdict.geometry import CarOutline, place, sample_path
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.presentation.drawing.figure import overview, picture
from orchestrator.presentation.drawing.panels import PANELS, Panel, PanelCurve
from orchestrator.presentation.drawing.picture_data import overview_of
from orchestrator.presentation.drawing.picture_process import PictureBeside
from tests.native_runs import drive_natively

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
    ran = drive_natively(scenario)
    file = tmp_path / "a.png"
    file.write_bytes(picture(overview_of(ran.recording, summarize(ran.recording, scenario, 1.0), scenario)))
    pixels = imread(file)
    assert pixels.shape[:2] == (1080, 1560)
    assert pixels[..., :3].std() > 0.05


def test_a_long_title_is_not_cut_off() -> None:
    scenario = load_scenario(DEMO, ["stop_time=0.01"])
    ran = drive_natively(scenario)
    seen = overview_of(ran.recording, summarize(ran.recording, scenario, 1.0), scenario)
    ends = []
    for title in ("short", "W" * 60, "W" * 150, "controller.car = {width: 1.9}, " * 9):
        figure = overview(seen._replace(title=title))
        drawn = next(text for text in figure.texts if text.get_text() == title)
        ends.append(drawn.get_window_extent().x1 / figure.bbox.width)
    assert ends[0] < 0.1
    assert 0.95 < min(ends[2:]) <= max(ends) < 1.0


@pytest.mark.parametrize("more", [0, 1, 3])
def test_no_panel_of_the_picture_covers_another(more: int) -> None:
    scenario = load_scenario(DEMO, ["stop_time=1"])
    ran = drive_natively(scenario)
    seen = overview_of(ran.recording, summarize(ran.recording, scenario, 1.0), scenario)
    added = (
        Panel(f"brake-{number}", f"Brake {number}", "1", 0.1, (PanelCurve("vehicle.speed"),), column=4 + number)
        for number in range(more)
    )
    figure = overview(seen, (*PANELS, *added))
    renderer = FigureCanvasAgg(figure).get_renderer()
    places: dict[tuple[float, ...], list[Bbox]] = {}
    for axes in figure.axes:
        box = axes.get_tightbbox(renderer)
        assert box is not None
        places.setdefault(tuple(round(end, 6) for end in axes.get_position().bounds), []).append(Bbox(box.get_points()))
    columns = {place: Bbox.union(boxes) for place, boxes in places.items()}
    assert len(columns) == 1 + 3 + more
    twice = [one for one, other in combinations(columns.values(), 2) if Bbox.intersection(one, other) is not None]
    assert twice == []
    titles = [axes.get_title("left") for axes in figure.axes if axes.get_title("left")]
    assert [title[:3] for title in sorted(titles)] == [f"({letter})" for letter in "abcdefg"[: 4 + more]]


def test_no_legend_covers_a_title() -> None:
    scenario = load_scenario(DEMO, ["stop_time=1"])
    ran = drive_natively(scenario)
    figure = overview(overview_of(ran.recording, summarize(ran.recording, scenario, 1.0), scenario))
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw(renderer)
    titles = [axes._left_title.get_window_extent(renderer) for axes in figure.axes if axes.get_title("left")]  # type: ignore[attr-defined]
    legends = [legend.get_window_extent(renderer) for axes in figure.axes if (legend := axes.get_legend())]
    assert len(legends) == 4
    assert not any(title.overlaps(legend) for title in titles for legend in legends)


def test_a_signal_that_hardly_changes_has_the_least_span_of_its_panel() -> None:
    scenario = load_scenario(DEMO, ["stop_time=1"])
    ran = drive_natively(scenario)
    panel = Panel("brake", "Brake", "1", 0.5, (PanelCurve("vehicle.pose.heading"),), column=1)
    seen = overview_of(ran.recording, summarize(ran.recording, scenario, 1.0), scenario)
    axes = next(item for item in overview(seen, (panel,)).axes if item.get_title("left") == "(a) brake")
    low, high = axes.get_ylim()
    assert high - low == pytest.approx(0.5)


def test_a_process_beside_draws_the_same() -> None:
    scenario = load_scenario(DEMO, ["stop_time=1"])
    ran = drive_natively(scenario)
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
