"""Each kind of fault on the toy pair: the receiver sees it, the sender does not."""

import math
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from orchestrator.inputs.scenario.fault import Fault
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.algorithm import CoSimulation
from orchestrator.simulation.cosim.faults import manipulators
from orchestrator.simulation.cosim.fmu_instance import FmuInstance
from orchestrator.simulation.cosim.model_instance import ModelInstance
from orchestrator.simulation.cosim.recording import Recorder, Recording
from tests.orchestrator.toy_models import BRAIN, PLANT

STEP = 10_000_000
TIMES = np.arange(11) * 0.01


def run(*faults: dict[str, Any], seed: int = 1, every: dict[str, int] | None = None) -> Recording:
    instances: list[FmuInstance] = [ModelInstance("plant", PLANT, {}), ModelInstance("brain", BRAIN, {})]
    master = CoSimulation(instances, STEP, 10 * STEP, every)
    master.manipulators += manipulators([Fault(**fault) for fault in faults], master, seed)
    recorder = Recorder(instances, 11)
    master.observers.append(recorder)
    master.initialize()
    master.run()
    return recorder.recording({})


def seen(found: Recording) -> list[float]:
    assert found.signals["plant.pose.y"] == pytest.approx(TIMES)
    return found.signals["brain.pose.y"].tolist()


def fault(kind: str, **more: Any) -> dict[str, Any]:
    return {"signal": "plant.pose.y", "kind": kind, "start": 0.03, "stop": 0.06, **more}


def test_override_in_its_window_only() -> None:
    assert seen(run(fault("override", value=9))) == pytest.approx([0, 0.01, 0.02, 9, 9, 9, *TIMES[6:]])


def test_override_with_nan_and_with_the_name_of_a_state() -> None:
    assert [math.isnan(value) for value in seen(run(fault("override", value="nan")))][2:7] == [
        False,
        *[True] * 3,
        False,
    ]
    found = run({"signal": "plant.mode", "kind": "override", "value": "done", "start": 0.02})
    assert found.signals["plant.mode"].tolist() == [0, 1, *[200] * 9]


def test_freeze_holds_the_value_at_its_start() -> None:
    assert seen(run(fault("stuck_at_last"))) == pytest.approx([0, 0.01, 0.02, 0.03, 0.03, 0.03, *TIMES[6:]])


def test_drop_keeps_the_last_value_received() -> None:
    assert seen(run(fault("dropout"))) == pytest.approx([0, 0.01, 0.02, 0.02, 0.02, 0.02, *TIMES[6:]])


def test_drop_by_chance_is_the_same_for_the_same_seed() -> None:
    chance = fault("dropout", probability=0.5, start=0.0, stop=1.0)
    first, second, other = (seen(run(chance, seed=seed)) for seed in (5, 5, 6))
    assert first == second != other
    assert first != pytest.approx(TIMES)


def test_delay_gives_the_value_that_was() -> None:
    found = seen(run({"signal": "plant.pose.y", "kind": "delay", "delay": "20 ms"}))
    assert found == pytest.approx([0, 0, 0, *TIMES[1:9]])


def test_noise_adds_draws_of_its_sigma() -> None:
    found = np.array(seen(run(fault("noise", sigma="5 mm", start=0.0, stop=1.0)))) - TIMES
    assert 0.001 < found.std() < 0.01
    assert len(set(found)) == 11


def test_a_group_of_signals_and_an_input_by_its_own_name() -> None:
    found = run({"signal": "plant.pose", "kind": "override", "value": 7, "start": 0.05})
    for axis in ("x", "y", "heading"):
        assert found.signals[f"brain.pose.{axis}"][5:].tolist() == [7.0] * 6
    found = run({"signal": "brain.left", "kind": "override", "value": 40})
    assert found.signals["brain.right"].tolist() == [0, *[41] * 10]


def test_a_slow_receiver_is_disturbed_at_its_own_instants() -> None:
    found = run(fault("override", value=9, start=0.04, stop=0.05), every={"brain": 2})
    assert found.signals["brain.pose.y"] == pytest.approx([0, 0, 0.02, 0.02, 9, 9, 0.06, 0.06, 0.08, 0.08, 0.10])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"signal": "plan.pose.x", "kind": "stuck_at_last"}, "expected one of plant, brain before the dot"),
        ({"signal": "plant.pose.z", "kind": "stuck_at_last"}, "plant has no signal 'pose.z'; did you mean"),
        ({"signal": "plant.rays", "kind": "stuck_at_last"}, "plant.rays is not an input of any component"),
        ({"signal": "plant.pose.x", "kind": "override"}, "kind override needs value"),
        ({"signal": "plant.pose.x", "kind": "noise"}, "kind noise needs sigma"),
        ({"signal": "plant.pose.x", "kind": "delay"}, "kind delay needs delay"),
        ({"signal": "plant.left", "kind": "noise", "sigma": 1}, "noise needs a real signal"),
        ({"signal": "plant.pose.x", "kind": "stuck_at_last", "start": 2, "stop": 1}, "stop 1 s is not after start 2 s"),
        ({"signal": "plant.pose.x", "kind": "noise", "sigma": "3 deg"}, "'3 deg' is in 'deg', expected"),
    ],
)
def test_a_wrong_fault_is_explained(given: dict[str, Any], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        run(given)


def test_an_unknown_kind_is_refused() -> None:
    with pytest.raises(ValidationError):
        Fault(signal="plant.pose.x", kind="melt")  # type: ignore[arg-type]
