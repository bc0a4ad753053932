"""From factors to parameters: two neighbours, the end of the slot, car, sensors, start.

The road runs along x, its slots at y < 0 (mirrored for a slot on the left); corner A of the slot is the origin: the
first neighbour's nearest corner is at x = 0, the second's at the slot's length, so that a slot is free over its length
however they stand.
"""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from modelkit.car import Car, car_length
from orchestrator.inputs.scenario.car import car_parameters
from orchestrator.inputs.scenario.slot_sizes import shortest_slot
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.cases import BODY, CARS, ISO
from orchestrator.studies.parking.world.factors import NO_SENSOR, NOBODY, STEPS
from orchestrator.studies.sweep.study.space import Seeds
from vehicle_fmu.scene import SceneParams

F = Mapping[str, Array]
KINDS = (1, 2)
"""Numbers of parallel and perpendicular, by the factor's choices."""
BODIES = (BODY["kinematic"], BODY["double_track"])
THINGS = ("first neighbour", "second neighbour", "wall behind", "person", "kerb behind")
"""What stands in the scene: boxes 1 to 4, then kerb 1."""
WALLED, WITH_KERB = 1, 2
"""Choices of the factor ``behind``."""
SENSOR_COUNT = 12
NEVER_TIME = 3e4
"""After any run [s]."""
PERSON_WIDTH = 0.5
"""Width of a person [m]."""
FAR_SIDE, NEAR_SIDE, BETWEEN = 8.0, 0.6, -1.0
"""Start of a pedestrian towards the slots, end of one between cars, start of one from between them: y [m]."""
FROM_BEHIND = 3.0
"""How far behind the slot's end [m] a pedestrian out of it sets out."""
WHEEL = SceneParams().tyre_reach
"""Tyres reach this far beyond the axles [m]."""
WALL_THICKNESS = 1.0
"""Thickness [m]."""
ROW_GAP, ROW_TURN, ROW_STAGGER = (0.4, 1.2), 5.0, 0.2
"""Cars beyond the neighbours: between them [m], turned by at most [deg], standing out or back by at most [m]."""
MAX_ROW_CARS = (len(SceneParams().boxes) + 1 - len(THINGS)) // 2
"""Cars beyond each neighbour: the other boxes of the scene, half on either side."""
RUN_UP = 5.0
"""From the start to the first neighbour [m], and what it takes to reach the speed."""


def parameters(f: F, seeds: Seeds, row_cars: int = 0) -> dict[str, Array]:
    """Return what differs from run to run, by the names of a study's fields; ``row_cars`` beyond each neighbour."""
    cars = [CARS[name] for name in CARS]
    chosen = f["car"].astype(int)
    reported = _select([car_parameters(car) for car in cars], chosen)
    found = {f"{owner}.{name}": values for owner in ("vehicle", "controller") for name, values in reported.items()}
    size = _select([_size(car) for car in cars], chosen)
    kind = f["kind"].astype(int)
    shortest = np.array([[shortest_slot(number, car, ISO) for number in KINDS] for car in cars])[chosen, kind]
    size = {**size, "slot": shortest + f["extra"], "parallel": kind == 0, "sign": 1.0 - 2.0 * f["side"]}
    size["depth"] = np.where(size["parallel"], size["width"] + ISO.deeper, size["length"]) + f["depth"]
    neighbours = _neighbours(f, size)
    row = _row(neighbours, size, seeds, row_cars)
    found |= _boxes(neighbours, size["sign"]) | _row_boxes(row, size["sign"]) | _behind(f, size)
    found |= _standing(f, size, neighbours) | _start(f, size, row)
    found |= _sensors(f, reported, seeds) | _motion(f, reported)
    return found | _person(f, size) | _mover(f, size) | _sensor_faults(f, reported)


def _select(items: list[dict[str, float]], chosen: Array) -> dict[str, Array]:
    return {name: np.array([float(item[name]) for item in items])[chosen] for name in items[0]}


def _size(car: Car) -> dict[str, float]:
    length = car_length(car)
    return {"length": length, "width": car.width, "nose": car.wheelbase + car.front_overhang, "tail": car.rear_overhang}


