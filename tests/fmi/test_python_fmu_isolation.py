"""FMUs, builds of one FMU and the host's own packages share no Python module."""

import gc
import os
import re
import shutil
import subprocess
import sys
import textwrap
import zipfile
from pathlib import Path
from typing import Any

import fmpy
import pytest
import toy_model

import controller_fmu
import modelkit
import vehicle_fmu
from fmus.contents.archive import archive_guid
from fmus.contents.variables import fmi_variables
from fmus.python.bundle import bundle, rewrite
from fmus.python.fmu import build
from tests.fmi.host import OK, Host, random_inputs, slaves

ROOT = Path(__file__).parents[2]
PACKAGES = ("modelkit", "vehicle_fmu", "controller_fmu", "fmus")


def build_elsewhere(folder: Any, package: Any, change: Any) -> Any:
    """Return the FMU of ``package`` built from a copy of the sources with ``change`` made to each model file."""
    for name in PACKAGES:
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__", "dist"))
    shutil.copytree(ROOT / "tests/fmi/toy_model", folder / "toy_model", ignore=shutil.ignore_patterns("__pycache__"))
    for path in (folder / package).rglob("*.py"):
        path.write_text(change(path.read_text()))
    code = f"import sys; sys.path.insert(0, {str(folder)!r})\nfrom {package} import MODEL\n"
    code += f"from fmus.python.fmu import build\nprint(build(MODEL, {str(folder / 'out')!r}))"
    result = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, cwd=folder)
    return Path(result.stdout.strip())


def roots_of(hosts: Any) -> Any:
    """Return the root packages of the instances' code."""
    return {slave.model.step.__module__.split(".")[0] for host in hosts for slave in slaves(host)}


def test_all_fmus_run_beside_the_packages_of_the_host(python_fmus: Any) -> None:
    inputs = {name: random_inputs(fmi_variables(model_of(name)), 6, 10) for name in python_fmus}
    path = list(sys.path)
    alone = {name: run(python_fmus[name], inputs[name]) for name in python_fmus}
    hosts = {name: Host(path) for name, path in python_fmus.items()}
    try:
        for host in hosts.values():
            host.initialize()
        roots = roots_of(hosts.values())
        assert len(roots) == 3
        assert all(root.startswith("fmu_") for root in roots)
        for number in range(10):
            for name, host in hosts.items():
                host.set(inputs[name][number])
                assert host.step(number * 0.01, 0.01) == OK
        assert {name: host.outputs() for name, host in hosts.items()} == alone
    finally:
        for host in hosts.values():
            host.__exit__()
    assert sys.path == path
    for package in (modelkit, vehicle_fmu, controller_fmu, toy_model):
        assert sys.modules[package.__name__] is package
        assert not package.__name__.startswith("fmu_")


def model_of(name: Any) -> Any:
    return {"Toy": toy_model.MODEL, "Vehicle": vehicle_fmu.MODEL, "Controller": controller_fmu.MODEL}[name]


def run(path: Any, inputs: Any) -> Any:
    with Host(path) as host:
        host.initialize()
        for number, values in enumerate(inputs):
            host.set(values)
            host.step(number * 0.01, 0.01)
        return host.outputs()


def test_two_builds_of_one_model_each_run_their_own_code(python_fmus: Any, tmp_path: Path) -> None:
    twice = build_elsewhere(tmp_path, "toy_model", lambda text: text.replace("GAIN = 1.0", "GAIN = 2.0"))
    assert archive_guid(twice) != archive_guid(python_fmus["Toy"])
    with Host(python_fmus["Toy"]) as once, Host(twice) as fast:
        for host in (once, fast):
            host.initialize()
        for number in range(20):
            assert once.step(2 * number * 0.01, 0.01) == OK
            assert once.step((2 * number + 1) * 0.01, 0.01) == OK
            assert fast.step(number * 0.02, 0.01) == OK
        state = once.fmu.getFMUstate()
        content = once.fmu.serializeFMUstate(state)
        once.fmu.freeFMUstate(state)
        assert once.get(["count"]) == [40]
        assert fast.get(["count"]) == [20]
    slow = slow_motion(python_fmus["Toy"])
    with Host(twice) as fast:
        fast.initialize(noisy=False)
        for number in range(20):
            assert fast.step(number * 0.01, 0.01) == OK
        assert fast.get(["oscillators[1].position"])[0] == pytest.approx(slow, rel=1e-12)
        fast.fmu.setFMUstate(fast.fmu.deSerializeFMUstate(content))
        assert fast.step(0.2, 0.01) != OK, "a state of the other build"


def slow_motion(path: Any) -> Any:
    """Return where the first oscillator is after 20 steps of twice the length."""
    with Host(path) as host:
        host.initialize(noisy=False)
        for number in range(20):
            host.step(number * 0.02, 0.02)
        return host.get(["oscillators[1].position"])[0]


