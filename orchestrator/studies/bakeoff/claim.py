"""The claim of Guo 2015 as a success rate: path tracking with and without point tracking, under speed errors."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from orchestrator.evaluation.verdict.confidence import wilson
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.requirements import library_requirements
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import console
from orchestrator.presentation.drawing.save import save
from orchestrator.studies.bakeoff.figure import COLOURS
from orchestrator.studies.sweep.columns import WITHIN
from orchestrator.studies.sweep.fields import find_field
from orchestrator.studies.sweep.study.cases import LabelledScenario, design_of, with_samples
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.table import Table

DRIVER_SPEED = 0.8
"""Speed the driver means [m/s]."""
FASTEST, SLOWEST = 1.0, -0.5
"""Uniform relative error of the speed driven."""
MAX_SPEED_OSCILLATION = 0.3
"""Largest amplitude of its swing [m/s], uniform from 0."""
SYSTEMS = ("ntbptcwpt", "ntbpt")
STEERING = {"30 deg/s": "guo2015-case4", "105 deg/s": "guo2015-case4-105"}
"""Rate of the front wheels, of Table 1 and of Fig. 12, and the scenario that has it."""
ERROR = "vehicle.driver.speed_error"
LIMITS = {"Guo 2015": "guo2015", "GB/T 41630": "gbt41630"}
"""The sets of limits that a success is judged by."""
SHOWN = "GB/T 41630"
"""What a success is judged by in the picture."""
HISTOGRAM_BINS = 24


class Setting(NamedTuple):
    """One system at one steering rate, judged by one limit."""

    system: str
    steering: str
    limit: str


class Rate(NamedTuple):
    """A success rate and its 95 % confidence interval (Wilson)."""

    group: Setting
    runs: int
    successes: int
    low: float
    high: float

    @property
    def rate(self) -> float:
        """Successes over runs."""
        return self.successes / self.runs


def study(drivers: int = 10_000, seed: int = 1) -> Study:
    """Return both systems at both steering rates with ``drivers``, the same for all.

    The driver obeys stop and direction prompts after 0.1 to 0.6 s, but no slow-down prompts.
    """
    cases = [
        LabelledScenario({"system": system, "steering": steering}, _scenario(scenario, system))
        for steering, scenario in STEERING.items()
        for system in SYSTEMS
    ]
    scenario, design = design_of(cases)
    rng = np.random.default_rng(seed)
    drawn = {
        ERROR: rng.uniform(SLOWEST, FASTEST, drivers),
        "vehicle.driver.speed_oscillation_amplitude": rng.uniform(0.0, MAX_SPEED_OSCILLATION, drivers),
        "vehicle.driver.speed_oscillation_period": rng.uniform(1.0, 6.0, drivers),
        "vehicle.driver.reaction_delay": rng.uniform(0.1, 0.6, drivers),
    }
    samples = {find_field(key, scenario): values for key, values in drawn.items()}
    content = {
        "name": "guo2015-claim",
        "title": "Path tracking with and without point tracking under driver speed errors",
        "description": f"The driver aims at {DRIVER_SPEED} m/s, errs by {SLOWEST:+.0%} to {FASTEST:+.0%}, "
        f"oscillates by up to {MAX_SPEED_OSCILLATION} m/s, and ignores the prompt to slow down.",
        "map": {"x": ERROR, "y": "steering", "split": "system"},
        "drivers": drivers,
        "seed": seed,
    }
    within = {limit: list(library_requirements(name)) for limit, name in LIMITS.items()}
    return Study(scenario, with_samples(design, samples), content, within=within)


def rates(columns: Mapping[str, Any]) -> list[Rate]:
    """Return the success rates of a table, by the names of its columns."""
    found = []
    for steering in STEERING:
        for system in SYSTEMS:
            mine = (columns["system"] == system) & (columns["steering"] == steering)
            parked = mine & (columns["outcome"] == "parked")
            for limit in LIMITS:
                won = parked & columns[WITHIN.format(limit)]
                found.append(rate_of(Setting(system, steering, limit), int(mine.sum()), int(won.sum())))
    return found


def rate_of(group: Setting, runs: int, successes: int) -> Rate:
    """Return the rate with Wilson's 95 % interval."""
    return Rate(group, runs, successes, *wilson(successes, runs))


def report(table: Table, folder: Path) -> int:
    """Print the rates and write their picture. Returns 0."""
    columns = {
        name: table.column(name) for name in ("system", "steering", "outcome", ERROR, *map(WITHIN.format, LIMITS))
    }
    to = console()
    for item in rates(columns):
        group = item.group
        to.print(
            f"{group.system}, wheels {group.steering}, {group.limit}: {100 * item.rate:.2f} % of {item.runs} drives "
            f"with driver speed errors parked (95 %: {100 * item.low:.2f} to {100 * item.high:.2f} %)"
        )
    to.print(f"picture in {draw(columns, folder / 'guo2015-claim.png')}", markup=False)
    return 0


def draw(columns: Mapping[str, Any], file: Path) -> Path:
    """Write the success rate over the mean speed driven; return the path."""
    speed = DRIVER_SPEED * (1.0 + columns[ERROR])
    edges = np.linspace(speed.min(), speed.max(), HISTOGRAM_BINS + 1)
    place = np.clip(np.digitize(speed, edges) - 1, 0, HISTOGRAM_BINS - 1)
    won = (columns["outcome"] == "parked") & columns[WITHIN.format(SHOWN)]
    figure, axis = plt.subplots(figsize=(7.0, 4.4), layout="constrained")
    for steering in STEERING:
        for system in SYSTEMS:
            mine = (columns["system"] == system) & (columns["steering"] == steering)
            rate = [
                100.0 * won[mine & (place == k)].mean() if (mine & (place == k)).any() else np.nan
                for k in range(HISTOGRAM_BINS)
            ]
            style = "o-" if steering.startswith("30 ") else "o:"
            label = f"{system}, wheels {steering}"
            axis.plot(0.5 * (edges[1:] + edges[:-1]), rate, style, markersize=3, color=COLOURS[system], label=label)
    title = f"within {SHOWN} despite driver speed errors, {len(speed) // (len(STEERING) * len(SYSTEMS))} runs each"
    axis.set(xlabel="mean speed driven [m/s]", ylabel="%", ylim=(-3, 103), title=title)
    axis.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 0.08))
    axis.grid(alpha=0.25, linewidth=0.6)
    axis.spines[["top", "right"]].set_visible(False)
    save(figure, file, dpi=110)
    plt.close(figure)
    return file


def _scenario(name: str, system: str) -> Scenario:
    sets = [f"vehicle.driver.profile[1].speed={DRIVER_SPEED}", "vehicle.driver.profile[2].at=1e9"]
    return load_scenario(name, [*sets, f"controller.system={system}", "stop_time=120", "requirements=[gbt41630]"])
