"""Which numbers are kept of every run, and how they come from a full recording.

The compiled batch gathers them while it runs; for any other engine they are read off the recording.
Both give the same bits.
"""

from typing import NamedTuple

import numpy as np

from modelkit.variables import variables
from orchestrator.cosim.recording import Recording
from orchestrator.cosim.slave import Array
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.requirements import Requirement, Window
from orchestrator.scenario.scenario import Scenario
from orchestrator.text.errors import BadInput, suggestion
from orchestrator.verdict.judge import judge
from orchestrator.verdict.summary import Final

STOP_TIME, STANDSTILL, ABORTED = 0.0, 1.0, 2.0
"""How a run ended: first number of its row; the second is when [ns]."""
FIRST_KEPT = 2


class Kept(NamedTuple):
    """One number of a run.

    ``last``; ``largest`` absolute value, with its sign; ``greatest``; ``smallest``; ``travel``: sum of
    absolute changes; ``judged``: the worst value for the requirement of that number, from a recording only.
    """

    how: str
    signal: str
    """``vehicle.speed``; for ``judged`` the place of the requirement among the limits."""


POSE = tuple(Kept("last", f"vehicle.pose.{axis}") for axis in ("x", "y", "heading"))
WHEEL = Kept("last", "vehicle.steering_wheel_angle")
PHASE = Kept("last", "controller.phase")
REASON = Kept("last", "controller.reason")
SHIFTS = Kept("last", "controller.shifts")
SPEED = Kept("largest", "vehicle.speed")
EFFORT = Kept("travel", "vehicle.steering_wheel_angle")
CLEARANCE = Kept("smallest", "vehicle.clearance")
HOW = {"max_abs": "largest", "max": "greatest", "min": "smallest"}
SUMMARY = (
    "duration",
    "shifts",
    "max_speed",
    *(f"final.{name}" for name in Final.model_fields),
)
"""Numbers of the summary that a limit may name."""
CORE = [*POSE, WHEEL, PHASE, REASON, SHIFTS, SPEED, EFFORT]


def kept_numbers(scenario: Scenario) -> list[Kept]:
    """Return what a verdict on ``scenario`` needs. Raises ``BadInput`` for a limit on an unknown signal."""
    known = {
        f"{owner}.{item.name}"
        for owner, model in MODELS.items()
        for cls in (model.inputs, model.outputs)
        for item in variables(cls)
    }
    kept = [*CORE, *([CLEARANCE] if CLEARANCE.signal in known else [])]
    for place, limit in enumerate(scenario.limits):
        if limit.signal in known:
            kept.append(kept_for(limit, place))
        elif limit.signal not in SUMMARY:
            hint = suggestion(limit.signal, [*known, *SUMMARY])
            raise BadInput(f"no signal or number of this name{hint}", file=scenario.file, key=f"limits: {limit.id}")
    return list(dict.fromkeys(kept))


def kept_for(limit: Requirement, place: int) -> Kept:
    """Return the number that decides about a requirement on a signal."""
    window = limit.window
    if window is not None and window == Window(at="end", if_never=window.if_never):
        return Kept("last", limit.signal)
    if window is not None or limit.condition not in HOW:
        return Kept("judged", str(place))
    return Kept(HOW[limit.condition], limit.signal)


def why_not_compiled(scenario: Scenario, kept: list[Kept]) -> str:
    """Return why runs of ``scenario`` need a full recording each, an empty string if they do not."""
    if scenario.faults:
        return "the scenario has faults"
    judged = [scenario.limits[int(item.signal)].id for item in kept if item.how == "judged"]
    return f"the limit {judged[0]!r} needs the whole run" if judged else ""


def row_of(recording: Recording, scenario: Scenario, kept: list[Kept]) -> Array:
    """Return the row that the compiled batch would have made of this run."""
    end = str(recording.info["end"]["reason"])
    code = {"stop_time": STOP_TIME, "standstill": STANDSTILL}.get(end, ABORTED)
    numbers = [_number(item, recording, scenario) for item in kept]
    return np.array([code, float(recording.t_ns[-1]) if len(recording.t_ns) else 0.0, *numbers])


def _number(item: Kept, recording: Recording, scenario: Scenario) -> float:
    if item.how == "judged":
        (check,) = judge([scenario.limits[int(item.signal)]], recording, {}, scenario.file)
        return check.limit if check.passed and check.value != check.value else check.value
    values = recording.signals[item.signal]
    if not len(values):
        return float("nan")
    if item.how == "travel":
        changes = np.abs(np.diff(values))
        return float(np.add.accumulate(changes)[-1]) if len(changes) else 0.0
    if item.how == "largest":
        size = np.abs(values)
        return float(values[int(np.argmax(np.where(np.isnan(size), np.inf, size)))])
    return float({"last": values[-1], "greatest": np.max(values), "smallest": np.min(values)}[item.how])
