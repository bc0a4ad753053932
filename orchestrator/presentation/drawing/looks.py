"""What a box of a scene looks like: a person, a car, or a box. The pages say the same (scene_parts.js)."""

from orchestrator.evaluation.verdict.geometry import Box

PERSON, CAR, PLAIN = "person", "car", "box"
LARGEST_PERSON = 1.0
"""No side of a person is longer [m]."""
CAR_LENGTH, CAR_WIDTH = (3.0, 6.5), (1.4, 2.3)
"""From and to [m]."""


def looks(box: Box) -> str:
    """Return what a box is drawn as: a person comes or goes and is small, a car is as long and wide as one."""
    width, length = sorted((box.length, box.width))
    if length <= LARGEST_PERSON and box.comes_or_goes:
        return PERSON
    return CAR if CAR_LENGTH[0] <= length <= CAR_LENGTH[1] and CAR_WIDTH[0] <= width <= CAR_WIDTH[1] else PLAIN
