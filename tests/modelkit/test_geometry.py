"""Boxes and cones against shapely, which knows nothing of our code."""

import math
import random

import pytest
import shapely
from shapely import affinity

from modelkit.geometry import (
    NO_HIT,
    Box,
    Point,
    box_corners,
    boxes_gap,
    boxes_overlap,
    centre_gap,
    cone_gap,
    cone_of,
    corners,
    line_box,
    orient,
    orient_line,
    outline,
    overlap_depth,
    point_gap,
)
from modelkit.vocabulary import Pose


def polygon(box: Box) -> shapely.Geometry:
    shape = shapely.box(-0.5 * box.length, -0.5 * box.width, 0.5 * box.length, 0.5 * box.width)
    turned = affinity.rotate(shape, box.heading, origin=(0.0, 0.0), use_radians=True)
    return affinity.translate(turned, box.x, box.y)


def random_box(draw: random.Random, span: float = 5.0) -> Box:
    return Box(
        draw.uniform(-span, span),
        draw.uniform(-span, span),
        draw.uniform(-7.0, 7.0),
        draw.uniform(0.05, 6.0),
        draw.uniform(0.05, 2.5),
    )


def test_gap_and_overlap_of_20_000_pairs() -> None:
    draw = random.Random(1)
    ours = [(random_box(draw), random_box(draw)) for _ in range(20_000)]
    first = _polygons([a for a, _ in ours])
    second = _polygons([b for _, b in ours])
    gaps = shapely.distance(first, second)
    shared = shapely.area(shapely.intersection(first, second))
    overlaps = 0
    for (a, b), gap, area in zip(ours, gaps, shared, strict=True):
        assert abs(boxes_gap(a, b) - gap) < 1e-9
        assert centre_gap(orient(a), b) <= gap + 1e-9
        assert -overlap_depth(orient(a), orient(b)) <= gap + 1e-9
        if area > 1e-9 or gap > 1e-9:
            assert boxes_overlap(a, b) == (area > 1e-9)
        overlaps += area > 1e-9
    assert overlaps > 2_000


def _polygons(boxes: list[Box]) -> list[shapely.Geometry]:
    rings = [[(p.x, p.y) for p in corners(box)] for box in boxes]
    return list(shapely.polygons(rings))


def test_a_line_has_the_direction_of_its_ends() -> None:
    draw = random.Random(4)
    for _ in range(200):
        ends = [draw.uniform(-20.0, 20.0) for _ in range(4)]
        assert orient_line(*ends) == pytest.approx(orient(line_box(*ends)), abs=1e-12)
    assert orient_line(1.0, 2.0, 1.0, 2.0) == orient(line_box(1.0, 2.0, 1.0, 2.0))


def test_corners_are_those_of_the_turned_rectangle() -> None:
    draw = random.Random(2)
    for _ in range(200):
        box = random_box(draw)
        assert polygon(box).symmetric_difference(shapely.Polygon(corners(box))).area < 1e-9


def test_cone() -> None:
    draw = random.Random(4)
    seen = 0
    for _ in range(5000):
        box = random_box(draw)
        start, angle, half = (
            Point(draw.uniform(-6, 6), draw.uniform(-6, 6)),
            draw.uniform(-7, 7),
            draw.uniform(0.05, 1.2),
        )
        ends = [(start.x + 99.0 * math.cos(angle + t), start.y + 99.0 * math.sin(angle + t)) for t in (-half, half)]
        part = polygon(box).intersection(shapely.Polygon([start, *ends]))
        ours = cone_gap(cone_of(start, angle, half), orient(box), box_corners(orient(box)))
        if part.area > 1e-9:
            seen += 1
            assert ours == pytest.approx(part.distance(shapely.Point(start)), abs=1e-7)
        elif part.is_empty:
            assert ours == NO_HIT
    assert seen > 1000


def test_a_line_is_a_box_of_no_width() -> None:
    line = line_box(1.0, 2.0, 4.0, 6.0)
    assert line.length == 5.0
    assert point_gap(Point(1.0, 2.0), line) == pytest.approx(0.0, abs=1e-12)
    assert point_gap(Point(1.0 - 4.0, 2.0 + 3.0), line) == pytest.approx(5.0, rel=1e-12)
    assert boxes_gap(line, Box(2.5, 4.0, 0.3, 2.0, 1.0)) == 0.0, "the line crosses the box"
    assert line_box(1.0, 1.0, 1.0, 1.0) == Box(1.0, 1.0, 0.0, 0.0, 0.0)


def test_outline_of_a_car() -> None:
    box = outline(Pose(1.0, 2.0, math.pi / 2), 2.4, 0.8, 0.6, 1.65)
    x, y, _, length, width = box
    assert (x, y, length, width) == pytest.approx((1.0, 2.0 + 0.5 * 3.8 - 0.6, 3.8, 1.65))


def test_touching_boxes_do_not_overlap() -> None:
    assert not boxes_overlap(Box(0.0, 0.0, 0.0, 2.0, 2.0), Box(2.0, 0.0, 0.0, 2.0, 2.0))
    assert boxes_gap(Box(0.0, 0.0, 0.0, 2.0, 2.0), Box(2.0, 0.0, 0.0, 2.0, 2.0)) == 0.0
