"""From factors to parameters: the scene of ``apa-world`` with rows of cars, hitches, pillars, bins and a far side.

Slots are as there: the ground truth is the free length between what bounds the slot at its mouth, less what stands out
into it. Nothing overlaps that could not: neighbours stand before the wall or kerb and beside the pillar, what stands
beside the road keeps clear of the driver's pass, and nobody walks through a car.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.parking_world.angled import Turned, limit_in_angled_rows, onto_angle
from orchestrator.studies.parking.parking_world.bays import first_bay, with_bays
from orchestrator.studies.parking.parking_world.bend import Moved, limit_in_bends, onto_bend
from orchestrator.studies.parking.parking_world.driver_pass import (
    CLEAR_OF_PASS,
    LET_PASS,
    DriverPass,
    driver_pass,
    far_edge,
    last_time_at,
    near_edge,
)
from orchestrator.studies.parking.parking_world.factors import NONE, PARKED_CARS, RACK, WALL
from orchestrator.studies.parking.parking_world.pedestrian import (
    FIRST_LEG,
    HALF_ROOM,
    SECOND_LEG,
    WalkingSpace,
    pedestrian_boxes,
)
from orchestrator.studies.parking.world import scene as world
from orchestrator.studies.parking.world.factors import NO_SENSOR, NOBODY
from orchestrator.studies.sweep.study.space import Seeds

F = Mapping[str, Array]
Boxes = dict[int, dict[str, Array]]
NEIGHBOUR = {"a": 1, "b": 2}
ROWS = {"a": (5, 6, 7), "b": (8, 9, 10)}
"""Boxes of the neighbours, and of the cars beyond each."""
OVERHANG, OPPOSITE, PILLAR, BIN = 11, 12, 13, 14
PILLAR_AT = {"a": 2, "b": 3}
"""Choices of the factor ``pillar``."""
HITCH_WIDTH, RACK_WIDTH = 0.08, 1.4
PILLAR_SIDE, PILLAR_INSET = 0.4, 0.6
PILLAR_ROOM = 0.1
"""Between a pillar and the neighbour beside it [m]."""
BIN_SIDE = 0.6
FAR_CAR_WIDTH, FAR_SIDE_ROOM = 1.8, 0.9
"""Width of cars across the road, and what the driver leaves to them [m]."""
WALL_ROOM = 0.05
"""Neighbours stand at least this far [m] before what ends the slot."""
KERB_SHARE = 0.1
"""Of the depth drawn: so a car flush with its neighbours stands 20 to 35 cm from the kerb of a parallel slot."""
MOVER_ROOM = 0.1
"""A moving neighbour stops this far [m] before what stands beside it."""


def parameters(f: F, seeds: Seeds) -> dict[str, Array]:
    """Return what differs from run to run, by the names of a study's fields."""
    f = limit_in_angled_rows(limit_in_bends(with_bays(f)))
    f = {**f, "depth": _depth(f)}
    straight = world.parameters(f, seeds)
    found = dict(straight)
    parallel = f["kind"] == 0
    sign = 1.0 - 2.0 * f["side"]
    slot = np.where(parallel, found["slot.length"], found["slot.width"])
    for which, towards in (("a", -1.0), ("b", 1.0)):
        shift = np.where(f["pillar"] == PILLAR_AT[which], towards * (PILLAR_SIDE + PILLAR_ROOM), 0.0)
        found[f"scene.boxes[{NEIGHBOUR[which]}].x"] = found[f"scene.boxes[{NEIGHBOUR[which]}].x"] + shift
    swept = driver_pass(f, found, slot)
    rows = _rows(f, found, swept)
    found |= _mover_stops(f, found, rows, swept) | first_bay(f, found)
    surroundings = _surroundings(f, found, slot, swept)
    space = _walking_space(f, found, rows, surroundings, slot)
    for box, values in (rows | surroundings | pedestrian_boxes(f, space, swept)).items():
        for name, value in values.items():
            mirrored = sign if name in ("y", "speed_y") else 1.0
            found[f"scene.boxes[{box}].{name}"] = mirrored * value + 0.0 * slot
    found |= {
        "vehicle.road.ramp.y": sign * 0.5 * (f["stagger_a"] + f["stagger_b"]),
        "vehicle.road.ramp.heading": np.where(f["side"] == 0, np.pi, 0.0),
        "vehicle.road.ramp.grade": np.where(parallel, 0.0, 0.01 * (f["ramp"] + sign * f["bank"])),
    }
    moved = Moved((*ROWS["a"], *ROWS["b"]), (FIRST_LEG, SECOND_LEG), OVERHANG)
    found = onto_bend(f, straight, found | _silent(f, found), seeds, moved)
    return onto_angle(f, found, Turned((*NEIGHBOUR.values(), *ROWS["a"], *ROWS["b"]), OVERHANG, BIN))


