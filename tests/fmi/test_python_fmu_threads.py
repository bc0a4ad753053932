"""Hosts that call from other threads: Python's own, and those of a C++ master (libcosim)."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
import toy_model
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

from fmus.contents.variables import fmi_variables
from modelkit.variables import flatten, variables
from tests.fmi.host import OK, Host

STEPS = 200


@pytest.fixture(scope="module")
def expected() -> Any:
    """Outputs of the toy model after STEPS steps with the inputs at their start values."""
    params, inputs = toy_model.MODEL.params(), toy_model.MODEL.inputs()
    state, outputs = toy_model.MODEL.initialize(params)
    for _ in range(STEPS):
        state, outputs = toy_model.MODEL.step(state, inputs, params, 10_000_000)
    return dict(zip([item.name for item in variables(toy_model.MODEL.outputs)], flatten(outputs), strict=True))


def test_instances_in_python_threads(python_fmus: Any, expected: Any) -> None:
    def run(number: Any) -> Any:
        with Host(python_fmus["Toy"], f"instance {number}") as host:
            host.initialize()
            assert [host.step(k * 0.01, 0.01) for k in range(STEPS)] == [OK] * STEPS
            return dict(zip(expected, host.get(list(expected)), strict=True))

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(run, range(8))) == [expected] * 8


def test_an_instance_called_from_another_thread_than_its_own(python_fmus: Any, expected: Any) -> None:
    with Host(python_fmus["Toy"]) as host:
        host.initialize()
        for k in range(STEPS):
            with ThreadPoolExecutor(1) as pool:
                assert pool.submit(host.step, k * 0.01, 0.01).result() == OK
        assert dict(zip(expected, host.get(list(expected)), strict=True)) == expected


def test_libcosim_gives_the_same_bits(python_fmus: Any, expected: Any) -> None:
    log_output_level(CosimLogLevel.FATAL)
    execution = CosimExecution.from_step_size(step_size=10_000_000)
    index = execution.add_local_slave(CosimLocalSlave(fmu_path=str(python_fmus["Toy"]), instance_name="toy"))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    assert execution.step(STEPS)
    reals = [item for item in fmi_variables(toy_model.MODEL) if item.causality == "output" and item.kind is float]
    found = observer.last_real_values(index, [item.vr for item in reals])
    assert dict(zip([item.name for item in reals], found, strict=True)) == {
        item.name: expected[item.name] for item in reals
    }
