"""Attack the planner: random scenes with hardly any room, then replanning on the way; shapely judges each path."""

import random
from collections.abc import Iterator
from pathlib import Path

from controller_fmu.parking.planning.planner import PlanningStatus
from fmus.compiler import translate
from tests.compiler.c_model import CModel
from tests.planning import plan_model
from tests.planning.tight_scenes import TightScene, draw_scene, mistake_of, planned_by, replanned


def fuzz(folder: Path, log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """Yield each scene's seed and what is wrong with the answer, empty if nothing is."""
    planner = CModel(plan_model.MODEL, translate(plan_model.MODEL), folder)
    while True:
        seed = draw.randrange(1 << 32)
        scene = draw_scene(seed)
        plan = planned_by(planner, scene)
        yield ["planner", str(seed)], _told(scene, mistake_of(scene, plan))
        if plan.status == PlanningStatus.PLANNED:
            again = replanned(scene, plan, seed)
            yield ["planner", str(seed), "replanning"], _told(again, mistake_of(again, planned_by(planner, again)))


def _told(scene: TightScene, mistake: str) -> str:
    return f"{mistake}\n{scene.request}\n{scene.polygons}" if mistake else ""
