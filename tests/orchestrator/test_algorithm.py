"""The master: order of the exchange, whole nanoseconds, several rates, endings."""

from typing import Any, NamedTuple

import numpy as np
import pytest

from orchestrator.simulation.cosim.algorithm import CoSimulation
from orchestrator.simulation.cosim.fmu_instance import FmuInstance
from orchestrator.simulation.cosim.model_instance import ModelInstance
from orchestrator.simulation.cosim.recording import Recorder, Recording
from tests.orchestrator.toy_models import BRAIN, PLANT

STEP = 10_000_000


def toys() -> list[FmuInstance]:
    return [ModelInstance("plant", PLANT, {}), ModelInstance("brain", BRAIN, {})]


def run(steps: int, every: dict[str, int] | None = None) -> Recording:
    instances = toys()
    master = CoSimulation(instances, STEP, steps * STEP, every)
    recorder = Recorder(instances, steps + 1)
    master.observers.append(recorder)
    master.initialize()
    end = master.run()
    master.finish(end)
    master.free()
    assert end == ("stop_time", steps * STEP)
    return recorder.recording({})


def test_each_side_sees_the_other_as_it_was_before_the_step() -> None:
    found = run(5)
    assert found.signals["plant.left"].tolist() == [0, 1, 2, 3, 4, 5]
    assert found.signals["brain.right"].tolist() == [0, 1, 2, 3, 4, 5]


def test_order_of_the_instances_does_not_matter() -> None:
    recordings = []
    for instances in (toys(), toys()[::-1]):
        master = CoSimulation(instances, STEP, 20 * STEP)
        recorder = Recorder(instances, 21)
        master.observers.append(recorder)
        master.initialize()
        master.run()
        recordings.append(recorder.recording({}).signals)
    assert recordings[0].keys() == recordings[1].keys()
    for name, values in recordings[0].items():
        assert values.tobytes() == recordings[1][name].tobytes(), name


def test_one_exchange_in_initialization_gives_inputs_before_the_first_step() -> None:
    instances = toys()
    master = CoSimulation(instances, STEP, STEP)
    master.initialize()
    assert instances[0].inputs.values[instances[0].inputs.index["command"]] == 2.0


def test_time_is_counted_not_added() -> None:
    instances = toys()
    times: list[int] = []

    class Clock(ModelInstance):
        def step(self, t_ns: int, dt_ns: int) -> None:
            times.append(t_ns)
            super().step(t_ns, dt_ns)

    instances[1] = Clock("brain", BRAIN, {})
    master = CoSimulation(instances, 333_333_333, 3_333_333_330)
    master.initialize()
    assert master.run().t_ns == 3_333_333_330
    assert times == [k * 333_333_333 for k in range(10)]


def test_a_slow_instance_acts_at_its_own_instants_and_holds_between() -> None:
    found = run(9, {"brain": 3})
    y = found.signals["plant.pose.y"]
    assert y == pytest.approx(np.arange(10) * 0.01)
    # It saw y at 0, 0.03, 0.06 s, and shows each from the end of its own step on.
    assert found.signals["brain.seen"] == pytest.approx([0, 0, 0, 0, 0, 0, 0.03, 0.03, 0.03, 0.06])
    assert found.signals["brain.pose.y"] == pytest.approx([0, 0, 0, 0.03, 0.03, 0.03, 0.06, 0.06, 0.06, 0.09])


def test_equal_rates_above_one_are_one_larger_step() -> None:
    found = run(8, {"plant": 2, "brain": 2})
    assert found.signals["plant.left"].tolist() == [0, 0, 1, 1, 2, 2, 3, 3, 4]


class Clock(ModelInstance):
    """Notes its steps."""

    def __init__(self, *words: Any) -> None:
        super().__init__(*words)
        self.steps: list[tuple[int, int]] = []

    def step(self, t_ns: int, dt_ns: int) -> None:
        self.steps.append((t_ns, dt_ns))
        super().step(t_ns, dt_ns)


@pytest.mark.parametrize(
    ("stop_ns", "every", "steps"),
    [
        (10, 1, [(0, 7), (7, 3)]),
        (14, 1, [(0, 7), (7, 7)]),
        (5, 1, [(0, 5)]),
        (15, 2, [(0, 14), (14, 1)]),
        (30, 3, [(0, 21), (21, 9)]),
        (28, 3, [(0, 21), (21, 7)]),
    ],
)
def test_the_last_step_ends_at_the_stop_time(stop_ns: int, every: int, steps: list[tuple[int, int]]) -> None:
    brain = Clock("brain", BRAIN, {})
    instances: list[FmuInstance] = [ModelInstance("plant", PLANT, {}), brain]
    master = CoSimulation(instances, 7, stop_ns, {"brain": every})
    recorder = Recorder(instances, 2)
    master.observers.append(recorder)
    master.initialize()
    assert master.run() == ("stop_time", stop_ns)
    assert brain.steps == steps
    found = recorder.recording({})
    assert found.t_ns[-1] == stop_ns
    assert found.signals["brain.right"][-1] == len(steps)


def test_an_ending_ends_and_an_interrupt_too() -> None:
    class At:
        def stop_reason(self, t_ns: int) -> str:
            return "enough" if t_ns >= 3 * STEP else ""

    master = CoSimulation(toys(), STEP, 100 * STEP)
    master.endings.append(At())
    master.initialize()
    assert master.run() == ("enough", 3 * STEP)
    master = CoSimulation(toys(), STEP, 100 * STEP)
    master.interrupt.requested = True
    master.initialize()
    assert master.run() == ("interrupted", 0)


def test_the_recorder_grows() -> None:
    class Small(NamedTuple):
        exchanges: int = 2

    instances = toys()
    recorder = Recorder(instances, Small().exchanges)
    for t in range(9):
        instances[0].outputs.values[0] = t
        recorder.on_communication_point(t)
    assert recorder.recording({}).signals["plant.pose.x"].tolist() == list(range(9))
