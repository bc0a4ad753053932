"""Scenes of files: cases of TPCAP (CSV), scenes of ParkBench (JSON), or scenarios with a target (YAML).

The polygons of a scene are obstacles to the car and to the verdict. Its sensors measure the boxes of the vehicle's
scene only: the edges nearest to the target are put there, as many as there is room for.
"""

import math
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import yaml

from apa_cosim.gym.scene_source import Scenes, Seeds
from controller_fmu.policy.params import PolicyParams, PolicySystem
from controller_fmu.policy.standalone import MODEL
from modelkit.geometry import Point, line_box, point_gap
from modelkit.variables import variables
from orchestrator.evaluation.verdict.geometry import edges
from orchestrator.evaluation.verdict.polygons import Polygons
from orchestrator.evaluation.verdict.truth import join_truths
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.requirements import library_requirements
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.scenario.tpcap import read_tpcap
from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.benchmark.parkbench import read_parkbench
from orchestrator.studies.parking.cases import BODY
from orchestrator.studies.sweep.disturbed import numbers_for
from orchestrator.studies.sweep.job import Chunk, arrays, make_job, truths
from orchestrator.studies.sweep.study.design import Design
from orchestrator.studies.sweep.study.study import Study
from vehicle_fmu.scene import SceneParams

BOX_COUNT = len(SceneParams().boxes)
EDGE_WIDTH = 1e-6
"""Of a box that is an edge [m]."""
FARTHEST_SHARE = 2.0
"""A car that is this many times farther from its target than at its start has left the place."""
POSITION = ("final heading", "final lateral position")
"""What GB/T 41630 asks of the final pose."""
READERS = {".csv": read_tpcap, ".json": read_parkbench}
"""Suffix of a benchmark's file -> its reader."""
SUFFIXES = (*READERS, ".yaml", ".yml")


class FileScenes:
    """A scene for each file, also of folders; that of a seed is the file of the remainder. Raises ``BadInput``."""

    def __init__(self, files: Sequence[str | Path], body: str, stop_time: float, pedals: bool) -> None:
        if not files:
            raise BadInput("expected files of cases, or folders of them; they are not part of the package", key="files")
        read = [_policy_scenario(_scenario(file), body, stop_time, pedals) for file in _cases(files)]
        self._scenarios = read
        self.scenario = read[0].model_copy(update={"obstacles": []})
        runs = [(make_job(_study(item)), _chunk(item)) for item in read]
        made = [arrays(*run) for run in runs]
        self._lines, self._times = (np.concatenate(parts) for parts in zip(*made, strict=True))
        self._truth = join_truths([truths(*run) for run in runs])

    def scenes(self, seeds: Seeds) -> Scenes:
        """Return the scenes of ``seeds``."""
        at = seeds % len(self._scenarios)
        return Scenes(self._lines[at], self._times[at], numbers_for(self.scenario, seeds), self._truth.select(at))

    def scenario_of(self, seed: int) -> Scenario:
        """Return the scene of a seed as a complete scenario."""
        return self._scenarios[seed % len(self._scenarios)]

    def obstacles(self, seed: int) -> Polygons:
        """Return the polygons of the scene of a seed."""
        return self.scenario_of(seed).obstacles


def _cases(places: Sequence[str | Path]) -> list[Path]:
    """Return the files, in place of a folder those in it that can be read."""
    found: list[Path] = []
    for place in map(Path, places):
        inside = [item for item in place.iterdir() if item.suffix.lower() in SUFFIXES] if place.is_dir() else [place]
        if not inside:
            raise BadInput(f"no case ({', '.join(SUFFIXES)}) in this folder", file=place)
        found += sorted(inside, key=lambda item: (len(item.stem), item.name))
    return found


def _scenario(file: Path) -> Scenario:
    if not file.is_file():
        raise BadInput("no such file", file=file)
    reader = READERS.get(file.suffix.lower())
    if reader is None:
        return load_scenario(str(file))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{file.stem}.yaml"
        path.write_text(yaml.safe_dump(reader(file)), encoding="utf-8")
        return load_scenario(str(path)).model_copy(update={"file": str(file)})


def _policy_scenario(scenario: Scenario, body: str, stop_time: float, pedals: bool) -> Scenario:
    """Return a scenario that a policy drives: its car, target, slot and obstacles, judged by where the car stands."""
    if scenario.target is None or scenario.task != "park":
        raise BadInput("has no target to park at", file=scenario.file)
    known = {item.name for item in variables(MODEL.params)} - {"system"}
    own = {name: value for name, value in scenario.controller.items() if name in known}
    own |= {f"target.{name}": value for name, value in scenario.target.model_dump().items()}
    if scenario.slot is not None:
        own |= {f"slot.{name}": value for name, value in scenario.slot.model_dump().items()}
    away = math.hypot(*(scenario.vehicle.get(f"start.{name}", 0.0) - own[f"target.{name}"] for name in ("x", "y")))
    own["max_distance"] = max(PolicyParams().max_distance, FARTHEST_SHARE * away)
    limits = [item for item in library_requirements("gbt41630") if item.id in POSITION]
    return Scenario(
        name=scenario.name,
        title=scenario.title,
        source=scenario.source,
        stop_time=stop_time,
        vehicle={**scenario.vehicle, **_edges(scenario), "body": BODY[body]},
        controller={**own, "system": int(PolicySystem.POLICY), "action.pedals": pedals},
        target=scenario.target,
        slot=scenario.slot,
        obstacles=scenario.obstacles,
        requirements=limits,
    )


def _edges(scenario: Scenario) -> dict[str, float]:
    """Return boxes for the edges of the polygons that are nearest to the target, after those that the scene has."""
    assert scenario.target is not None
    sizes = [scenario.vehicle.get(f"scene.boxes[{number + 1}].length", 0.0) for number in range(BOX_COUNT)]
    free = [number + 1 for number, size in enumerate(sizes) if size == 0.0]
    target = Point(scenario.target.x, scenario.target.y)
    lines = [line_box(edge.x1, edge.y1, edge.x2, edge.y2) for edge in edges(scenario.obstacles)]
    lines.sort(key=lambda line: point_gap(target, line))
    found: dict[str, float] = {}
    for number, line in zip(free, lines, strict=False):
        box = line._replace(width=EDGE_WIDTH)._asdict()
        found |= {f"scene.boxes[{number}].{name}": value for name, value in box.items()}
    return found


def _study(scenario: Scenario) -> Study:
    return Study(scenario, Design([], np.empty((1, 0)), np.array([1])), {"name": scenario.name})


def _chunk(scenario: Scenario) -> Chunk:
    return Chunk(0, 0, np.empty((1, 0)), np.array([scenario.seed]))