def _depth(f: F) -> Array:
    """Return the depth over ISO 16787's [m]: at least so much that the neighbours stand before what ends the slot."""
    parallel, kerb = f["kind"] == 0, f["behind"] == world.WITH_KERB
    drawn = np.where(parallel & kerb, KERB_SHARE * f["depth"], f["depth"])
    nominal = world.parameters({**f, "depth": 0.0 * drawn}, np.ones(len(drawn), dtype=int))
    depth = np.where(parallel, nominal["slot.width"], nominal["slot.length"])
    mouth = 0.5 * (f["stagger_a"] + f["stagger_b"])
    inner = np.minimum(*(_neighbour_extent(f, nominal, which, "y")[0] for which in NEIGHBOUR))
    return np.where(parallel & (f["behind"] != NONE), np.maximum(drawn, mouth - inner + WALL_ROOM - depth), drawn)


def _neighbour_extent(f: F, found: F, which: str, axis: str) -> tuple[Array, Array]:
    """Return least and greatest x or y [m] of a neighbour, for a slot on the right."""
    box = f"scene.boxes[{NEIGHBOUR[which]}]"
    cos, sin = np.cos(found[f"{box}.heading"]), np.abs(np.sin(found[f"{box}.heading"]))
    length, width = found[f"{box}.length"], found[f"{box}.width"]
    half = 0.5 * (length * cos + width * sin if axis == "x" else length * sin + width * cos)
    middle = found[f"{box}.{axis}"] * ((1.0 - 2.0 * f["side"]) if axis == "y" else 1.0)
    return middle - half, middle + half


def _rows(f: F, found: F, swept: DriverPass) -> Boxes:
    """Return the boxes of the cars beyond both neighbours: as many as keep clear of the driver's pass."""
    parallel = f["kind"] == 0
    boxes: Boxes = {}
    for which, towards in (("a", -1.0), ("b", 1.0)):
        along = np.where(parallel, f[f"length_{which}"], f[f"width_{which}"])
        across = np.where(parallel, f[f"width_{which}"], f[f"length_{which}"])
        x = found[f"scene.boxes[{NEIGHBOUR[which]}].x"]
        for place, box in enumerate(ROWS[which]):
            x = x + towards * (along + f[f"gap_{which}"])
            clear = near_edge(swept, x - 0.5 * along, x + 0.5 * along) - f[f"stagger_{which}"] >= CLEAR_OF_PASS
            boxes[box] = {
                "x": x,
                "y": f[f"stagger_{which}"] - 0.5 * across,
                "length": np.where((f[f"cars_{which}"] > place) & clear, along, 0.0),
                "width": across,
            }
    return boxes


def _surroundings(f: F, found: F, slot: Array, swept: DriverPass) -> Boxes:
    """Return the boxes of the hitch or rack, of what stands across the road, of pillar and bin."""
    parallel = f["kind"] == 0
    mouth = 0.5 * (f["stagger_a"] + f["stagger_b"])
    far = np.maximum(mouth + f["street"], far_edge(swept, swept.x, swept.end) + FAR_SIDE_ROOM)
    at_a = f["pillar"] == PILLAR_AT["a"]
    inset = np.where(parallel, 0.0, PILLAR_INSET)
    return {
        OVERHANG: _overhang(f, found, swept),
        OPPOSITE: {
            "x": 0.5 * slot,
            "y": far + 0.5 * FAR_CAR_WIDTH,
            "length": np.where(f["opposite"] == NONE, 0.0, np.where(f["opposite"] == WALL, 60.0, 30.0)),
            "width": np.where(f["opposite"] == PARKED_CARS, FAR_CAR_WIDTH, 1.0),
        },
        PILLAR: {
            "x": np.where(at_a, -0.5 * PILLAR_SIDE, slot + 0.5 * PILLAR_SIDE),
            "y": np.where(at_a, f["stagger_a"], f["stagger_b"]) - 0.5 * PILLAR_SIDE - inset,
            "length": np.where(f["pillar"] >= PILLAR_AT["a"], PILLAR_SIDE, 0.0),
            "width": np.full_like(slot, PILLAR_SIDE),
        },
        BIN: {
            "x": 0.5 * slot,
            "y": mouth - 1.0,
            "length": np.where(has_bin(f), BIN_SIDE, 0.0),
            "width": np.full_like(slot, BIN_SIDE),
        },
    }


def has_bin(f: F) -> NDArray[np.bool_]:
    """Return whether a bin stands in the slot."""
    return np.asarray(f["bin"] == 9)


def has_overhang(f: F) -> NDArray[np.bool_]:
    """Return whether a hitch or rack stands out: from a parallel neighbour there is none behind a pillar."""
    return np.asarray((f["overhang"] != NONE) & ((f["kind"] != 0) | (f["pillar"] != PILLAR_AT["a"])))


def overhang_of(f: F) -> Array:
    """Return by how much [m] a hitch or rack shortens the slot: beside a parallel slot it stands out into it."""
    return np.where((f["kind"] == 0) & has_overhang(f), f["overhang_length"], 0.0)


