"""The scene of an episode from above as pixels: slot, target, obstacles, kerbs, car, and what its sensors measure."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from apa_cosim.gym.episodes import Episodes
from controller_fmu.policy.signals import SENSOR_COUNT
from modelkit.variables import variables
from orchestrator.evaluation.verdict.geometry import CarOutline, boxes, kerbs, place
from orchestrator.simulation.cosim.fmu_instance import Array

SIZE = (640, 480)
"""Width and height [pixels]."""
VIEW_MARGIN = 4.0
"""Around start, target and car [m]."""
FIRST_RANGE = 6
"""Place of the first range in an observation."""
GROUND, OBSTACLE, SLOT, TARGET, CAR, GLASS, RANGE, KERB = (
    *("#f4f5f7", "#8d949c", "#d8ecdd", "#1c7d43", "#1e6bd9", "#cfe0fb", "#f5a742", "#4a4f55"),
)


def picture(episodes: Episodes, number: int) -> NDArray[np.uint8]:
    """Return an episode as it stands now, (height, width, 3)."""
    vehicle = _vehicle(episodes, number)
    x, y, heading, _ = episodes.poses[number].tolist()
    target, slot = (getattr(episodes.scenes.truth, name)[number].tolist() for name in ("targets", "slots"))
    car = CarOutline.of(vehicle)
    view = _View(np.array([[x, y], target[:2], [vehicle["start.x"], vehicle["start.y"]]]))
    if all(map(math.isfinite, slot)):
        sx, sy, turn, length, width = slot
        view.area(place(_rectangle(length, width), sx, sy, turn), SLOT)
    time = float(episodes.times[number])
    for box in boxes(vehicle):
        if box.appear_at <= time < box.disappear_at:
            view.area(box.outline(), OBSTACLE)
    for corners in episodes.source.obstacles(int(episodes.seeds[number])):
        view.area(np.array(corners), OBSTACLE)
    for kerb in kerbs(vehicle):
        view.line([(kerb.x1, kerb.y1), (kerb.x2, kerb.y2)], KERB, 3)
    view.line(place(car.outline(), *target), TARGET, 2)
    view.area(place(car.outline(), x, y, heading), CAR)
    window = np.array([[0.6, -0.8], [0.75, -0.8], [0.75, 0.8], [0.6, 0.8]]) * [car.wheelbase, car.half_width]
    view.area(place(window, x, y, heading), GLASS)
    for end_points in _ranges(vehicle, episodes.observations[number]):
        view.line(place(end_points, x, y, heading), RANGE, 2)
    return view.pixels()


def _vehicle(episodes: Episodes, number: int) -> dict[str, float]:
    names = [item.name for item in variables(episodes.source.scenario.models["vehicle"].params)]
    return dict(zip(names, episodes.scenes.parameters[number].tolist(), strict=False))


def _rectangle(length: float, width: float) -> Array:
    return 0.5 * np.array([[-length, -width], [length, -width], [length, width], [-length, width]])


def _ranges(vehicle: dict[str, float], observation: Array) -> list[Array]:
    """Return the arc at which each sensor that measures something does so, in the car's frame."""
    found = []
    far, half = vehicle["car.ultrasonic.max_range"], vehicle["car.ultrasonic.half_angle"]
    for number in range(SENSOR_COUNT):
        distance = float(observation[FIRST_RANGE + number]) * far
        if distance >= far:
            continue
        x, y, yaw = (vehicle[f"car.ultrasonic.mounts[{number + 1}].{axis}"] for axis in ("x", "y", "yaw"))
        turns = yaw + np.linspace(-half, half, 7)
        found.append(np.column_stack([x + distance * np.cos(turns), y + distance * np.sin(turns)]))
    return found


class _View:
    """A part of the plane and its picture; x to the right, y up."""

    def __init__(self, points: Array) -> None:
        low, high = points.min(axis=0) - VIEW_MARGIN, points.max(axis=0) + VIEW_MARGIN
        self._scale = min(SIZE[0] / (high[0] - low[0]), SIZE[1] / (high[1] - low[1]))
        self._middle = 0.5 * (low + high)
        self._image = Image.new("RGB", SIZE, GROUND)
        self._draw = ImageDraw.Draw(self._image)

    def area(self, points: Array, colour: str) -> None:
        """Fill a polygon."""
        self._draw.polygon(self._at(points), fill=colour)

    def line(self, points: Array | Sequence[tuple[float, float]], colour: str, width: int) -> None:
        """Draw a line."""
        self._draw.line(self._at(np.asarray(points)), fill=colour, width=width)

    def pixels(self) -> NDArray[np.uint8]:
        """Return the picture."""
        return np.asarray(self._image, dtype=np.uint8).copy()

    def _at(self, points: Array) -> list[tuple[float, float]]:
        offset = (points - self._middle) * self._scale
        return [(SIZE[0] / 2 + dx, SIZE[1] / 2 - dy) for dx, dy in offset.tolist()]
