"""The FMI 3.0 FMU is its model, to the bit, with arrays and enumerations; checkers and FMPy take it."""

import math
import struct
import zipfile
from pathlib import Path
from typing import Any

import fmpy
import pytest
import table_model
import toy_model
from lxml import etree

from fmus.contents.arrays import INDEX, fmi_arrays
from fmus.contents.variables import fmi_variables
from fmus.native import fmu as native_fmu
from fmus.native.platforms import host
from modelkit.variables import variables
from tests.fmi.built import native_fmu_of
from tests.fmi.fmpy_check import problems_of
from tests.fmi.host import random_inputs
from tests.fmi.raw3 import OK, Library3
from tests.fmi.test_python_fmu import STEPS, in_process

SCHEMAS = Path(fmpy.__file__).parent / "schema/fmi3"
TABLE = table_model.MODEL


@pytest.fixture(scope="session")
def table_fmu() -> Any:
    return native_fmu_of(TABLE, fmi=3)


def read(path: Any, name: Any) -> Any:
    with zipfile.ZipFile(path) as archive:
        return archive.read(name)


def bits(values: Any) -> Any:
    return [struct.pack("d", value) if isinstance(value, float) else int(value) for value in values]


def grouped(names: Any, values: Any) -> Any:
    """Return name in FMI 3.0 -> elements, of flat ``values``."""
    found: dict[str, list[Any]] = {}
    for name, value in zip(names, values, strict=True):
        found.setdefault(INDEX.sub("", name), []).append(value)
    return found


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.release)])
def test_equals_the_model_in_process_to_the_bit(fmi3_fmus: Any, model: Any, seed: int, tmp_path: Path) -> None:
    inputs = random_inputs(fmi_variables(model), seed, len(STEPS))
    expected = in_process(model, inputs, STEPS)
    names = [item.name for item in variables(model.outputs)]
    library = Library3(fmi3_fmus[model.name], tmp_path)
    component = library.initialized()
    time = 0.0
    for number, (size, values) in enumerate(zip(STEPS, inputs, strict=True), start=1):
        for name, elements in grouped(values.keys(), values.values()).items():
            assert library.set(component, name, elements) == OK
        assert library.step(component, time, size) == OK
        time += size
        found = library.outputs(component)
        for name, elements in grouped(names, expected[number]).items():
            assert bits(found[name]) == bits(elements), (number, name)
    assert library.get(component, "time") == [time]
    assert library.messages == []
    library.free(component)


def test_simulates_in_fmpy_and_gives_the_reference_result(fmi3_fmus: Any, model: Any, tmp_path: Path) -> None:
    path = str(fmi3_fmus[model.name])
    fmpy.extract(path, str(tmp_path))
    reference = fmpy.util.read_csv(tmp_path / f"extra/org.fmi-standard.fmi-ls-ref/{model.name}_out.csv")
    stop, interval = reference["time"][-1], reference["time"][1]
    flat = list(reference.dtype.names[1:])
    names = list(dict.fromkeys(INDEX.sub("", name) for name in flat))
    result = fmpy.simulate_fmu(path, stop_time=stop, step_size=model.step_size, output_interval=interval, output=names)
    assert len(result) == len(reference) > 50
    for name in flat:
        places = tuple(int(number) - 1 for number in INDEX.findall(name))
        column = result[INDEX.sub("", name)]
        assert (column[(slice(None), *places)] == reference[name]).all(), name


def test_checkers_find_nothing(fmi3_fmus: Any, model: Any) -> None:
    path = fmi3_fmus[model.name]
    assert problems_of(path) == []
    for file, schema in (
        ("terminalsAndIcons/terminalsAndIcons.xml", "fmi3TerminalsAndIcons.xsd"),
        ("sources/buildDescription.xml", "fmi3BuildDescription.xsd"),
    ):
        etree.XMLSchema(file=str(SCHEMAS / schema)).assertValid(etree.fromstring(read(path, file)))
    known = {item.name for item in fmi_arrays(model)}
    terminals = etree.fromstring(read(path, "terminalsAndIcons/terminalsAndIcons.xml"))
    members = [node.get("variableName") for node in terminals.iter("TerminalMemberVariable")]
    assert members
    assert set(members) <= known
    assert read(path, "terminalsAndIcons/icon.png").startswith(b"\x89PNG")


def test_every_scalar_of_fmi_2_is_an_element(model: Any) -> None:
    elements = [item.name for array in fmi_arrays(model) for item in array.elements]
    assert sorted(elements) == sorted(item.name for item in fmi_variables(model))
    for item in fmi_arrays(model):
        assert len(item.elements) == math.prod(item.shape)


def test_arrays_and_enumerations_of_the_vehicle(fmi3_fmus: Any) -> None:
    known = {v.name: v for v in fmpy.read_model_description(str(fmi3_fmus["Vehicle"])).modelVariables}
    sizes = {name: [int(d.start) for d in known[name].dimensions] for name in known if known[name].dimensions}
    assert sizes["ultrasonic"] == [12]
    assert sizes["driver.profile.speed"] == [8]
    assert sizes["scene.boxes.length"] == [16]
    assert known["ultrasonic"].unit == "m"
    prompt = known["prompt"]
    assert prompt.type == "Enumeration"
    assert {item.name: int(item.value) for item in prompt.declaredType.items}["REVERSE"] == 3


def test_a_table_goes_row_by_row(table_fmu: Any, tmp_path: Path) -> None:
    library = Library3(table_fmu, tmp_path)
    component = library.instantiate()
    assert library.size("rows.cells") == 6
    assert [int(d.start) for d in library.known["rows.cells"].dimensions] == [2, 3]
    assert library.known["one"].start == "7.0"
    assert library.set(component, "rows.cells", [10.0, 20.0, 30.0, 40.0, 50.0, 60.0]) == OK
    assert library.set(component, "rows.colour", [2, 1]) == OK
    library.enter(component)
    assert library.get(component, "now.cells") == [10.0, 20.0, 30.0, 40.0, 50.0, 60.0]
    assert library.get(component, "total") == [217.0]
    library.call("ExitInitializationMode", component)
    assert library.step(component, 0.0, 0.1) == OK
    assert library.get(component, "now.cells") == [11.0, 21.0, 31.0, 40.0, 50.0, 60.0]
    assert library.get(component, "rows.cells")[0] == 10.0
    assert (library.get(component, "now.lit"), library.get(component, "now.colour")) == ([True, False], [2, 1])
    library.set(component, "lit", [False, True])
    assert library.step(component, 0.1, 0.1) == OK
    assert library.get(component, "now.cells")[0] == 11.0
    library.free(component)


def test_two_builds_are_the_same_bytes_and_the_token_is_its_own(
    fmi3_fmus: Any, native_fmus: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(native_fmu, "CACHE_FOLDER", tmp_path / "empty")
    again = native_fmu.build(toy_model.MODEL, tmp_path, [host()], fmi=3)
    assert again.read_bytes() == fmi3_fmus["Toy"].read_bytes()
    stamp = again.stat().st_mtime_ns
    assert native_fmu.build(toy_model.MODEL, tmp_path, [host()], fmi=3).stat().st_mtime_ns == stamp
    tokens = {fmpy.read_model_description(str(path)).guid for path in (again, native_fmus["Toy"])}
    assert len(tokens) == 2