def _neighbours(f: F, size: F) -> dict[str, dict[str, Array]]:
    """Return the boxes of the neighbours, for a slot on the right, and what of them the slot is made by.

    ``corner_x``, ``corner_y``: of the corner at the slot's mouth; ``outer``: how far it reaches into the road.
    """
    found = {}
    for which, near in (("a", 1.0), ("b", -1.0)):
        turn, length, width = np.radians(f[f"turn_{which}"]), f[f"length_{which}"], f[f"width_{which}"]
        along, across = np.where(size["parallel"], length, width), np.where(size["parallel"], width, length)
        cos, sin = np.cos(turn), np.sin(turn)
        reach = 0.5 * (along * cos + across * np.abs(sin))
        x = -reach if which == "a" else size["slot"] + reach
        y = f[f"stagger_{which}"] - 0.5 * (near * along * sin + across * cos)
        corner_x = x + 0.5 * (near * along * cos - across * sin)
        outer = y + 0.5 * (across * cos + along * np.abs(sin))
        box = {"x": x, "y": y, "heading": turn, "length": along, "width": across}
        edges = {"far": x - near * reach, "outer": outer}
        found[which] = {**box, "corner_x": corner_x, "corner_y": f[f"stagger_{which}"], **edges}
    return found


def _row(neighbours: Mapping[str, F], size: F, seeds: Seeds, row_cars: int) -> list[F]:
    """Return both neighbours and ``row_cars`` cars beyond each, one of either side at a time.

    Cars beyond are as large as the neighbour; how far apart, turned and staggered they stand follows from the seed.
    """
    row = [neighbours["a"], neighbours["b"]]
    for place in range(row_cars):
        for side, towards in enumerate((-1.0, 1.0)):
            draw = np.array([np.random.default_rng([int(seed), 11, place, side]).random(3) for seed in seeds]).T
            low, high = ROW_GAP
            inner, turn = row[-2], np.radians(ROW_TURN * (2.0 * draw[1] - 1.0))
            across = inner["width"] * np.cos(turn) + inner["length"] * np.abs(np.sin(turn))
            reach = 0.5 * (inner["length"] * np.cos(turn) + inner["width"] * np.abs(np.sin(turn)))
            x = inner["far"] + towards * (low + (high - low) * draw[0] + reach)
            outer = ROW_STAGGER * (2.0 * draw[2] - 1.0)
            box = {"x": x, "y": outer - 0.5 * across, "heading": turn, "length": inner["length"]}
            row.append({**box, "width": inner["width"], "outer": outer, "far": x + towards * reach})
    return row


def _row_boxes(row: list[F], sign: Array) -> dict[str, Array]:
    """Return the boxes of the cars beyond both neighbours."""
    return {
        f"scene.boxes[{number}].{name}": car[name] * (sign if name in ("y", "heading") else 1.0)
        for number, car in enumerate(row[2:], start=len(THINGS))
        for name in ("x", "y", "heading", "length", "width")
    }


def _boxes(neighbours: Mapping[str, F], sign: Array) -> dict[str, Array]:
    return {
        f"scene.boxes[{number}].{name}": neighbours[which][name] * (sign if name in ("y", "heading") else 1.0)
        for number, which in enumerate("ab", start=1)
        for name in ("x", "y", "heading", "length", "width")
    }


def _behind(f: F, size: F) -> dict[str, Array]:
    """Return the wall or the kerb that ends the slot; before a wheel stop the tail hangs over."""
    wall, kerb = f["behind"] == WALLED, f["behind"] == WITH_KERB
    middle, sign = 0.5 * size["slot"], size["sign"]
    half = np.where(size["parallel"], 0.5 * size["slot"] + 12.0, 0.5 * size["slot"])
    y = _slot_end(f, size)
    stop = np.where(size["parallel"], y, y + np.maximum(size["tail"] - WHEEL, 0.0))
    half_kerb = np.where(size["parallel"], half, 0.8)
    return {
        "scene.boxes[3].x": middle,
        "scene.boxes[3].y": sign * (y - 0.5 * WALL_THICKNESS),
        "scene.boxes[3].length": np.where(wall, 2.0 * half, 0.0),
        "scene.boxes[3].width": np.full_like(middle, WALL_THICKNESS),
        "scene.kerbs[1].x1": middle - half_kerb,
        "scene.kerbs[1].x2": middle + half_kerb,
        "scene.kerbs[1].y1": sign * stop,
        "scene.kerbs[1].y2": sign * stop,
        "scene.kerbs[1].height": np.where(kerb, f["kerb_height"], 0.0),
    }


