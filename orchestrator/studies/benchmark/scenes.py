"""The scenes of a benchmark planned and driven, one row each; rows are kept, so that a long benchmark goes on later."""

import hashlib
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from fmus.contents.description import project_version
from fmus.files import write_whole
from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_files import sources_hash
from orchestrator.studies.benchmark.driving import BODIES, KINEMATIC, DrivenScene, SceneRun, drive_scene
from orchestrator.studies.benchmark.optimal.reference import find_optimum
from orchestrator.studies.benchmark.planning import FoundPlan, plan_scene

VALET_PREFIX = "valet-"
SEARCH = "search.active"
"""Parameter of the controller: it looks for its slot."""
ROWS = "rows"
SCENARIO_SUFFIXES = (".yaml", ".yml")


class Scene(NamedTuple):
    """One scenario of a benchmark."""

    name: str
    group: str
    """Folder that it was found in; ``shipped`` otherwise."""
    file: str
    """What ``apa run`` takes."""
    corners: int
    """Of its polygons."""
    key: str
    """Hash of all that its row depends on."""


class OptimumFigures(NamedTuple):
    """A drive on the kinematic body beside the time-optimal motion near it; NaN if that is not valid."""

    reason: str
    """Why it is not valid; empty if it is."""
    duration: float
    """Of the optimum [s]."""
    length: float
    """Of the optimum [m]."""
    time_ratio: float
    """Driven over optimal time."""
    length_ratio: float
    """Driven over optimal length."""


class SceneRow(NamedTuple):
    """What became of a scene."""

    scene: Scene
    plan: FoundPlan
    drives: dict[str, DrivenScene]
    """By body."""
    optimum: OptimumFigures | None = None

    @property
    def is_passed(self) -> bool:
        """Whether it was planned, and parked without contact on every body."""
        return self.plan.found and all(drive.parked for drive in self.drives.values())


def scenes_in(places: Sequence[str], bodies: Sequence[str], optimal: bool = False) -> list[Scene]:
    """Return the scenes that folders, files and names mean; without any, those shipped. Raises ``BadInput``."""
    found: list[tuple[str, str]] = []
    for place in places:
        folder = Path(place)
        if folder.is_dir():
            files = sorted((item for item in folder.iterdir() if item.suffix in SCENARIO_SUFFIXES), key=_natural)
            if not files:
                raise BadInput("no scenario (*.yaml) in this folder; apa import writes them", file=folder)
            found += [(folder.resolve().name, str(file)) for file in files]
        else:
            found.append((folder.resolve().parent.name if folder.is_file() else "shipped", place))
    if not places:
        found = [("shipped", name) for name in valet_scenarios()]
    asked = [[BODIES[body] for body in bodies], optimal, sources_hash(), project_version()]
    return [_scene(group, name, asked) for group, name in dict.fromkeys(found)]


def valet_scenarios() -> list[str]:
    """Return the names of the shipped scenarios whose goal is known and can be reached."""
    loaded = {name: load_scenario(name) for name in scenario_names() if name.startswith(VALET_PREFIX)}
    return [name for name, item in loaded.items() if item.expected_outcome == item.success and not detects_slot(item)]


def detects_slot(scenario: Scenario) -> bool:
    """Return whether the controller searches for its slot: then there is nothing to plan until the vehicle moves."""
    return bool(scenario.parameters_for("controller").get(SEARCH))


def _scene(group: str, name: str, asked: list[Any]) -> Scene:
    scenario = load_scenario(name)
    if scenario.target is None:
        raise BadInput("this scenario has no target to plan a path to", file=scenario.file, key="target")
    if detects_slot(scenario):
        raise BadInput(
            "true: the benchmark plans to a known goal; set it to false", file=scenario.file, key=f"controller.{SEARCH}"
        )
    key = hashlib.sha256(json.dumps([scenario.model_dump_json(), *asked]).encode()).hexdigest()[:32]
    return Scene(scenario.name, group, name, sum(map(len, scenario.obstacles)), key)


def _natural(path: Path) -> tuple[int, str]:
    return len(path.stem), path.name


def rows_of(
    scenes: Sequence[Scene],
    bodies: Sequence[str],
    fmus: tuple[Mapping[str, Path] | None, str],
    out: Path,
    interrupt: Interrupt,
    optimal: bool = False,
) -> Iterator[SceneRow]:
    """Yield the row of each scene, kept in ``out`` or new; none begins after an interrupt.

    ``fmus``: files of ours, and their kind. ``optimal``: beside the time-optimal motion, too.
    """
    for scene in scenes:
        if interrupt.requested:
            return
        file = out / ROWS / f"{scene.group}-{scene.name}.json"
        row = read_row(file, scene)
        if row is None:
            plan = plan_scene(load_scenario(scene.file))
            drives, runs = {}, {}
            for body in bodies if plan.found else ():
                drives[body], runs[body] = drive_scene(scene.file, body, *fmus, interrupt)
                if interrupt.requested:
                    return
            optimum = None
            if optimal and plan.found and KINEMATIC in runs:
                optimum = _optimum(drives[KINEMATIC], runs[KINEMATIC])
            row = SceneRow(scene, plan, drives, optimum)
            write_whole(file, json.dumps(row_as_json(row), indent=1) + "\n")
        yield row


def _optimum(drive: DrivenScene, run: SceneRun) -> OptimumFigures:
    """Return how a drive compares with the optimum near it; one that has not parked compares with none."""
    if not drive.parked:
        return OptimumFigures("the drive has not parked", *(math.nan,) * 4)
    found = find_optimum(run.scenario, run.recording)
    return OptimumFigures(found.reason, found.duration, found.length, found.time_ratio, found.length_ratio)


def read_row(file: Path, scene: Scene) -> SceneRow | None:
    """Return the row that an earlier benchmark has kept of the same scene, models and errors; None without one."""
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
        if data["key"] != scene.key:
            return None
        plan = FoundPlan(**{**data["plan"], "sample_times": tuple(data["plan"]["sample_times"])})
        drives = {body: DrivenScene(**_numbers(drive)) for body, drive in data["drives"].items()}
        optimum = data["optimum"] and OptimumFigures(**_numbers(data["optimum"]))
    except (OSError, ValueError, TypeError, KeyError):
        return None
    return SceneRow(scene, plan, drives, optimum)


def _numbers(drive: Mapping[str, Any]) -> dict[str, Any]:
    return {name: math.nan if value is None else value for name, value in drive.items()}


def row_as_json(row: SceneRow) -> dict[str, Any]:
    """Return a row as plain data: SI units, null for what is not known."""
    drives = {body: plain_figures(drive) for body, drive in row.drives.items()}
    optimum = None if row.optimum is None else plain_figures(row.optimum)
    plan = {**row.plan._asdict(), "sample_times": list(row.plan.sample_times)}
    return {**row.scene._asdict(), "passed": row.is_passed, "plan": plan, "drives": drives, "optimum": optimum}


def plain_figures(figures: Any) -> dict[str, Any]:
    """Return the fields of a NamedTuple as plain data, null for NaN."""
    return {name: None if value != value else value for name, value in figures._asdict().items()}
