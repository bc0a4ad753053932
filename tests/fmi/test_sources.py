"""The C inside native FMUs: compiles without a warning anywhere, gives the same bits, lives beside other FMUs."""

import shutil
import subprocess
import sys
import zipfile
from functools import lru_cache
from pathlib import Path
from typing import Any

import pytest
import table_model
import toy_model

from fmus.compiler import Translation
from fmus.contents.variables import fmi_variables, visible_variables
from fmus.native import fmu as native_fmu
from fmus.native import sources, tables
from fmus.native.compilers import FLAGS, find_compiler
from fmus.native.platforms import PLATFORMS, host
from fmus.native.source_fingerprint import CACHED_TRANSLATIONS
from fmus.native.sources import fmu_sources, unit_name
from modelkit.variables import variables, with_values
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from tests.fmi.conftest import ALL_MODELS, marked
from tests.fmi.host import calculated, random_inputs
from tests.fmi.raw import ERROR, OK, Library
from tests.fmi.raw3 import Library3
from tests.fmi.test_fmi3_fmu import grouped
from vehicle_fmu import MODEL as VEHICLE

WARNINGS = ["-pedantic", "-Wall", "-Wextra", "-Wconversion"]
GCC = shutil.which("gcc")
CLANG = [sys.executable, "-m", "ziglang", "cc"]
COMPILERS = [
    pytest.param([GCC], id="gcc", marks=pytest.mark.skipif(GCC is None, reason="needs gcc")),
    pytest.param(CLANG, id="clang", marks=pytest.mark.release),
]
LARGE_ONCE = [("Controller", 2), ("Controller_apa", 3), ("Controller_apa_large", 2)]
MODELS_BY_FMI = [
    *(marked(name, fmi) for name in ALL_MODELS for fmi in (2, 3) if name not in dict(LARGE_ONCE)),
    *(pytest.param(*large, marks=pytest.mark.release) for large in LARGE_ONCE),
]
"""Of a large model one version of FMI is enough: what is written for a version is the same in all."""
DRIVES = [
    ("guo2015-case4",),
    ("valet-parallel",),
    ("valet-parallel", "controller.system=apa_large"),
]
"""Scenarios and overrides whose signals are the inputs of the models in them."""
needs_gcc = pytest.mark.skipif(GCC is None, reason="needs gcc")


def write(model: Any, fmi: Any, folder: Any) -> Any:
    folder.mkdir(exist_ok=True)
    for name, text in fmu_sources(model, "{token}", fmi).items():
        (folder / name).write_text(text)
    return unit_name(model, fmi)


@pytest.mark.parametrize("name", [marked(name) for name in ALL_MODELS])
def test_a_call_about_all_signals_is_noted(name: str) -> None:
    """Else each call would look up each value reference: a tenth of a step of the pair."""
    model = ALL_MODELS[name]
    unit = fmu_sources(model, "{token}")[unit_name(model, 2)]
    listed = int(unit.split("#define FMU_LISTED ")[1].split()[0])
    assert listed >= sum(item.causality in ("input", "output", "local") for item in fmi_variables(model))