def _mouth(f: F) -> Array:
    """Return y of the slot's mouth [m]: the mean of the neighbours' corners at it."""
    return 0.5 * (f["stagger_a"] + f["stagger_b"])


def _slot_end(f: F, size: F) -> Array:
    """Return y of what ends the slot, or would [m]."""
    return _mouth(f) - size["depth"]


def _standing(f: F, size: F, neighbours: Mapping[str, F]) -> dict[str, Array]:
    """Return target and slot as they are.

    The car's middle lies half way between the neighbours' faces, its outer end on the mean of their corners at the
    mouth. It stands half way between the road's direction and the neighbours' mean one: nobody can tell better.
    """
    sign, parallel, mouth = size["sign"], size["parallel"], _mouth(f)
    turn = np.radians(0.25 * (f["turn_a"] + f["turn_b"]))
    across = np.where(parallel, size["width"], size["length"])
    y = mouth - 0.5 * across
    faces = [
        item["corner_x"] - (y - item["corner_y"]) * np.tan(np.radians(f[f"turn_{which}"]))
        for which, item in neighbours.items()
    ]
    x = np.where(parallel, 0.5 * size["slot"], 0.5 * (faces[0] + faces[1]))
    heading = turn + np.where(parallel, 0.0, 0.5 * math.pi)
    back = 0.5 * (size["nose"] - size["tail"])
    outward = 0.5 * (across - size["depth"])
    return {
        "target.x": x - back * np.cos(heading),
        "target.y": sign * (y - back * np.sin(heading)),
        "target.heading": sign * heading,
        "slot.x": x - outward * np.sin(turn),
        "slot.y": sign * (y + outward * np.cos(turn)),
        "slot.heading": sign * heading,
        "slot.length": np.where(parallel, size["slot"], size["depth"]),
        "slot.width": np.where(parallel, size["depth"], size["slot"]),
    }


def _start(f: F, size: F, row: list[F]) -> dict[str, Array]:
    """Return where the driver starts, so that the pass is nearest to the row by ``beside``."""
    heading, speed = np.radians(f["heading"]), f["speed"] / 3.6
    along = np.where(size["parallel"], f["length_a"], f["width_a"]) if len(row) == 2 else -row[-2]["far"]
    start = -along - RUN_UP - speed**2 / (2.0 * _acceleration(f))
    nearest = np.where(heading > 0.0, -along, np.maximum(size["slot"] + RUN_UP, row[-1]["far"] if row[2:] else 0.0))
    y = np.max([item["outer"] for item in row], axis=0) + f["beside"] + 0.5 * size["width"]
    y = y + (start - nearest) * np.tan(heading)
    y = y + np.where(heading > 0.0, 0.5 * size["length"] * np.sin(heading), 0.0)
    return {
        "vehicle.start.x": start,
        "vehicle.start.y": size["sign"] * y,
        "vehicle.start.heading": size["sign"] * heading,
        "vehicle.driver.profile[1].speed": speed,
    }


def _acceleration(f: F) -> Array:
    """Return what a driver who feels the road asks of the car [m/s2], so that it does not slip sideways."""
    return np.minimum(1.5, 2.0 * f["grip"])


def _sensors(f: F, reported: F, seeds: Seeds) -> dict[str, Array]:
    ultrasonic = {f"vehicle.ultrasonic.{name}": f[name] for name in ("noise", "dropout")}
    drawn = np.array([np.random.default_rng([int(seed), 7]).uniform(-1.0, 1.0, (12, 3)) for seed in seeds])
    sizes = (f["mount_place"], f["mount_place"], np.radians(f["mount_yaw"]))
    for number in range(12):
        for place, axis in enumerate(("x", "y", "yaw")):
            name = f"car.ultrasonic.mounts[{number + 1}].{axis}"
            ultrasonic[f"vehicle.{name}"] = reported[name] + sizes[place] * drawn[:, number, place]
    ultrasonic["vehicle.car.ultrasonic.half_angle"] = np.radians(f["cone"])
    ultrasonic["vehicle.car.ultrasonic.resolution"] = f["resolution"]
    both = {f"{owner}.car.ultrasonic.cycle": f["cycle"] for owner in ("vehicle", "controller")}
    odometry = {
        "vehicle.odometry.radius_error": f["radius_error"],
        "vehicle.odometry.steering_offset": np.radians(f["steering_offset"]),
        "vehicle.odometry.tick": f["tick"],
        "vehicle.odometry.steering_resolution": np.radians(f["steering_resolution"]),
    }
    return ultrasonic | both | odometry