@pytest.mark.parametrize("name", ["Vehicle", pytest.param("Controller", marks=pytest.mark.release)])
def test_a_different_build_of_the_real_models_beside_the_first(python_fmus: Any, tmp_path: Path, name: str) -> None:
    package = model_of(name).package.__name__
    other = build_elsewhere(tmp_path, package, lambda text: text + "\nANOTHER_BUILD = 1\n")
    assert archive_guid(other) != archive_guid(python_fmus[name])
    inputs = random_inputs(fmi_variables(model_of(name)), 7, 10)
    with Host(python_fmus[name]) as first, Host(other) as second:
        for host in (first, second):
            host.initialize()
        assert len(roots_of((first, second))) == 2
        for number, values in enumerate(inputs):
            for host in (first, second):
                host.set(values)
                assert host.step(number * 0.01, 0.01) == OK
            assert first.outputs() == second.outputs()


def test_only_the_standard_library_is_needed(python_fmus: Any, model: Any, tmp_path: Path) -> None:
    with zipfile.ZipFile(python_fmus[model.name]) as archive:
        archive.extractall(tmp_path)
    script = (tmp_path / "resources/slavemodule.txt").read_text()
    code = f"""
        import sys
        sys.path.insert(0, {str(tmp_path / "resources")!r})
        import {script} as module
        slave = module.{script.title()}(instance_name="x", resources="", visible=False)
        slave.enter_initialization_mode()
        slave.exit_initialization_mode()
        assert all(slave.do_step(k * 0.01, 0.01) for k in range(100)), [str(m) for m in slave.log_queue]
        print(sorted(m for m in sys.modules if "." not in m and m not in {{*sys.stdlib_module_names, "__main__"}}))
    """
    command = [sys.executable, "-I", "-S", "-c", textwrap.dedent(code)]
    result = subprocess.run(command, check=True, capture_output=True, text=True)
    assert result.stdout.strip() == str([script.replace("slave_", "fmu_"), script])


def test_packages_of_the_host_with_the_same_names_do_no_harm(python_fmus: Any, tmp_path: Path) -> None:
    """A host whose own modelkit, pythonfmu and model packages are something else altogether."""
    for name in (*PACKAGES, "toy_model", "pythonfmu"):
        (tmp_path / f"{name}.py").write_text("raise ImportError('this is another package')\n")
    code = "import sys, fmpy\nfor p in sys.argv[1:]: print(len(fmpy.simulate_fmu(p, stop_time=0.2)))"
    command = [sys.executable, "-c", code, *map(str, python_fmus.values())]
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    result = subprocess.run(command, check=True, capture_output=True, text=True, env=environment, cwd=tmp_path)
    assert [int(line) > 10 for line in result.stdout.split()] == [True, True, True]


@pytest.mark.release
def test_many_instantiations(python_fmus: Any) -> None:
    """PythonFMU's binary drops a reference to the script's namespace every time; it must survive that."""
    folder = fmpy.extract(str(python_fmus["Toy"]))
    description = fmpy.read_model_description(folder)
    arguments = {"guid": description.guid, "modelIdentifier": "Toy", "unzipDirectory": folder, "instanceName": "x"}
    for number in range(300):
        fmu = fmpy.fmi2.FMU2Slave(**arguments)
        fmu.instantiate()
        fmu.setupExperiment()
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        fmu.doStep(0.0, 0.01)
        if number % 50 == 0:
            gc.collect()
            fmu.reset()
        fmu.freeInstance()
    shutil.rmtree(folder)


def test_a_python_program_ends_with_nothing_left_to_free(tmp_path: Path) -> None:
    """PythonFMU's own library, as in an environment without compiler, looks at its interpreter after freeing it."""
    path = build(toy_model.MODEL, tmp_path)
    code = """if 1:
    import ctypes, fmpy, sys
    fmpy.simulate_fmu(sys.argv[1], stop_time=0.2)
    class Told(ctypes.CDLL):
        def __getattr__(self, name):
            found = super().__getattr__(name)
            print(name, self._name)
            return found
    ctypes.CDLL = Told
    """
    command = [sys.executable, "-c", code, str(path)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=tmp_path)
    assert re.fullmatch(r"finalizePythonInterpreter \S+/binaries/linux64/Toy\.so\n", done.stdout), done.stderr


def test_imports_that_cannot_be_isolated_are_refused() -> None:
    with pytest.raises(ValueError, match=r"toy\.py:1: import of numpy"):
        rewrite(b"import numpy", "toy.py", "root", {"toy"})
    with pytest.raises(ValueError, match=r"toy\.py:2: import of toy"):
        rewrite(b"\nimport toy.part", "toy.py", "root", {"toy"})
    text = b"if 1:\n    from toy.part import (\n        a,\n    )\nfrom math import pi\nfrom . import b\n"
    assert rewrite(text, "toy.py", "root", {"toy"}) == text.replace(b"from toy.", b"from root.toy.")


def test_a_model_must_be_found_in_its_package() -> None:
    with pytest.raises(ValueError, match="must hold the Model"):
        bundle(toy_model.MODEL._replace(step_size=0.02))