@pytest.mark.parametrize(("any_model", "fmi"), MODELS_BY_FMI, indirect=["any_model"])
@pytest.mark.parametrize("compiler", COMPILERS)
def test_compiles_without_a_warning(any_model: Any, fmi: int, compiler: Any, tmp_path: Path) -> None:
    unit = write(any_model, fmi, tmp_path)
    command = [*compiler, *FLAGS, *WARNINGS, "-c", unit, "-o", "unit.o"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def without_binaries(path: Any, copy: Any) -> Any:
    with zipfile.ZipFile(path) as source, zipfile.ZipFile(copy, "w") as target:
        for name in source.namelist():
            if not name.startswith("binaries/"):
                target.writestr(name, source.read(name))
    return copy


@lru_cache
def given(model: Any) -> Any:
    """Return parameters, and the inputs of 400 steps: of a drive for the models in it, else random ones."""
    scenarios = [load_scenario(name, ["stop_time=4", *more]) for name, *more in DRIVES]
    found = [(one, part) for one in scenarios for part, own in one.models.items() if own is model]
    if not found:
        return {}, random_inputs(visible_variables(model), 5, 400)
    scenario, part = found[0]
    signals = run_scenario(scenario, fmu_files("native"), kind="native").recording.signals
    names = {item.name: item.kind for item in visible_variables(model) if item.causality == "input"}
    inputs = [{name: kind(signals[f"{part}.{name}"][k]) for name, kind in names.items()} for k in range(400)]
    values = with_values(model.params, dict(getattr(scenario, part)))
    return {item.name: item.start for item in variables(model.params, values) if model.shows(item.name)}, inputs


def drive(library: Any, params: Any, inputs: Any, scalar: bool = True) -> Any:
    """Return the outputs of each step; ``scalar``: FMI 2.0, where there are no arrays."""

    def as_known(values: Any) -> Any:
        return values if scalar else grouped(values, values.values())

    component, rows = library.initialized(**as_known(params)), []
    for k, values in enumerate(inputs):
        for name, value in as_known(values).items():
            assert library.set(component, name, value) == OK
        assert library.step(component, 0.01 * k) == OK
        rows.append(tuple(map(str, (library.get(component, name) for name in calculated(library.description)))))
    library.free(component)
    assert len(set(rows)) > 20, "nothing has moved"
    return rows


EACH_CHANGE = {("Toy", 2), ("Toy", 3)}
"""What FMPy compiles on each change: each version of FMI once; ``make release`` has all."""


@needs_gcc
@pytest.mark.parametrize(
    ("name", "fmi"),
    [
        pytest.param(name, fmi, marks=() if (name, fmi) in EACH_CHANGE else pytest.mark.release)
        for name in ALL_MODELS
        for fmi in (2, 3)
        if name not in dict(LARGE_ONCE) or (name, fmi) in LARGE_ONCE
    ],
)
def test_fmpy_compiles_it_to_the_same_bits(
    name: str, fmi: int, native_fmus: Any, fmi3_fmus: Any, tmp_path: Path
) -> None:
    model = ALL_MODELS[name]
    fmu = (native_fmus if fmi == 2 else fmi3_fmus)[model.name]
    bare = without_binaries(fmu, tmp_path / f"{model.name}.fmu")
    program = str(Path(sys.executable).with_name("fmpy"))
    subprocess.run([program, "compile", str(bare)], check=True, capture_output=True, timeout=300)
    make = Library if fmi == 2 else Library3
    ours, theirs = (make(path, tmp_path / name) for path, name in ((fmu, "ours"), (bare, "theirs")))
    assert ours.file.read_bytes() != theirs.file.read_bytes()
    params, inputs = given(model)
    assert drive(ours, params, inputs, fmi == 2) == drive(theirs, params, inputs, fmi == 2)


@needs_gcc
def test_this_machines_own_compiler_makes_the_same_bits(native_fmus: Any, tmp_path: Path) -> None:
    made = native_fmu.build(toy_model.MODEL, tmp_path / "gcc", [host()], find_compiler("gcc"))
    ours, theirs = (Library(path, tmp_path / name) for path, name in ((native_fmus["Toy"], "a"), (made, "b")))
    assert ours.description.guid != theirs.description.guid
    params, inputs = given(toy_model.MODEL)
    assert drive(ours, params, inputs) == drive(theirs, params, inputs)


def test_another_platform_needs_ziglang(tmp_path: Path) -> None:
    other = next(name for name in PLATFORMS if name != host())
    with pytest.raises(RuntimeError, match="compiles for this machine only; others need --cc zig"):
        native_fmu.build(toy_model.MODEL, tmp_path, [other], find_compiler("gcc" if GCC else "cc"))


@needs_gcc
@pytest.mark.parametrize("fmi", [2, pytest.param(3, marks=pytest.mark.release)])
def test_two_fmus_in_one_image(fmi: int, tmp_path: Path) -> None:
    objects = []
    for model in (toy_model.MODEL, table_model.MODEL):
        folder = tmp_path / model.name
        unit = write(model, fmi, folder)
        prefix = [f"-DFMI2_FUNCTION_PREFIX={model.name}_"] if fmi == 2 else []
        subprocess.run([str(GCC), *FLAGS, *prefix, "-c", unit, "-o", f"{model.name}.o"], cwd=folder, check=True)
        objects.append(str(folder / f"{model.name}.o"))
        listing = subprocess.run(
            ["nm", "-g", "--defined-only", objects[-1]], capture_output=True, text=True, check=True
        )
        names = [line.split()[-1] for line in listing.stdout.splitlines()]
        assert len(names) > 30
        assert all(name.startswith(f"{model.name}_") for name in names)
    main = "const char *{0}_fmi{1}GetVersion(void);"
    text = "\n".join(main.format(name, fmi) for name in ("Toy", "Table"))
    text += f"\nint main(void) {{ return Toy_fmi{fmi}GetVersion()[0] != Table_fmi{fmi}GetVersion()[0]; }}\n"
    (tmp_path / "main.c").write_text(text)
    subprocess.run([str(GCC), "main.c", *objects, "-o", "image", "-lm"], cwd=tmp_path, check=True)
    assert subprocess.run([tmp_path / "image"], check=False).returncode == 0


def test_tunable_parameters_change_between_steps_and_hold_from_the_next_on(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def tunable(model: Any) -> Any:
        known = fmi_variables(model)
        return [item._replace(variability="tunable") if item.name == "stiffness" else item for item in known]

    monkeypatch.setattr(tables, "fmi_variables", tunable)
    toy = Library(native_fmu.build(toy_model.MODEL, tmp_path, [host()]), tmp_path / "fmu")
    component, plain = toy.initialized(), toy.initialized()
    for instance in (component, plain):
        assert toy.step(instance, 0.0) == OK
    before = toy.outputs(component)
    assert toy.set(component, "stiffness", 80.0) == OK
    assert toy.set(component, "mass", 3.0) == ERROR
    assert toy.set(component, "stiffness", -1.0) == ERROR
    assert "stiffness = -1 is not in [0, 10000]" in toy.messages[-1][2]
    assert toy.outputs(component) == before
    assert toy.get(component, "stiffness") == 80.0
    for instance in (component, plain):
        assert toy.step(instance, 0.01) == OK
    assert toy.get(component, "count") == 2
    assert toy.outputs(component) != toy.outputs(plain)
    toy.call("Terminate", component)
    assert toy.set(component, "stiffness", 90.0) == ERROR
    for instance in (component, plain):
        toy.free(instance)


def test_a_translation_is_kept_until_a_source_changes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    made = []

    def translate(model: Any, live: Any) -> Any:
        made.append(model.name)
        return Translation(model.name, f"header {len(made)}", "source")

    monkeypatch.setattr(sources, "translate", translate)
    monkeypatch.setattr(sources, "CACHE_FOLDER", tmp_path)
    translated = sources.translate_model.__wrapped__
    assert translated(VEHICLE) == translated(VEHICLE) == ("Vehicle", "header 1", "source")
    other = VEHICLE._replace(name="Other")
    other_start: Any = VEHICLE.step
    assert translated(other).name == "Other"
    assert translated(VEHICLE._replace(initialize=other_start)).header == "header 3"
    for number in range(CACHED_TRANSLATIONS):
        monkeypatch.setattr(sources, "hash_of", lambda *_, n=number: str(n))
        translated(VEHICLE)
    assert len(list(tmp_path.glob("Vehicle-*.json"))) == CACHED_TRANSLATIONS
    count = len(made)
    assert translated(toy_model.MODEL) != translated(toy_model.MODEL)
    assert len(made) == count + 2, "a model from elsewhere may be made of anything"
