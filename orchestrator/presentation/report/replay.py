"""The replay page of one run."""

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fmus.files import write_whole
from orchestrator.evaluation.verdict.judge import Check
from orchestrator.evaluation.verdict.limit_text import limit_text
from orchestrator.evaluation.verdict.summary import Final, Summary
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.quantities import RAD_PER_DEGREE
from orchestrator.inputs.text.readable import changes_text, readable
from orchestrator.presentation.drawing.decimation import decimate
from orchestrator.presentation.log.line import Line
from orchestrator.presentation.report.charts import charts_of
from orchestrator.presentation.report.page import page
from orchestrator.presentation.report.payload import Arrays
from orchestrator.presentation.report.plots import plots_of
from orchestrator.presentation.report.run_data import ribbons_of, run_data
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording

MOST_ROWS = (2400, 1200, 600, 300)
LARGEST_PAGE = 1_000_000
KEYS = (
    "Keys: space plays, arrows step 0.1 s (shift: 1 s), Home, End, < and > change speed, + and - zoom the top view, "
    "Z (with shift) zooms the time, M sets a second cursor, F shows everything, C follows. "
    "Click a plot to go there, drag to zoom, double-click for all. Ctrl and wheel zoom the top view."
)
KINDS = {"parked": "good", "finished": "good", "not_parked": "warn", "not_finished": "warn", "failed": "bad"}


def write_replay(
    path: Path,
    recording: Recording,
    summary: Summary,
    words: list[Line],
    live: str = "",
    optimal_path: Array | None = None,
) -> None:
    """Write the page of a run to ``path``; fewer instants are kept if it would pass 1 MB."""
    write_whole(path, replay_page(recording, summary, words, live, optimal_path))


def replay_page(
    recording: Recording, summary: Summary, words: list[Line], live: str = "", optimal_path: Array | None = None
) -> str:
    """Return the page of a run; ``live``: where the page is on which it is driven.

    ``optimal_path``: points (p, 2) [m] of the time-optimal motion, drawn beside the planned path.

    Raises ``BadInput`` if the run has no instant to show.
    """
    if not recording.count:
        raise BadInput("the run has no instant to show")
    shown = decimate(recording, [check.t for check in summary.checks])
    whole = recording if shown is not recording else None
    extras = PageExtras(live, optimal_path)
    return page_of_limited_size(lambda most: _page(shown, summary, words, most, extras, whole))


def page_of_limited_size(page_of: Callable[[int], str]) -> str:
    """Return the page with the most instants that stays below 1 MB; ``page_of`` makes it with at most so many."""
    text = ""
    for most in MOST_ROWS:
        text = page_of(most)
        if len(text.encode()) < LARGEST_PAGE:
            break
    return text


class PageExtras(NamedTuple):
    """What few pages have besides the run."""

    live: str
    """Where the page is on which the run is driven; empty: nowhere."""
    optimal_path: Array | None
    """Points (p, 2) [m] of the time-optimal motion."""


def _page(
    recording: Recording, summary: Summary, words: list[Line], most: int, extras: PageExtras, whole: Recording | None
) -> str:
    arrays = Arrays()
    scenario = recording.info.get("scenario", {})
    changes = changes_text(summary.overrides)
    title = str(scenario.get("title") or summary.scenario) + (f" - with {changes}" if changes else "")
    about = scenario.get("description")
    about = f"unchanged: {about}" if changes and about else about
    keep = [check.t for check in summary.checks]
    run = run_data(recording, arrays, words, label="", most=most, keep=keep, whole=whole)
    run["checks"] = check_rows(summary.checks)
    if extras.optimal_path is not None:
        run["scene"]["optimum"] = np.round(extras.optimal_path - np.array(run["scene"]["origin"]), 3).tolist()
    header = {
        "title": title,
        "name": summary.scenario,
        "subtitle": " \u00b7 ".join(str(item) for item in (summary.scenario, about) if item),
        "verdict": verdict(summary),
        "facts": facts(summary),
        "plots": plots_of([recording], summary.checks, []),
        "ribbons": ribbons_of([recording]),
        "runs": [run],
        "foot": foot(recording, run["rows"]),
        "live": extras.live,
        "charts": charts_of(recording),
    }
    return page(title, arrays.pack(header))


def verdict(summary: Summary) -> dict[str, str]:
    """Return the outcome in words and its colour."""
    return {"text": summary.outcome.replace("_", " "), "kind": KINDS.get(summary.outcome, "bad")}


def facts(summary: Summary) -> list[list[str]]:
    """Return the few numbers that stand above everything else; why, if the task is not done."""
    words = ([] if summary.is_done else [summary.reason.replace("_", " ")]) + summary.standing
    why = [["Why" if not summary.is_done else "Stands", "; ".join(words)]] if words else []
    return [
        *why,
        *(["Note", note] for note in summary.notes),
        ["Duration", f"{summary.duration:.2f} s"],
        ["Manoeuvres", "not counted" if summary.manoeuvres is None else str(summary.manoeuvres)],
        ["Fastest", f"{summary.max_speed * 3.6:.1f} km/h"],
        *_standing(summary.final, {check.signal for check in summary.checks}),
    ]


def _standing(final: Final, judged: set[str]) -> Iterator[list[str]]:
    """Yield how the car stands, as far as the scenario says where it should.

    What no check judges is said to be free.
    """
    if math.isfinite(final.lateral_error):
        free = "" if "final.longitudinal_error" in judged else " (free to choose)"
        yield ["From the target: across", length(final.lateral_error)]
        yield [f"along{free}", length(final.longitudinal_error)]
        yield ["turned", f"{final.heading_error / RAD_PER_DEGREE:+.2f}\u00b0"]
    if math.isfinite(final.outline_margin):
        yield ["Inside the slot by", length(final.outline_margin)]


def length(value: float) -> str:
    """Return a signed length: centimetres where a car is parked, metres where it is not."""
    return f"{value * 100:+.1f} cm" if abs(value) < 1.0 else f"{value:+.2f} m"


def check_rows(checks: list[Check]) -> list[dict[str, Any]]:
    """Return the checks as the page shows them: numbers with their unit."""
    return [
        {
            "id": check.id,
            "passed": check.passed,
            "required": check.required,
            "evaluated": check.evaluated,
            "value_text": check.note or readable(check.value, check.unit),
            "limit_text": limit_text(check),
            "margin_text": readable(check.margin, check.unit),
            "t": check.t,
            "source": check.source,
        }
        for check in checks
    ]


def foot(recording: Recording, rows: list[Any]) -> str:
    """Return where the page's numbers come from."""
    version = recording.info.get("versions", {}).get("apa-cosim", "")
    kept, all_rows, deviation = rows
    return (
        f"apa-cosim {version}. {kept} of {all_rows} instants shown, off by at most {100 * deviation:.2g} % of a "
        f"signal's range; states change at their exact times. {KEYS}"
    )
