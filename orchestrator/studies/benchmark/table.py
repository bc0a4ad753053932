"""The table of a benchmark for people, as CSV and as JSON, and the figures of each group of scenes."""

import csv
import io
import math
import statistics
from collections.abc import Sequence
from typing import Any, NamedTuple

from orchestrator.studies.benchmark.driving import DOUBLE_TRACK, KINEMATIC, DrivenScene
from orchestrator.studies.benchmark.scenes import OptimumFigures, SceneRow, plain_figures, row_as_json

BODY_TEXTS = {KINEMATIC: "kinematic", DOUBLE_TRACK: "double track"}


class GroupFigures(NamedTuple):
    """Figures of all scenes of a group."""

    group: str
    scenes: int
    planned: int
    parked: dict[str, int]
    """Body -> scenes parked without contact."""
    contacts: dict[str, int]
    """Body -> scenes with contact."""
    planning_median: float
    """Processor time [s]."""
    planning_worst: float
    slowest_sample: float
    optima: int
    """Valid ones."""
    time_ratio: float
    """Median of driven over optimal time; NaN without an optimum."""
    length_ratio: float

    def line(self) -> str:
        """Return the figures as one sentence."""
        driven = ", ".join(
            f"{count} parked ({BODY_TEXTS[body]}), {self.contacts[body]} with contact"
            for body, count in self.parked.items()
        )
        return (
            f"{self.group}: {self.planned} of {self.scenes} planned, {driven}; "
            f"planning {self.planning_median * 1e3:.1f} ms median, {self.planning_worst * 1e3:.0f} ms worst, "
            f"slowest sample {self.slowest_sample * 1e3:.1f} ms{self._beside_optimum()}"
        )

    def _beside_optimum(self) -> str:
        if not self.optima:
            return ""
        ratios = f"time {self.time_ratio:.2f}, length {self.length_ratio:.2f}"
        return f"; {self.optima} valid optima, median of driven over optimal {ratios}"


def figures_of(rows: Sequence[SceneRow]) -> list[GroupFigures]:
    """Return the figures of each group, in the order of the rows."""
    return [_figures(group, [row for row in rows if row.scene.group == group]) for group in _groups(rows)]


def _groups(rows: Sequence[SceneRow]) -> list[str]:
    return list(dict.fromkeys(row.scene.group for row in rows))


def _figures(group: str, rows: Sequence[SceneRow]) -> GroupFigures:
    bodies = list(dict.fromkeys(body for row in rows for body in row.drives))
    driven = {body: [row.drives[body] for row in rows if body in row.drives] for body in bodies}
    times = [row.plan.time for row in rows]
    optima = [row.optimum for row in rows if row.optimum is not None and not row.optimum.reason]
    return GroupFigures(
        group,
        len(rows),
        sum(row.plan.found for row in rows),
        {body: sum(drive.parked for drive in driven[body]) for body in bodies},
        {body: sum(drive.contact for drive in driven[body]) for body in bodies},
        statistics.median(times),
        max(times),
        max(max(row.plan.sample_times, default=0.0) for row in rows),
        len(optima),
        statistics.median([item.time_ratio for item in optima] or [math.nan]),
        statistics.median([item.length_ratio for item in optima] or [math.nan]),
    )


def table_lines(rows: Sequence[SceneRow]) -> list[list[str]]:
    """Return head and rows of the table for people: of the last body all figures, of others whether it parked."""
    bodies = list(dict.fromkeys(body for row in rows for body in row.drives))
    head = ["scene", "planned", "slowest sample", "margin", *(BODY_TEXTS[body] for body in bodies)]
    head += ["clearance", "length", "moves", "time"]
    if all(row.optimum is None for row in rows):
        return [head, *(_line(row, bodies) for row in rows)]
    return [[*head, "time / optimum", "length / optimum"], *(_line(row, bodies) + _ratios(row) for row in rows)]


def _ratios(row: SceneRow) -> list[str]:
    """Return the cells beside the optimum; an invalid one is said to be so."""
    optimum = row.optimum
    if optimum is None:
        return ["", ""]
    return ["invalid", ""] if optimum.reason else [f"{optimum.time_ratio:.2f}", f"{optimum.length_ratio:.2f}"]


def _line(row: SceneRow, bodies: Sequence[str]) -> list[str]:
    plan = row.plan
    line = [row.scene.name, f"{plan.time * 1e3:.1f} ms" if plan.found else plan.reason]
    line += [f"{max(plan.sample_times, default=0.0) * 1e3:.2f} ms", f"{plan.margin * 100:.0f} cm" if plan.found else ""]
    line += [_result(row.drives.get(body)) for body in bodies]
    drive = row.drives.get(bodies[-1]) if bodies else None
    return [*line, *([""] * 4 if drive is None else _drive_cells(drive))]


def _result(drive: DrivenScene | None) -> str:
    if drive is None:
        return ""
    return "contact" if drive.contact else "parked" if drive.parked else drive.reason


def _drive_cells(drive: DrivenScene) -> list[str]:
    clearance, length = f"{drive.clearance * 100:.1f} cm", f"{drive.length:.1f} m"
    return [clearance, length, str(drive.manoeuvres), f"{drive.duration:.0f} s"]


def csv_text(rows: Sequence[SceneRow]) -> str:
    """Return the table as CSV: one line for each scene and body, SI units in the names of the columns."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    plan_head = ["planned", "reason", "steps", "margin [m]", "planning time [s]", "samples", "slowest sample [s]"]
    drive_head = ["parked", "contact", "clearance [m]", "length [m]", "manoeuvres", "time [s]", "drive reason"]
    optimum_head = ["optimal time [s]", "optimal length [m]", "time ratio", "length ratio", "optimum invalid"]
    writer.writerow(["group", "scene", "corners", *plan_head, "body", *drive_head, *optimum_head])
    for row in rows:
        plan = row.plan
        times = [plan.time, len(plan.sample_times), max(plan.sample_times, default=0.0)]
        first = [row.scene.group, row.scene.name, row.scene.corners]
        first += [plan.found, plan.reason, plan.steps, plan.margin, *times]
        for body, drive in row.drives.items() or [("", None)]:
            cells = [""] * len(drive_head) if drive is None else _drive_figures(drive)
            best = row.optimum if body == KINEMATIC else None
            figures = [""] * len(optimum_head) if best is None else _optimum_figures(best)
            writer.writerow([*first, body, *cells, *figures])
    return out.getvalue()


def _drive_figures(drive: DrivenScene) -> list[Any]:
    figures = [drive.parked, drive.contact, drive.clearance, drive.length, drive.manoeuvres, drive.duration]
    return [*figures, drive.reason]


def _optimum_figures(best: OptimumFigures) -> list[Any]:
    return [best.duration, best.length, best.time_ratio, best.length_ratio, best.reason]


def as_json(rows: Sequence[SceneRow], command: str) -> dict[str, Any]:
    """Return all rows and figures as plain data."""
    return {
        "command": command,
        "groups": [plain_figures(item) for item in figures_of(rows)],
        "scenes": [row_as_json(row) for row in rows],
    }
