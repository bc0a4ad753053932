"""The planned path and the points of every system are outputs: the log, the page and the pictures have them."""

import math

import numpy as np
import pytest

from controller_fmu.registry import MODEL
from modelkit.signal import Role
from modelkit.variables import variables
from orchestrator.evaluation.verdict.geometry import find_changes, key_points, sample_path
from orchestrator.presentation.drawing.picture_data import path_plans, path_points
from orchestrator.simulation.cosim.recording import Recording
from tests.native_runs import native_recording


def driven(recording: Recording) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.column_stack([recording.signals[f"vehicle.pose.{axis}"] for axis in "xy"])


def farthest(recording: Recording) -> float:
    """Return how far the car was off its planned paths at most [m]."""
    fine = np.linspace(0.0, 1.0, 10)
    paths = np.concatenate(
        [path[:-1] + share * np.diff(path, axis=0) for path in path_plans(recording) for share in fine]
    )
    return float(np.hypot(*(driven(recording)[::20, None] - paths[None]).transpose(2, 0, 1)).min(axis=1).max())


@pytest.mark.parametrize("name", ["zhang2022", "guo2015-sine", "guo2015-case1", "adaptive"])
def test_the_car_drives_along_the_planned_path(name: str) -> None:
    recording = native_recording(name)
    assert farthest(recording) < (0.25 if name == "guo2015-case1" else 0.07)


def test_the_quintics_of_zhang_lead_from_the_start_to_the_target_in_the_final_time() -> None:
    recording = native_recording("zhang2022")
    (path,) = path_plans(recording)
    assert path[0] == pytest.approx([8.5, 2.8], abs=1e-9)
    assert path[-1] == pytest.approx([0.0, 0.0], abs=1e-9)
    values = recording.values_at("controller", len(recording.t) - 1)
    assert np.hypot(*np.diff(path, axis=0).T).sum() == pytest.approx(values["zhang2022.plan.length"], rel=1e-3)
    braking = recording.t[np.flatnonzero(recording.signals["controller.phase"] == 8)[0]]
    assert values["zhang2022.plan.final_time"] == pytest.approx(braking, rel=0.1)


def test_a_quintic_to_the_left_is_the_mirror_image() -> None:
    values = {"zhang2022.plan.side": 1.0}
    values |= {f"zhang2022.plan.origin.{key}": at for key, at in (("x", 1.0), ("y", 2.0), ("heading", np.pi / 2))}
    for number in (1, 2, 3):
        row = {"x0": 3.0 - number, "length": 1.0, "y0": 0.5, "m0": 0.1, "c2": 0.05, "c3": 0.15, "c4": 0.3, "c5": 0.4}
        values |= {f"zhang2022.plan.quintics[{number}].{key}": value for key, value in row.items()}
    right = sample_path(values)
    assert right[0] == pytest.approx([1.0 - 1.5, 2.0 + 3.0])
    left = sample_path({**values, "zhang2022.plan.side": -1.0})
    np.testing.assert_allclose(left[:, 0] - 1.0, 1.0 - right[:, 0])


def test_the_points_of_guo_are_those_of_table_2() -> None:
    points = path_points(native_recording("guo2015-case4"))
    printed = {"Q1": (-3.798, -1.522), "Q2": (-3.077, -0.830), "Q3": (-7.608, -3.056), "Q4": (-5.108, -3.056)}
    assert set(points) == set(printed)
    for name, at in printed.items():
        assert points[name] == pytest.approx(at, abs=0.02)


def test_the_points_of_hsic_lie_on_its_planned_path() -> None:
    recording = native_recording("hsic")
    points = path_points(recording)
    assert list(points) == ["P1", "P2", "P3", "P4"]
    path = path_plans(recording)[-1]
    for at in points.values():
        assert np.hypot(*(path - at).T).min() < 0.03


def test_the_planned_path_of_preview_is_its_road_and_its_points_lie_ahead() -> None:
    values = {"preview.l1": 4.5, "preview.la1.x": 4.5, "preview.la1.y": 0.0, "preview.la1.heading": 0.0}
    road = {"preview.road[1].length": 10.0, "preview.road[1].curvature": 0.0}
    road |= {"preview.road[2].length": np.pi, "preview.road[2].curvature": 0.5}
    assert sample_path(values, parameters=road)[-1] == pytest.approx([12.0, 2.0])
    assert key_points(values) == {"LA1": (4.5, 0.0)}
    assert not len(sample_path({**values, "preview.l1": 0.0}, parameters=road))


def test_the_points_of_preview_are_at_their_distances() -> None:
    recording = native_recording("preview", "stop_time=5")
    row = recording.values_at("controller", len(recording.t) - 2)
    for name, length in (("la1", "l1"), ("la2", "l2")):
        assert row[f"preview.{name}.x"] == pytest.approx(row["preview.s"] + row[f"preview.{length}"], abs=1e-6)


def test_planned_paths_are_local_outputs() -> None:
    names = {item.name: item for item in variables(MODEL.outputs)}
    for name in ("guo2015.q1.x", "hsic.p4.y", "zhang2022.plan.final_time", "preview.la1.x", "adaptive.move.end"):
        assert Role.LOCAL in names[name].roles


def test_rows_that_change_are_found_across_blocks() -> None:
    values = np.array([[0.0, math.nan], [0.0, math.nan], [1.0, math.nan], [1.0, 2.0]])
    assert find_changes(values).tolist() == [0, 2, 3]
    assert find_changes(values, values[0]).tolist() == [2, 3]
    assert find_changes(values, values[-1]).tolist() == [0, 2, 3]
