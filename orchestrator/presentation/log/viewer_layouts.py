"""The layouts in ``orchestrator/library/layouts`` for MCAP viewers; run as a module it writes them anew.

Foxglove and Lichtblick read the same format and differ in the key of a panel's title.
"""

import json
from pathlib import Path
from typing import Any

from orchestrator.inputs.scenario.files import LIBRARY
from orchestrator.presentation.drawing.panels import MODES, PANELS

LAYOUT_FOLDER = LIBRARY / "layouts"
TITLES = {"foxglove": "foxglovePanelTitle", "lichtblick": "lichtblickPanelTitle"}
DRAWN = ("/scene", "/path", "/trail")


def layout(viewer: str) -> dict[str, Any]:
    """Return the layout for ``foxglove`` or ``lichtblick``."""
    title = TITLES[viewer]
    panels: dict[str, dict[str, Any]] = {
        "3D!top": {title: "Top view", **_top_view()},
        "StateTransitions!states": {title: "States", "paths": [_path(name) for name in MODES], "isSynced": True},
        "RosOut!log": {title: "Messages", "topicToRender": "/log", "minLogLevel": 1, "searchTerms": []},
        "RawMessages!parameters": {title: "Parameters", "topicPath": "/controller/parameters"},
    }
    plots = []
    for number, panel in enumerate(PANELS, start=1):
        plots.append(f"Plot!{number}")
        panels[plots[-1]] = {title: f"{panel.title} [{panel.unit}]", **_plot(panel.page_signals())}
    left = _split("column", "3D!top", _split("column", "StateTransitions!states", "RosOut!log", 45), 62)
    right = _stack([*plots, "RawMessages!parameters"])
    arrangement = _split("row", left, right, 58)
    common: dict[str, Any] = {"globalVariables": {}, "userNodes": {}, "playbackConfig": {"speed": 1}}
    return {"configById": panels, **common, "layout": arrangement}


def write_layouts() -> list[Path]:
    """Write the shipped files and return their paths."""
    LAYOUT_FOLDER.mkdir(exist_ok=True)
    paths = []
    for viewer in TITLES:
        paths.append(LAYOUT_FOLDER / f"{viewer}.json")
        paths[-1].write_text(json.dumps(layout(viewer), indent=2) + "\n", encoding="utf-8")
    return paths


def _path(signal: str) -> dict[str, Any]:
    """Return a signal as a message path: its instance is the topic."""
    return {"value": f"/{signal}", "timestampMethod": "receiveTime", "label": signal}


def _plot(signals: list[str]) -> dict[str, Any]:
    shown = {"showLegend": True, "legendDisplay": "top", "showPlotValuesInLegend": True, "isSynced": True}
    axes = {"showXAxisLabels": True, "showYAxisLabels": True, "xAxisVal": "timestamp"}
    return {"paths": [{**_path(name), "enabled": True} for name in signals], **shown, **axes}


def _top_view() -> dict[str, Any]:
    camera = {
        "perspective": False,
        "distance": 14,
        "phi": 0,
        "thetaOffset": 0,
        "targetOffset": [-3, -1.5, 0],
        "target": [0, 0, 0],
        "targetOrientation": [0, 0, 0, 1],
        "fovy": 45,
        "near": 0.5,
        "far": 5000,
    }
    grid = {"visible": True, "layerId": "foxglove.Grid", "instanceId": "grid", "label": "Grid", "frameId": "world"}
    size = {"size": 40, "divisions": 40, "lineWidth": 1, "color": "#8080804d", "order": 1}
    place = {"position": [0, 0, 0], "rotation": [0, 0, 0]}
    return {
        "cameraState": camera,
        "followMode": "follow-none",
        "followTf": "world",
        "scene": {"backgroundColor": "#ffffff"},
        "topics": {topic: {"visible": True} for topic in DRAWN},
        "transforms": {},
        "layers": {"grid": {**grid, **size, **place}},
    }


def _split(direction: str, first: object, second: object, percentage: float) -> dict[str, Any]:
    return {"direction": direction, "first": first, "second": second, "splitPercentage": round(percentage, 2)}


def _stack(panels: list[str]) -> object:
    """Return panels of equal height, one above the other."""
    if len(panels) == 1:
        return panels[0]
    return _split("column", panels[0], _stack(panels[1:]), 100.0 / len(panels))


if __name__ == "__main__":
    for written in write_layouts():
        print(written)
