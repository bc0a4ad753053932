"""``apa report``: the replay page of a run, one HTML file that needs nothing else; or a figure for a publication."""

import argparse
from pathlib import Path

from orchestrator.evaluation.verdict.logged_scenario import read_logged_scenario
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.text.console import say, working
from orchestrator.inputs.text.errors import PARKED, BadInput
from orchestrator.inputs.text.locked_folder import lock_with
from orchestrator.presentation.log.messages import read_messages
from orchestrator.presentation.log.read_log import log_file, log_name, read_log
from orchestrator.presentation.report.replay import write_replay

EXAMPLES = """examples:
  apa report runs/guo2015-case4                           writes runs/guo2015-case4/report.html
  apa report run.mcap --out /tmp/page.html
  apa report runs/guo2015-case4 --figure case4.pdf --width 8.4cm --panels path,steering
  apa report runs/a runs/b --figure both.svg              both runs overlaid, with a legend
  apa report runs/guo2015-case4 --video case4.mp4 --speed 4 --width 1280

The page replays the run in any browser, offline: top view, curves, states, checks, parameters.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument(
        "log", type=log_file, nargs="+", metavar="RUN.mcap", help="log of a run, or its folder; several with --figure"
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="the page (default: report.html beside the log)")
    figure = parser.add_argument_group("figure for a publication")
    figure.add_argument(
        "--figure", type=Path, metavar="FILE", help="write a figure (.pdf, .svg, .png) instead of the page"
    )
    figure.add_argument(
        "--panels",
        default="path,speed,steering,heading",
        metavar="A,B",
        help="panels or signals (default: %(default)s)",
    )
    figure.add_argument(
        "--width",
        metavar="LENGTH",
        help="width of the figure (default: 17cm), or of the video in pixels (default: 1280)",
    )
    figure.add_argument("--dpi", type=int, default=300, help="resolution of a PNG (default: 300)")
    figure.add_argument("--style", default="paper", choices=("paper", "screen"), help="screen: with a grid")
    video = parser.add_argument_group("video")
    video.add_argument(
        "--video", type=Path, metavar="FILE", help="write a video (.mp4 with ffmpeg, .gif) instead of the page"
    )
    video.add_argument(
        "--speed", type=float, default=1.0, metavar="X", help="playback speed over real time (default: 1)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the page or the figure. Returns 0. Raises ``BadInput`` for several runs without ``--figure``."""
    if arguments.figure is not None and arguments.video is not None:
        raise BadInput("write a figure or a video, one at a time", key="--video")
    if arguments.figure is not None:
        return _write_figure(arguments)
    if arguments.video is not None:
        return _write_video(arguments)
    if len(arguments.log) > 1:
        raise BadInput(
            "a page is of one run; several runs are overlaid with --figure FILE, or compared with apa compare"
        )
    log: Path = arguments.log[0]
    out: Path = arguments.out or log.parent / "report.html"
    with lock_with(log, out):
        recording = read_log(log)
        scenario = read_logged_scenario(recording, str(log), log.stem)
        write_replay(out, recording, summarize(recording, scenario, 0.0), read_messages(log))
    print(out)
    return PARKED


def _write_figure(arguments: argparse.Namespace) -> int:
    from orchestrator.presentation.drawing.decimation import decimate
    from orchestrator.presentation.drawing.run_figure import run_figure, save_figure, width_in_cm
    from orchestrator.presentation.drawing.save import check_picture

    check_picture(arguments.figure)
    if not 10 <= arguments.dpi <= 2400:
        raise BadInput(f"--dpi {arguments.dpi}: expected 10 to 2400")
    runs = [(log_name(log), decimate(read_log(log))) for log in arguments.log]
    figure = run_figure(runs, arguments.panels.split(","), width_in_cm(arguments.width or "17cm"), arguments.style)
    save_figure(figure, arguments.figure, arguments.dpi, arguments.style)
    print(arguments.figure)
    return PARKED


def _write_video(arguments: argparse.Namespace) -> int:
    from orchestrator.presentation.drawing.picture_data import overview_of
    from orchestrator.presentation.drawing.video import VideoOptions, check_video, write_video

    width = arguments.width or "1280"
    if not width.removesuffix("px").strip().isdigit():
        raise BadInput(f"{width}: expected the width of the video in pixels, such as 1280", key="--width")
    options = VideoOptions(arguments.speed, int(width.removesuffix("px")))
    check_video(arguments.video, options)
    if len(arguments.log) > 1:
        raise BadInput("a video is of one run; several runs are overlaid with --figure FILE", key="--video")
    log: Path = arguments.log[0]
    recording = read_log(log)
    scenario = read_logged_scenario(recording, str(log), log.stem)
    summary = summarize(recording, scenario, 0.0)
    with working("drawing the video"):
        count = write_video(arguments.video, overview_of(recording, summary, scenario), options)
    say(f"{count} frames")
    print(arguments.video)
    return PARKED
