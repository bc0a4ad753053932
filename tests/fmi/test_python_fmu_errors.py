"""Exceptions and wrong calls: logged, refused, never fmi2Fatal, never a crash."""

import ast
import gc
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

import vehicle_fmu
from fmus.python.bundle import bundle
from tests.fmi.host import DISCARD, ERROR, FATAL, OK, Host, slaves

TOO_HIGH = 10_000


def test_an_exception_is_logged_with_its_traceback_and_discards_the_step(python_fmus: Any) -> None:
    with Host(python_fmus["Toy"]) as host:
        host.initialize()
        assert host.step(0.0, 0.01) == OK
        before = host.outputs()
        host.set({"divisor": 0.0})
        assert host.step(0.01, 0.01) == DISCARD
        status, category, text = host.log[-1]
        assert (status, category) == (ERROR, "logStatusError")
        assert "ZeroDivisionError" in text
        assert "toy_model/model.py" in text
        assert "in step" in text
        assert host.outputs() == before
        host.set({"divisor": 1.0})
        assert host.step(0.01, 0.01) == OK
        assert host.get(["count"]) == [2]


def test_a_failing_initialize_is_logged_and_no_step_is_taken(python_fmus: Any) -> None:
    with Host(python_fmus["Toy"]) as host:
        host.initialize(broken=True)
        assert any("ZeroDivisionError" in text for _, _, text in host.log)
        assert host.step(0.0, 0.01) == DISCARD
        host.fmu.reset()
        host.initialize()
        assert host.step(0.0, 0.01) == OK


@pytest.mark.parametrize("text", ["50% done", "%s %n %d", "100 %% of 5%", "naïve \ud800 text"])
def test_percent_signs_reach_the_host_as_they_are(python_fmus: Any, text: str) -> None:
    """FMPy formats the message as printf does, so a lone %n would crash here."""
    with Host(python_fmus["Toy"]) as host:
        slaves(host)[-1]._error(text)
        host.initialize()
        assert host.log[0] == (ERROR, "logStatusError", text.encode("utf-8", "replace").decode())


def test_an_interrupt_that_strikes_before_the_first_line_does_no_harm(python_fmus: Any) -> None:
    """Ctrl-C can raise at the entry of a method; the binary then frees its objects twice."""

    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    for _ in range(2):
        with Host(python_fmus["Toy"]) as host:
            host.initialize()
            slaves(host)[-1].do_step = interrupted
            assert host.step(0.0, 0.01) == FATAL
            assert "KeyboardInterrupt" in host.log[-1][2]
            assert host.get(["mass"]) == [2.0]
        gc.collect()
        with Host(python_fmus["Toy"]) as host:
            host.initialize()
            slaves(host)[-1].do_step = interrupted
            assert host.step(0.0, 0.01) == FATAL
            host.fmu.reset()
            host.initialize()
            assert host.step(0.0, 0.01) == OK
        gc.collect()


def test_freed_instances_are_given_back(python_fmus: Any) -> None:
    counts = []
    for _ in range(6):
        with Host(python_fmus["Toy"], "always the same") as host:
            host.initialize()
            host.fmu.reset()
            counts.append(len(slaves(host)))
    assert counts[1:] == [counts[1]] * 5


def test_an_unknown_value_reference_or_a_wrong_type_is_refused(python_fmus: Any) -> None:
    for call in (
        lambda fmu, vr: fmu.getReal([vr["angle"], TOO_HIGH]),
        lambda fmu, vr: fmu.getReal([0xFFFFFFFF]),
        lambda fmu, vr: fmu.getReal([vr["count"]]),
        lambda fmu, vr: fmu.getInteger([vr["angle"]]),
        lambda fmu, vr: fmu.getBoolean([vr["count"]]),
        lambda fmu, vr: fmu.getString([vr["angle"]]),
        lambda fmu, vr: fmu.setReal([TOO_HIGH], [1.0]),
        lambda fmu, vr: fmu.setReal([vr["wish"]], [1.0]),
        lambda fmu, vr: fmu.setInteger([vr["brake"]], [1]),
        lambda fmu, vr: fmu.setBoolean([vr["wish"]], [True]),
        lambda fmu, vr: fmu.setString([vr["angle"]], ["x"]),
        lambda fmu, vr: fmu.setReal([vr["angle"]], [1.0]),
        lambda fmu, vr: fmu.setReal([vr["mass"]], [1.0]),
        lambda fmu, vr: fmu.setReal([vr["time"]], [1.0]),
    ):
        with Host(python_fmus["Toy"]) as host:
            host.initialize()
            before = host.outputs()
            call(host.fmu, host.refs)
            assert host.log[0][0] == ERROR
            assert host.step(0.0, 0.01) == DISCARD
            assert host.outputs() == before
            assert host.get(["mass"]) == [2.0]
            host.fmu.reset()
            host.initialize()
            assert host.step(0.0, 0.01) == OK


def test_a_value_that_cannot_be_read_is_nan_beside_the_good_ones(python_fmus: Any) -> None:
    with Host(python_fmus["Toy"]) as host:
        host.initialize()
        good, bad = host.fmu.getReal([host.refs["mass"], TOO_HIGH])
        assert good == 2.0
        assert bad != bad


def test_steps_outside_of_step_mode_are_refused(python_fmus: Any) -> None:
    with Host(python_fmus["Toy"]) as host:
        assert host.step(0.0, 0.01) == DISCARD
        host.initialize()
        assert host.step(0.0, 0.01) == OK
        host.fmu.terminate()
        assert host.step(0.01, 0.01) == DISCARD


@pytest.mark.parametrize("content", [b"", b"null", b"[1, 2]", b"\xff\xfe", b'["x", 2, false, "", [], []]'])
def test_a_damaged_state_is_refused(python_fmus: Any, content: Any) -> None:
    with Host(python_fmus["Toy"]) as host:
        host.initialize()
        state = host.fmu.deSerializeFMUstate(content)
        host.fmu.setFMUstate(state)
        assert "not saved by this FMU" in host.log[0][2]
        assert host.step(0.0, 0.01) == DISCARD


def test_a_state_of_another_model_is_refused(python_fmus: Any) -> None:
    with Host(python_fmus["Vehicle"]) as vehicle, Host(python_fmus["Toy"]) as toy:
        vehicle.initialize()
        toy.initialize()
        state = vehicle.fmu.getFMUstate()
        toy.fmu.setFMUstate(toy.fmu.deSerializeFMUstate(vehicle.fmu.serializeFMUstate(state)))
        assert toy.step(0.0, 0.01) == DISCARD
        assert vehicle.step(0.0, 0.01) == OK


@pytest.mark.parametrize("version", [(3, 6), (3, 9), (3, 10)])
def test_a_host_with_an_older_python_is_told_which_one_it_needs(
    version: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """PythonFMU logs the exception; the script must be readable for the old Python, and stop before any import."""
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]
    made = bundle(vehicle_fmu.MODEL)
    text = made.files[f"{made.script}.py"].decode()
    ast.parse(text, feature_version=version)
    monkeypatch.setattr("sys.version_info", (*version, 1, "final", 0))
    with pytest.raises(ImportError, match=rf"needs Python (3\.\d+) or later, its host has 3\.{version[1]}") as raised:
        exec(text, {})
    (needed,) = re.findall(r"Python (3\.\d+)", str(raised.value))
    assert f">={needed}" in project["requires-python"]
