"""``apa report RUN --video``: a video without a browser, its format checked before any work."""

import itertools
import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL.GifImagePlugin import GifImageFile

from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.drawing.picture_data import overview_of
from orchestrator.presentation.drawing.video import VideoOptions, write_video

WIDTH = 320
FFMPEG = """#!{python}
import pathlib, sys
data = sys.stdin.buffer.read()
width, height = map(int, sys.argv[sys.argv.index("-s") + 1].split("x"))
pathlib.Path(sys.argv[-1]).write_text(f"{{len(data) / (4 * width * height)}} {{width}} {{height}}")
"""


@pytest.fixture(scope="module")
def seen(case4: Any) -> Any:
    recording, summary = case4
    return overview_of(recording, summary, load_scenario("guo2015-case4"))


def test_a_gif_shows_the_car_move_at_the_speed_asked_for(seen: Any, tmp_path: Path) -> None:
    path = tmp_path / "run.gif"
    count = write_video(path, seen, VideoOptions(speed=20.0, width=WIDTH))
    assert count == 13 + 10  # 22.9 s in steps of 2 s, and a second at the end
    with GifImageFile(path) as image:
        frames = []
        for number in range(image.n_frames):
            image.seek(number)
            frames.append(np.asarray(image.convert("RGB")).astype(int))
        assert image.size == (WIDTH, 180)
        total = sum(_duration(image, number) for number in range(image.n_frames))
    assert total == pytest.approx(100 * count, abs=200)
    assert all(np.abs(a - b).max() > 50 for a, b in itertools.pairwise(frames))


def _duration(image: GifImageFile, number: int) -> int:
    image.seek(number)
    return int(image.info["duration"])


def test_ffmpeg_gets_every_frame_of_an_mp4(seen: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = tmp_path / "bin" / "ffmpeg"
    program.parent.mkdir()
    program.write_text(FFMPEG.format(python=sys.executable))
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}")
    count = write_video(tmp_path / "run.mp4", seen, VideoOptions(speed=20.0, width=WIDTH))
    assert (tmp_path / "run.mp4").read_text() == f"{float(count)} {WIDTH} 180"
    program.write_text(f"#!{sys.executable}\nimport sys\nsys.exit('no such encoder')\n")
    with pytest.raises(BadInput, match="ffmpeg wrote no video: no such encoder"):
        write_video(tmp_path / "other.mp4", seen, VideoOptions(speed=20.0, width=WIDTH))
    assert not (tmp_path / "other.mp4").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--video", "run.avi"], "the name of a video ends in one of .mp4, .gif"),
        (["--video", "run.gif", "--speed", "0"], "--speed: 0: expected more than 0"),
        (["--video", "run.gif", "--width", "17cm"], "--width: 17cm: expected the width of the video in pixels"),
        (["--video", "run.gif", "--width", "99999"], "--width: 99999: expected 320 to 3840 pixels"),
        (["--video", "run.mp4"], "the program ffmpeg, which is not on the PATH: install it, or write a .gif"),
        (["--video", "run.gif", "--figure", "run.pdf"], "a figure or a video"),
    ],
)
def test_what_cannot_be_written_is_refused_before_the_log_is_read(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    log = tmp_path / "run.mcap"
    log.write_bytes(b"no log")
    assert main(["report", str(log), *words]) == 2
    assert said in capsys.readouterr().err