def _motion(f: F, reported: F) -> dict[str, Array]:
    return {
        "vehicle.body": np.array(BODIES, dtype=float)[f["body"].astype(int)],
        "vehicle.car.steering.rate_limit": reported["car.steering.rate_limit"] * f["steering_rate"],
        "vehicle.steering.backlash": np.radians(f["backlash"]),
        "vehicle.steering.dead_time": f["dead_time"],
        "vehicle.steering.lag": f["lag"],
        **{f"vehicle.road.grip[{wheel}]": f["grip"] for wheel in range(1, 5)},
        "vehicle.road.grade": 0.01 * f["slope"],
        "vehicle.road.cross_slope": 0.01 * f["bank"],
        "vehicle.drive.brake_lag": f["brake_lag"],
        "vehicle.drive.drive_lag": f["drive_lag"],
        "vehicle.drive.acceleration_limit": _acceleration(f),
        "vehicle.drive.deceleration_limit": f["deceleration"],
        "step": np.array(STEPS)[f["exchange"].astype(int)],
    }


def _person(f: F, size: F) -> dict[str, Array]:
    """Return a pedestrian who crosses the road straight, into the slot or out of it, or between the cars beside it.

    No pedestrian appears suddenly: one from between cars has stood between them, one out of the slot comes from
    behind its end. Where that is a wall the pedestrian goes in.
    """
    x, slot_end = f["person_place"] * size["slot"], _slot_end(f, size)
    in_gap = (x > -0.5 * PERSON_WIDTH) & (x < size["slot"] + 0.5 * PERSON_WIDTH)
    walks, outward = f["person"] >= NOBODY, (f["person"] > NOBODY) & ~(in_gap & (f["behind"] == WALLED))
    out_from = np.where(in_gap, slot_end - FROM_BEHIND, BETWEEN)
    into = np.where(crosses_slot(f["person_place"]), slot_end - PERSON_WIDTH, NEAR_SIDE)
    begin, end = np.where(outward, out_from, FAR_SIDE), np.where(outward, FAR_SIDE, into)
    speed = f["person_speed"] * np.sign(end - begin)
    box = {
        "x": x,
        "y": size["sign"] * begin,
        "length": np.where(walks, PERSON_WIDTH, 0.0),
        "width": np.full_like(x, PERSON_WIDTH),
        "appear_at": f["person_at"],
        "disappear_at": f["person_at"] + (end - begin) / speed,
        "speed_y": size["sign"] * speed,
        "moves_at": f["person_at"],
    }
    return {f"scene.boxes[4].{name}": values for name, values in box.items()}


def crosses_slot(place: Array) -> NDArray[np.bool_]:
    """Return whether a pedestrian who crosses at this share of the slot's length walks through the slot."""
    return np.asarray((place > 0.1) & (place < 0.9))


def _mover(f: F, size: F) -> dict[str, Array]:
    """Return how a neighbour moves: along the road in a parallel row, across it in a perpendicular one."""
    found: dict[str, Array] = {}
    travel, speed = f["mover_travel"], f["mover_speed"]
    for number, towards in ((1, 1.0), (2, -1.0)):
        moves = f["mover"] == NOBODY + number - 1
        along = np.where(moves, np.sign(travel) * speed, 0.0)
        box = {
            "speed_x": np.where(size["parallel"], towards * along, 0.0),
            "speed_y": np.where(size["parallel"], 0.0, size["sign"] * along),
            "moves_at": f["mover_at"],
            "halts_at": f["mover_at"] + np.abs(travel) / speed,
        }
        found |= {f"scene.boxes[{number}].{name}": values for name, values in box.items()}
    return found


def _sensor_faults(f: F, reported: F) -> dict[str, Array]:
    """Return what the controller hears of a sensor that fails: nothing in reach, or no number."""
    value = np.where(f["lost"] == NO_SENSOR, reported["car.ultrasonic.max_range"], np.nan)
    found: dict[str, Array] = {}
    for number in range(SENSOR_COUNT):
        lost = (f["lost"] >= NO_SENSOR) & (f["lost_sensor"] == number)
        found[f"faults[{number + 1}].start"] = np.where(lost, f["lost_at"], NEVER_TIME)
        found[f"faults[{number + 1}].value"] = np.where(lost, value, 0.0)
    return found
