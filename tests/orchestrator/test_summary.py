"""summary.json: outcome, errors in the target's frame, events, checks, and the promised keys."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.interface import Reason
from controller_fmu.registry import ControllerOutput
from modelkit.variables import variables
from orchestrator.evaluation.verdict.summary import Summary, summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Target
from orchestrator.simulation.cosim.recording import Recording

DEMO = str(Path(__file__).with_name("demo.yaml"))
TARGET = Target(x=10.0, y=-5.0, heading=math.pi / 2)
PROMISED = {
    *(
        "scenario",
        "outcome",
        "reason",
        "duration",
        "manoeuvres",
        "max_speed",
        "peak_jerk",
        "final",
        "events",
        "checks",
        "fmus",
    ),
    *("dry_steering_count", "wall_time", "real_time_factor", "seed", "versions", "notes"),
}


def recording(phases: list[int], end: str = "standstill", reason: int = 0, **more: float) -> Recording:
    count = len(phases)
    signals = {
        "vehicle.pose.x": np.full(count, 10.2),
        "vehicle.pose.y": np.full(count, -4.0),
        "vehicle.pose.heading": np.full(count, math.pi / 2 - 0.01 + 4 * math.pi),
        "vehicle.speed": np.append(np.full(count - 1, -1.25), 0.0),
        "vehicle.steering_wheel_angle": np.zeros(count),
        "controller.phase": np.array(phases, dtype=float),
        "controller.reason": np.full(count, float(reason)),
        "controller.manoeuvres": np.arange(count, dtype=float),
    }
    signals.update({name: np.full(count, value) for name, value in more.items()})
    known = {f"controller.{item.name}": item for item in variables(ControllerOutput)}
    for name in ("vehicle.speed", "vehicle.pose.x"):
        known[name] = next(item for item in variables(ControllerOutput) if item.kind is float)
    info = {"end": {"reason": end}, "versions": {"python": "3"}, "fmus": [{"name": "a", "kind": "none", "guid": "g"}]}
    return Recording(np.arange(count) * 10_000_000, signals, {}, known, info)


def summary(found: Recording, limits: list[dict[str, Any]] | None = None) -> Summary:
    scenario = load_scenario(DEMO)
    given = limits if limits is not None else []
    judged = [type(scenario.requirements[0]).model_validate(item) for item in given]
    changed = scenario.model_copy(update={"requirements": judged, "target": TARGET})
    return summarize(found, changed, 0.02)


def test_final_errors_are_in_the_targets_frame() -> None:
    final = summary(recording([0, 1, 2])).final
    assert final.longitudinal_error == pytest.approx(1.0)
    assert final.lateral_error == pytest.approx(-0.2)
    assert final.heading_error == pytest.approx(-0.01)


def test_events_carry_time_phases_and_pose() -> None:
    data = summary(recording([0, 0, int(GuoPhase.PATH_TRACKING), int(GuoPhase.PARKED)])).as_json()
    assert [(event["t"], event["from"], event["to"]) for event in data["events"]] == [
        (0.02, "STANDBY", "PATH_TRACKING"),
        (0.03, "PATH_TRACKING", "PARKED"),
    ]
    assert data["events"][0]["x"] == 10.2
    assert list(data["events"][0]) == ["t", "from", "to", "x", "y", "heading"]


@pytest.mark.parametrize(
    ("phase", "end", "reason", "outcome", "why"),
    [
        (GuoPhase.PARKED, "standstill", 0, "parked", "all checks passed"),
        (GuoPhase.FAILED, "standstill", Reason.POSE_FROZEN, "failed", "pose_frozen"),
        (GuoPhase.FAILED, "stop_time", Reason.NOT_STOPPING, "failed", "not_stopping"),
        (GuoPhase.TAKEOVER, "standstill", 0, "not_parked", "takeover"),
        (GuoPhase.TO_Q2, "stop_time", 0, "not_parked", "stop time reached in to_q2"),
        (GuoPhase.PARKED, "interrupted", 0, "aborted", "interrupted"),
        (GuoPhase.PARKED, "error: vehicle failed", 0, "aborted", "error: vehicle failed"),
    ],
)
def test_outcomes(phase: GuoPhase, end: str, reason: int, outcome: str, why: str) -> None:
    found = summary(recording([0, int(phase)], end, int(reason)))
    assert (found.outcome, found.reason) == (outcome, why)


def test_parked_needs_every_required_check() -> None:
    speed = {"id": "speed", "signal": "vehicle.speed", "max_abs": 1.0, "source": "me"}
    found = summary(recording([0, int(GuoPhase.PARKED)]), [speed])
    assert (found.outcome, found.reason) == ("not_parked", "beyond its limit: speed")
    assert found.checks[0].margin == pytest.approx(-0.25)
    assert found.checks[0].t == 0.0
    assert summary(recording([0, int(GuoPhase.PARKED)]), [{**speed, "required": False}]).outcome == "parked"


def test_nan_passes_no_check_and_json_stays_json() -> None:
    broken = recording([0, int(GuoPhase.PARKED)])
    broken.signals["vehicle.pose.x"][-1] = math.nan
    found = summary(broken, [{"id": "lateral", "signal": "final.lateral_error", "max_abs": 0.05, "source": "me"}])
    assert found.outcome == "not_parked"
    text = json.dumps(found.as_json(), allow_nan=False)
    assert json.loads(text)["final"]["x"] is None


def test_the_promised_keys() -> None:
    data = summary(recording([0, int(GuoPhase.PARKED)])).as_json()
    assert set(data) >= PROMISED
    assert list(data["final"]) == [
        *("x", "y", "heading", "lateral_error", "longitudinal_error", "heading_error", "steering_wheel_angle"),
        *("speed", "outline_margin", "kerb_nearest", "kerb_farthest"),
    ]
    assert data["max_speed"] == 1.25
    assert data["real_time_factor"] == pytest.approx(0.5)
    assert Summary.model_json_schema()["properties"].keys() >= PROMISED


def test_checks_have_the_promised_keys() -> None:
    speed = {"id": "speed", "signal": "vehicle.speed", "max_abs": 9.0, "source": "me"}
    check = summary(recording([0, 9]), [speed]).as_json()["checks"][0]
    assert set(check) >= {"id", "limit", "value", "passed", "source"}
    assert (check["limit"], check["value"], check["passed"]) == (9.0, -1.25, True)
