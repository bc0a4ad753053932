"""``apa export ros2``: a run as a bag of ROS 2 (rosbag2 in MCAP) with its message definitions. Needs rosbags."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from fmus.files import whole_folder
from fmus.installation import missing_package
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.locked_folder import lock_with
from orchestrator.inputs.text.patterns import matching
from orchestrator.presentation.log.line import Line
from orchestrator.presentation.log.messages import read_messages
from orchestrator.presentation.log.read_log import log_file, read_log
from orchestrator.simulation.cosim.recording import Recording

EXAMPLES = """examples:
  apa export ros2 runs/guo2015-case4                  writes runs/guo2015-case4/run_ros2
  ros2 bag play runs/guo2015-case4/run_ros2
  apa export ros2 run.mcap --out bag --signals "controller.*"

Topics: /tf, /tf_static, /pose and /odometry (PoseStamped), /planned_path and /driven_path (Path),
/ultrasonic/range_1 to range_12 (Range), /speed, /steering_wheel_angle, ... (Float64), /markers, /rosout; with
--signals also /signals/... Foxglove and PlotJuggler open the .mcap in the folder. Times are those of the simulation.
Needs rosbags: pip install 'apa-cosim[ros2]'
"""
METADATA_VERSION: Final = 8
"""Of metadata.yaml: one that every rosbag2 since Humble reads."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the format takes."""
    parser.add_argument("log", type=log_file, metavar="RUN.mcap", help="log of a run, or its folder")
    parser.add_argument("--out", type=Path, metavar="DIR", help="output folder (default: name of the log with _ros2)")
    parser.add_argument(
        "--signals",
        action="append",
        metavar="PATTERN",
        help="also write these signals as Float64, such as controller.*",
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the bag. Returns 0."""
    log: Path = arguments.log
    out: Path = arguments.out or log.with_name(f"{log.stem}_ros2")
    if out.exists() and not (out / "metadata.yaml").is_file():
        raise BadInput("exists and is no bag; name another --out", file=out)
    with lock_with(log, out):
        recording = read_log(log)
        names = matching(recording.signals, arguments.signals) if arguments.signals else []
        write_bag(out, recording, names, read_messages(log))
    print(out)
    return 0


def write_bag(path: Path, recording: Recording, names: Sequence[str], lines: list[Line]) -> None:
    """Write the folder of a bag; ``names``: signals besides. Raises ``BadInput`` if rosbags is not installed."""
    try:
        from rosbags.rosbag2 import StoragePlugin, Writer

        from orchestrator.presentation.export.ros2_bag import Bag
    except ImportError:
        raise BadInput(missing_package("rosbags", "ros2")) from None
    with (
        whole_folder(path) as made,
        Writer(made, version=METADATA_VERSION, storage_plugin=StoragePlugin.MCAP) as writer,
    ):
        Bag(writer).write_run(recording, names, lines)
