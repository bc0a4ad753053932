"""The scene of an episode from above as pixels: slot, target, obstacles, kerbs, car, and what its sensors measure."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from apa_cosim.gym.episodes import Episodes
from apa_cosim.gym.scene_source import Scenes
from controller_fmu.policy.signals import SENSOR_COUNT
from modelkit.variables import variables
from orchestrator.evaluation.verdict.geometry import Box, CarOutline, boxes, kerbs, place
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.presentation.drawing.palette import LIGHT
from orchestrator.simulation.cosim.fmu_instance import Array

SIZE = (640, 480)
"""Width and height [pixels]."""
VIEW_MARGIN = 4.0
"""Around start, target and car [m]."""
FIRST_RANGE = 6
"""Place of the first range in an observation."""
GROUND, OBSTACLE, SLOT, GLASS, RANGE, KERB, TYRE = (
    *("#f4f5f7", "#8d949c", "#d8ecdd", "#cfe0fb", "#f5a742", "#4a4f55", "#22262b"),
)
TARGET, CAR = LIGHT["good"], LIGHT["run-a"]


def picture(episodes: Episodes, number: int) -> NDArray[np.uint8]:
    """Return an episode as it stands now, (height, width, 3)."""
    scene = episodes.source.scenes(episodes.seeds[[number]])
    vehicle = _vehicle(episodes.source.scenario, scene)
    x, y, heading, steered = episodes.poses[number].tolist()
    target, car = scene.truth.targets[0].tolist(), CarOutline.of(vehicle)
    slot = Box(*scene.truth.slots[0].tolist()).outline()
    has_slot = bool(np.isfinite(slot).all())
    ends = np.array([[x, y], target[:2], [vehicle["start.x"], vehicle["start.y"]]])
    view = _View(np.concatenate([ends, slot]) if has_slot else ends)
    if has_slot:
        view.area(slot, SLOT)
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
    for wheel in car.wheel_outlines(steered):
        view.area(place(wheel, x, y, heading), TYRE)
    for end_points in _ranges(vehicle, episodes.observations[number]):
        view.line(place(end_points, x, y, heading), RANGE, 2)
    return view.pixels()


def _vehicle(scenario: Scenario, scene: Scenes) -> dict[str, float]:
    names = [item.name for item in variables(scenario.models["vehicle"].params)]
    return dict(zip(names, scene.parameters[0].tolist(), strict=False))


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
