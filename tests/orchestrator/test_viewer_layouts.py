"""The shipped layouts are what the code makes, and speak only of topics and fields that a log has."""

import json
from typing import Any

import pytest
from mcap.reader import make_reader

from orchestrator.cli import main
from orchestrator.presentation.log.read_log import read_log
from orchestrator.presentation.log.viewer_layouts import LAYOUT_FOLDER, TITLES, layout


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Any:
    out = tmp_path_factory.mktemp("case4")
    main(["run", "guo2015-case4", "--fmus", "native", "--no-page", "--out", str(out)])
    return out / "run.mcap"


@pytest.mark.parametrize("viewer", TITLES)
def test_shipped_file_is_what_the_code_makes(viewer: Any) -> None:
    assert json.loads((LAYOUT_FOLDER / f"{viewer}.json").read_text()) == layout(viewer)


@pytest.mark.parametrize("viewer", TITLES)
def test_every_panel_is_placed_once(viewer: Any) -> None:
    made = layout(viewer)
    placed = []

    def walk(node: Any) -> None:
        if isinstance(node, str):
            placed.append(node)
        else:
            assert 0 < node["splitPercentage"] < 100
            walk(node["first"])
            walk(node["second"])

    walk(made["layout"])
    assert sorted(placed) == sorted(made["configById"])
    assert all(panel[TITLES[viewer]] for panel in made["configById"].values())


@pytest.mark.parametrize("viewer", TITLES)
def test_topics_and_fields_exist_in_a_log(viewer: Any, log: Any) -> None:
    run = read_log(log)
    with log.open("rb") as stream:
        summary = make_reader(stream).get_summary()
        assert summary is not None
        topics = {channel.topic for channel in summary.channels.values()}
    for panel in layout(viewer)["configById"].values():
        for path in panel.get("paths", []):
            assert path["value"].removeprefix("/") in run.signals
        named = [*panel.get("topics", {}), panel.get("topicToRender"), panel.get("topicPath")]
        assert {topic for topic in named if topic} <= topics
