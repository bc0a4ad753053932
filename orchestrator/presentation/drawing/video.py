"""A run as a video: the top view with the car, speed and steering wheel beside a cursor, clock and state.

What stands still is drawn once; what moves is drawn on a copy of it, frame by frame. GIF is written by Pillow, MP4 by
the program ffmpeg, which gets the frames through a pipe.
"""

import math
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from fmus.files import whole
from orchestrator.evaluation.verdict.geometry import Box, place
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.quantities import RAD_PER_DEGREE
from orchestrator.presentation.drawing.figure import BLUE, INK, STYLE, draw_scene, draw_thing
from orchestrator.presentation.drawing.overview import Overview
from orchestrator.simulation.cosim.fmu_instance import Array

FRAME_RATES = {".mp4": 25.0, ".gif": 10.0}
"""Format -> frames in a second."""
MAX_SPEED, MAX_WIDTH, MIN_WIDTH = 100.0, 3840, 320
MAX_FRAMES = 20_000
INCHES = (12.8, 7.2)
"""Size of the picture; the width in pixels chooses its resolution."""
PLAN, CURVES = (0.05, 0.33, 0.93, 0.58), ((0.06, 0.08, 0.4, 0.17), (0.56, 0.08, 0.4, 0.17))
"""Axes of the top view and of the two curves, as shares of the picture."""
SHOWN = (
    ("vehicle.speed", "speed [m/s]", 1.0),
    ("vehicle.steering_wheel_angle", "steering wheel [deg]", 1.0 / RAD_PER_DEGREE),
)
"""Signals of the curves, their titles, and their factors."""
MAX_OUTLINES = 60
"""So many outlines of the car along its path have room in the top view."""
LAST_FRAME_TIME = 1.0
"""The last frame is seen so long [s]."""
NO_FFMPEG = "an .mp4 is written by the program ffmpeg, which is not on the PATH: install it, or write a .gif"


class VideoOptions(NamedTuple):
    """How a video is made."""

    speed: float = 1.0
    """Simulated seconds in a second of the video."""
    width: int = 1280
    """Of the picture [px]; its height is 9/16 of it."""


def check_video(path: Path, options: VideoOptions) -> None:
    """Raise ``BadInput`` if no video can have this name, speed or width, or the program that writes it is absent."""
    if path.suffix.lower() not in FRAME_RATES:
        raise BadInput(f"the name of a video ends in one of {', '.join(FRAME_RATES)}", file=path)
    if not 0.0 < options.speed <= MAX_SPEED:
        raise BadInput(f"{options.speed:g}: expected more than 0, at most {MAX_SPEED:g}", key="--speed")
    if not MIN_WIDTH <= options.width <= MAX_WIDTH:
        raise BadInput(f"{options.width}: expected {MIN_WIDTH} to {MAX_WIDTH} pixels", key="--width")
    if path.suffix.lower() == ".mp4" and shutil.which("ffmpeg") is None:
        raise BadInput(NO_FFMPEG, file=path)


def write_video(path: Path, seen: Overview, options: VideoOptions) -> int:
    """Write the video of a run, whole or not at all; return its number of frames. Raises ``BadInput``."""
    check_video(path, options)
    rate = FRAME_RATES[path.suffix.lower()]
    times = _times(seen, options.speed / rate)
    times += [times[-1]] * round(LAST_FRAME_TIME * rate)
    with whole(path) as part, mpl.rc_context(STYLE):
        write = _write_gif if path.suffix.lower() == ".gif" else _write_mp4
        write(part, _frames(seen, times, options.width), rate)
    return len(times)


def _times(seen: Overview, step: float) -> list[float]:
    """Return the time of each frame [s]."""
    duration = float(seen.t[-1] - seen.t[0]) if len(seen.t) else 0.0
    if duration <= 0.0:
        raise BadInput("the run has no duration, so there is nothing to show")
    count = math.ceil(duration / step) + 1
    if count > MAX_FRAMES:
        raise BadInput(f"{count} frames; at most {MAX_FRAMES}: choose a greater --speed", key="--speed")
    return [min(float(seen.t[0]) + step * number, float(seen.t[-1])) for number in range(count)]


