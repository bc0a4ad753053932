"""Case 5 of Guo 2015: no speed is printed, four numbers are. All pairs of speeds on a grid, and which of them fit."""

from typing import NamedTuple

import numpy as np

from controller_fmu.guo2015.phases import GuoPhase
from fmus.native.compilers import can_compile
from orchestrator.evaluation.verdict.measures import Instants, Measure
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.papers.result import PRINTED, Row, not_tested
from orchestrator.studies.sweep.in_memory import columns_in_memory
from orchestrator.studies.sweep.study.cases import LabelledScenario, design_of
from orchestrator.studies.sweep.study.study import Study

FASTER_AT = 18.5
"""When the driver speeds up, as printed [s]."""
SLOW_SPEEDS = tuple(np.round(np.linspace(0.24, 0.38, 29), 4).tolist())
FAST_SPEEDS = tuple(np.round(np.linspace(1.1, 2.0, 19), 4).tolist())
"""Speeds before and after that [m/s]."""
SLOW_KEY, FAST_KEY = "driver.profile[1].speed", "driver.profile[2].speed"


class PrintedNumber(NamedTuple):
    """A number of Fig. 13's text, how it is measured here, and what it may differ by."""

    item: str
    unit: str
    value: float
    limit: float
    measure: Measure


STOPPED = Instants("controller.phase", (int(GuoPhase.STOP),))
FORWARD = Instants("controller.phase", (int(GuoPhase.TO_Q4),))
STRAIGHTENING = Instants("controller.phase", (int(GuoPhase.STRAIGHTEN),))
NUMBERS = (
    PrintedNumber("arrives with heading", "rad", 0.065, 5e-3, Measure("first", "vehicle.pose.heading", STOPPED)),
    PrintedNumber("wheel is straightened at t", "s", 22.0, 0.5, Measure("time", "controller.phase", STRAIGHTENING)),
    PrintedNumber("forward, tracking Q4: y", "m", -3.058, 0.015, Measure("last", "vehicle.pose.y", FORWARD)),
    PrintedNumber(
        "forward, tracking Q4: heading", "rad", 0.002, 5e-3, Measure("last", "vehicle.pose.heading", FORWARD)
    ),
)


class SpeedFit(NamedTuple):
    """The pair of speeds nearest to the four numbers, and which pairs are within every limit."""

    slow: float
    fast: float
    values: tuple[float, ...]
    """The four numbers with that pair."""
    fitting: list[tuple[float, float]]


def fit_rows(run: str) -> list[Row]:
    """Return the four printed numbers beside those of the best pair of speeds, and the window of the pairs that fit."""
    if not can_compile():
        return [not_tested(f"{run}: {number.item}", "the search needs a C compiler") for number in NUMBERS]
    fit = fit_speeds(run, SLOW_SPEEDS, FAST_SPEEDS)
    note = f"at {fit.slow:g}, then {fit.fast:g} m/s"
    rows = [
        Row(run, number.item, number.unit, number.value, value, number.limit, note, PRINTED)
        for number, value in zip(NUMBERS, fit.values, strict=True)
    ]
    slow, fast = ([pair[k] for pair in fit.fitting] for k in (0, 1))
    window = "none"
    if fit.fitting:
        window = f"{min(slow):g} to {max(slow):g}, then {min(fast):g} to {max(fast):g} m/s"
    tried = len(SLOW_SPEEDS) * len(FAST_SPEEDS)
    item = f"all four fit with {len(fit.fitting)} of {tried} pairs of speeds, tried from {SLOW_SPEEDS[0]:g} to "
    item += f"{SLOW_SPEEDS[-1]:g}, then {FAST_SPEEDS[0]:g} to {FAST_SPEEDS[-1]:g} m/s"
    return [*rows, Row(run, item, "", None, window)]


def fit_speeds(run: str, slow_speeds: tuple[float, ...], fast_speeds: tuple[float, ...]) -> SpeedFit:
    """Return the pair of speeds [m/s] whose worst number is the fewest limits off, and all pairs within the limits."""
    pairs = [(slow, fast) for slow in slow_speeds for fast in fast_speeds]
    base = load_scenario(run, _profile(*pairs[0]))
    cases = [
        LabelledScenario(
            {"slow": slow, "fast": fast},
            base.model_copy(update={"vehicle": {**base.vehicle, SLOW_KEY: slow, FAST_KEY: fast}}),
        )
        for slow, fast in pairs
    ]
    scenario, design = design_of(cases)
    measures = {f"number{k}": number.measure for k, number in enumerate(NUMBERS)}
    found = columns_in_memory(Study(scenario, design, {"name": run}, measures=measures))
    values: Array = np.column_stack([found[name] for name in measures])
    off = np.abs(values - [number.value for number in NUMBERS]) / [number.limit for number in NUMBERS]
    worst = np.max(np.nan_to_num(off, nan=np.inf), axis=1)
    best = int(np.argmin(worst))
    fitting = [pair for pair, share in zip(pairs, worst, strict=True) if share <= 1.0]
    return SpeedFit(*pairs[best], tuple(values[best].tolist()), fitting)


def _profile(slow: float, fast: float) -> list[str]:
    times = ("vehicle.driver.profile[1].at=0", f"vehicle.driver.profile[2].at={FASTER_AT}")
    return [*times, f"vehicle.{SLOW_KEY}={slow}", f"vehicle.{FAST_KEY}={fast}"]