def _overhang(f: F, found: F, swept: DriverPass) -> dict[str, Array]:
    """Return the hitch or rack at the first neighbour: into a parallel slot, or out into the road."""
    parallel = f["kind"] == 0
    width = np.where(f["overhang"] == RACK, RACK_WIDTH, HITCH_WIDTH)
    x = found["scene.boxes[1].x"]
    _, face = _neighbour_extent(f, found, "a", "x")
    _, outer = _neighbour_extent(f, found, "a", "y")
    clear = near_edge(swept, x - 0.5 * width, x + 0.5 * width) - outer - CLEAR_OF_PASS
    length = np.where(parallel, f["overhang_length"], np.clip(clear, 0.0, f["overhang_length"]))
    moved = {name: found[f"scene.boxes[1].{name}"] for name in ("speed_x", "moves_at", "halts_at")}
    return {
        "x": np.where(parallel, face + 0.5 * length, x),
        "y": np.where(parallel, f["stagger_a"] - 0.5 * f["width_a"], outer + 0.5 * length),
        "length": np.where(has_overhang(f) & (length > 0.0), np.where(parallel, length, width), 0.0),
        "width": np.where(parallel, width, length),
        **moved,
        "speed_y": found["scene.boxes[1].speed_y"] * (1.0 - 2.0 * f["side"]),
    }


def _mover_stops(f: F, found: F, rows: Boxes, swept: DriverPass) -> dict[str, Array]:
    """Return when neighbours move: along a row up to the next car or pillar, out of one once the driver has passed."""
    times: dict[str, Array] = {}
    parallel, travel = f["kind"] == 0, f["mover_travel"]
    moved = np.abs(travel)
    for which, number in NEIGHBOUR.items():
        low, high = _neighbour_extent(f, found, which, "x")
        beyond = rows[ROWS[which][0]]
        half = 0.5 * beyond["length"]
        to_row = low - (beyond["x"] + half) if which == "a" else beyond["x"] - half - high
        to_row = np.where(beyond["length"] > 0.0, to_row, np.inf)
        to_pillar = np.where(f["pillar"] == PILLAR_AT[which], PILLAR_ROOM, np.inf)
        room = np.maximum(np.where(travel > 0.0, to_pillar, to_row) - MOVER_ROOM, 0.0)
        passed = last_time_at(swept, high + swept.rear) + LET_PASS
        at = np.where(~parallel & (travel > 0.0), np.maximum(f["mover_at"], passed), f["mover_at"])
        times[f"scene.boxes[{number}].moves_at"] = at
        times[f"scene.boxes[{number}].halts_at"] = (
            at + np.where(parallel, np.minimum(moved, room), moved) / f["mover_speed"]
        )
    return times


def _walking_space(f: F, found: F, rows: Boxes, surroundings: Boxes, slot: Array) -> WalkingSpace:
    """Return where a pedestrian may walk: beside a neighbour in the gap to the next car, or beyond the row."""
    beside = {}
    for which, towards in (("a", -1.0), ("b", 1.0)):
        low, high = _neighbour_extent(f, found, which, "x")
        outer = low if which == "a" else high
        nearest = outer + towards * (np.abs(f["mover_travel"]) * (f["mover"] >= NOBODY) + HALF_ROOM)
        place = nearest
        for box in ROWS[which]:
            there = rows[box]["length"] > 0.0
            inner, end = (rows[box]["x"] + side * towards * 0.5 * rows[box]["length"] for side in (-1.0, 1.0))
            blocked = there & (towards * (inner - place) < HALF_ROOM)
            place = np.where(blocked, end + towards * HALF_ROOM, place)
        beside[which] = place
    depth = np.where(f["kind"] == 0, found["slot.width"], found["slot.length"])
    slot_end = 0.5 * (f["stagger_a"] + f["stagger_b"]) - depth
    across = surroundings[OPPOSITE]
    opposite = np.where(across["length"] > 0.0, across["y"] - 0.5 * across["width"], np.inf)
    return WalkingSpace(beside["a"], beside["b"], slot, slot_end, opposite, ~has_bin(f))


def _silent(f: F, found: F) -> dict[str, Array]:
    """Return the faults of more than one sensor: those that follow the one that is drawn, around the car."""
    value = np.where(f["lost"] == NO_SENSOR, found["vehicle.car.ultrasonic.max_range"], np.nan)
    changed: dict[str, Array] = {}
    for number in range(world.SENSOR_COUNT):
        after = (number - f["lost_sensor"]) % world.SENSOR_COUNT
        lost = (f["lost"] >= NO_SENSOR) & (after <= f["lost_count"])
        changed[f"faults[{number + 1}].start"] = np.where(lost, f["lost_at"], world.NEVER_TIME)
        changed[f"faults[{number + 1}].value"] = np.where(lost, value, 0.0)
    return changed