def _frames(seen: Overview, times: list[float], width: int) -> Iterator[Array]:
    """Yield the pixels of each frame, (height, width, 4) of whole numbers 0 to 255."""
    figure = Figure(figsize=INCHES, dpi=width / INCHES[0])
    canvas: Any = FigureCanvasAgg(figure)
    moving = _Moving(figure, seen)
    canvas.draw()
    background = canvas.copy_from_bbox(figure.bbox)
    for t in times:
        canvas.restore_region(background)
        moving.draw(t, canvas.get_renderer())
        pixels = np.asarray(canvas.buffer_rgba())
        yield pixels[: pixels.shape[0] // 2 * 2, : pixels.shape[1] // 2 * 2].copy()


class _Moving:
    """What changes from frame to frame."""

    def __init__(self, figure: Any, seen: Overview) -> None:
        self._seen = seen
        self._plan = figure.add_axes(PLAN)
        self._plan.set_aspect("equal", adjustable="datalim")
        self._passing = [box for box in seen.around.boxes if box.comes_or_goes]
        draw_scene(self._plan, seen, [box for box in seen.around.boxes if not box.comes_or_goes])
        x, y = seen.signal("vehicle.pose.x"), seen.signal("vehicle.pose.y")
        self._plan.plot(x, y, alpha=0.0)
        rows = np.linspace(0, len(seen.t) - 1, MAX_OUTLINES).astype(int)
        ends = np.vstack([place(seen.car.outline(), *self._pose(row)) for row in rows])
        self._plan.plot(*ends.T, alpha=0.0)
        figure.text(0.02, 0.965, seen.title, fontweight="bold", color=INK, va="center", fontsize=11.0)
        self._cursors = [self._curve(figure.add_axes(at), *what) for at, what in zip(CURVES, SHOWN, strict=True)]
        self._trail = self._hidden(self._plan.plot([], [], color=BLUE, linewidth=1.8, zorder=5)[0])
        self._body = self._patch("#cfe0fb", BLUE)
        self._wheels = [self._patch(INK, INK) for _ in seen.car.wheels()]
        self._clock = self._hidden(figure.text(0.98, 0.965, "", ha="right", va="center", fontsize=11.0, color=INK))

    def draw(self, t: float, renderer: Any) -> None:
        """Draw all of it as it is at ``t``."""
        row = int(np.searchsorted(self._seen.t, t, side="right")) - 1
        pose, car = self._pose(row), self._seen.car
        x, y = self._seen.signal("vehicle.pose.x"), self._seen.signal("vehicle.pose.y")
        self._trail.set_data(x[: row + 1], y[: row + 1])
        self._body.set_xy(place(car.outline(), *pose))
        steered = float(self._seen.signal("vehicle.front_wheel_angle")[row])
        for patch, corners in zip(self._wheels, car.wheel_outlines(steered), strict=True):
            patch.set_xy(place(corners, *pose))
        self._clock.set_text(f"{self._state(row)}   {t:.1f} s")
        for cursor in self._cursors:
            cursor.set_xdata([t, t])
        for box in self._passing:
            for still in box.stills():
                if still.appear_at <= t < still.disappear_at:
                    self._draw_passing(still, renderer)
        for artist in (self._trail, self._body, *self._wheels, self._clock, *self._cursors):
            artist.axes.draw_artist(artist) if artist.axes is not None else artist.draw(renderer)

    def _draw_passing(self, box: Box, renderer: Any) -> None:
        before = len(self._plan.patches)
        draw_thing(self._plan, box)
        for artist in list(self._plan.patches)[before:]:
            artist.draw(renderer)
            artist.remove()

    def _pose(self, row: int) -> tuple[float, float, float]:
        x, y, heading = (float(self._seen.signal(f"vehicle.pose.{axis}")[row]) for axis in ("x", "y", "heading"))
        return x, y, heading

    def _state(self, row: int) -> str:
        values, states = self._seen.ribbon
        return states.get(int(values[row]), "").lower().replace("_", " ") if math.isfinite(values[row]) else ""

    def _curve(self, axis: Any, signal: str, label: str, factor: float) -> Any:
        """Draw a signal over time; return its cursor."""
        axis.plot(self._seen.t, self._seen.signal(signal) * factor, color=BLUE, linewidth=1.2)
        axis.set_xlim(self._seen.t[0], self._seen.t[-1])
        axis.set_title(label)
        axis.set_xlabel("time [s]")
        return self._hidden(axis.axvline(self._seen.t[0], color=INK, linewidth=1.0))

    def _patch(self, face: str, edge: str) -> Any:
        corners = np.zeros((4, 2))
        return self._hidden(self._plan.add_patch(Polygon(corners, facecolor=face, edgecolor=edge, alpha=0.9, zorder=6)))

    @staticmethod
    def _hidden(artist: Any) -> Any:
        """Return an artist that is left out when the rest is drawn."""
        artist.set_animated(True)
        return artist


def _write_gif(path: Path, frames: Iterator[Array], rate: float) -> None:
    """Write an animated GIF with the colours of its first frame."""
    from PIL import Image

    first = Image.fromarray(next(frames)).convert("RGB").quantize(128)
    pictures = (Image.fromarray(pixels).convert("RGB") for pixels in frames)
    others = (picture.quantize(palette=first, dither=Image.Dither.NONE) for picture in pictures)
    first.save(path, "GIF", save_all=True, append_images=others, duration=round(1000.0 / rate), loop=0)


def _write_mp4(path: Path, frames: Iterator[Array], rate: float) -> None:
    """Write an MP4 (H.264) with ffmpeg. Raises ``BadInput`` with its last words."""
    first = next(frames)
    height, width = first.shape[:2]
    raw = f"-f rawvideo -pix_fmt rgba -s {width}x{height} -r {rate:g} -i -".split()
    coded = ["-an", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4"]
    words = ["ffmpeg", "-y", "-loglevel", "error", *raw, *coded, str(path)]
    program = subprocess.Popen(words, stdin=subprocess.PIPE, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
    assert program.stdin is not None
    with suppress(BrokenPipeError):  # it has ended, and says why
        for pixels in chain([first], frames):
            program.stdin.write(pixels.tobytes())
    _, said = program.communicate()
    if program.returncode != 0:
        lines = said.decode(errors="replace").strip().splitlines() or [f"exit code {program.returncode}"]
        raise BadInput(f"ffmpeg wrote no video: {lines[-1]}")
