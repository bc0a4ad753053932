"""Where twelve ultrasonic sensors sit on a car that no file says it of."""


def mount_parameters(front: float, rear: float, half: float, owner: str) -> dict[str, float]:
    """Return where the twelve sensors sit on a car's outline [m], as parameters of their ``owner``."""
    placed: dict[str, float] = {}
    for number, (x, y) in enumerate(mounts(front, rear, half), start=1):
        placed |= {f"{owner}mounts[{number}].x": x, f"{owner}mounts[{number}].y": y}
    return placed


def mounts(front: float, rear: float, half: float) -> list[tuple[float, float]]:
    """Return where the twelve sensors sit on a car's outline: 4 front, 4 rear, 2 left, 2 right."""
    return [
        (front - 0.1, half - 0.15), (front, 0.25), (front, -0.25), (front - 0.1, 0.15 - half),
        (rear + 0.1, half - 0.15), (rear, 0.25), (rear, -0.25), (rear + 0.1, 0.15 - half),
        (front - 0.4, half), (rear + 0.4, half), (front - 0.4, -half), (rear + 0.4, -half),
    ]  # fmt: skip
