"""The exact distance from a vehicle's rectangular outline to a straight edge."""

from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.geometry.polygons import clip_to_box
from modelkit.geometry import Point

MIN_EDGE_SQUARE = 1e-12
"""A straight edge of a squared length [m2] below this, a micrometre, is a point."""


def edge_distance_squared(ax: float, ay: float, bx: float, by: float, car: VehicleOutline, best: float) -> float:
    """Return the squared distance [m2] from the edge a-b to a car about the origin, at most ``best`` [m2].

    Where the infinite line misses the car, the car's corner nearest to it decides if it lies beside the edge;
    else an end of the edge does.
    """
    half_length = car.half_length
    half_width = car.half_width
    apart_x = box_distance(ax, bx, half_length)
    apart_y = box_distance(ay, by, half_width)
    if apart_x * apart_x + apart_y * apart_y >= best:
        return best
    dx = bx - ax
    dy = by - ay
    across = ax * dy - ay * dx
    beyond = abs(across) - half_length * abs(dy) - half_width * abs(dx)
    square = dx * dx + dy * dy
    if beyond > 0.0 and square > MIN_EDGE_SQUARE:
        side = 1.0 if across > 0.0 else -1.0
        corner_x = side * (half_length if dy > 0.0 else -half_length)
        corner_y = side * (-half_width if dx > 0.0 else half_width)
        along = (corner_x - ax) * dx + (corner_y - ay) * dy
        if 0.0 < along < square:
            gap = beyond * beyond / square
            return gap if gap < best else best
    elif beyond <= 0.0 and apart_x == 0.0 and apart_y == 0.0:
        return 0.0
    best = _point_distance(ax, ay, half_length, half_width, best)
    return _point_distance(bx, by, half_length, half_width, best)


def box_distance(a: float, b: float, half: float) -> float:
    """Return the distance [m] from the range between ``a`` and ``b`` to the range of ``half`` [m] about zero."""
    above = (a if a < b else b) - half
    below = -half - (b if a < b else a)
    apart = above if above > below else below
    return apart if apart > 0.0 else 0.0


def overlap_ahead(start: Point, end: Point, car: VehicleOutline) -> float:
    """Return how far [m] ahead of its centre a segment cuts a car about the origin: the middle of what is inside."""
    low = Point(-car.half_length, -car.half_width)
    part = clip_to_box(start, end, low, Point(car.half_length, car.half_width))
    return start.x + 0.5 * (part.enter + part.leave) * (end.x - start.x)


def _point_distance(x: float, y: float, half_length: float, half_width: float, best: float) -> float:
    dx = box_distance(x, x, half_length)
    dy = box_distance(y, y, half_width)
    gap = dx * dx + dy * dy
    return gap if gap < best else best
