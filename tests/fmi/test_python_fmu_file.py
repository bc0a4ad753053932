"""What is in the .fmu file: valid, complete, the same bytes at every build."""

import io
import os
import struct
import subprocess
import sys
import zipfile
import zlib
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import fmpy
import pytest
from lxml import etree

from controller_fmu import APA
from fmus.build import build_all
from fmus.contents.archive import archive_bytes, archive_guid, content_guid
from fmus.contents.description import model_description
from fmus.contents.fmu_documentation import terminals
from fmus.contents.units import unit
from fmus.contents.variables import fmi_variables
from fmus.python import fmu as python_fmu
from fmus.python.fmu import build
from tests.fmi.fmpy_check import problems_of
from vehicle_fmu import MODEL as VEHICLE

BIN = Path(sys.executable).parent


def read(path: Any, name: Any) -> Any:
    with zipfile.ZipFile(path) as archive:
        return archive.read(name)


def description(path: Any) -> Any:
    return ElementTree.fromstring(read(path, "modelDescription.xml"))


def test_fmpy_finds_nothing_wrong(python_fmus: Any, model: Any) -> None:
    assert problems_of(python_fmus[model.name]) == []


def test_fmutool_finds_nothing_wrong(python_fmus: Any, model: Any) -> None:
    command = [BIN / "fmutool", "-input", python_fmus[model.name], "-check"]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    text = result.stdout + result.stderr
    assert "compliant with FMI-2.0" in text
    assert "No semantic error" in text
    assert "ERROR" not in text
    assert "WARNING" not in text


def test_builds_are_byte_identical(model: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one = build(model, tmp_path / "one")
    monkeypatch.setattr(python_fmu, "CACHE_FOLDER", tmp_path / "empty")
    assert build(model, tmp_path / "other").read_bytes() == one.read_bytes()


def test_a_build_in_another_process_is_byte_identical(python_fmus: Any, tmp_path: Path) -> None:
    code = "import toy_model; from fmus.native.libraries import python_front; from fmus.python import fmu; "
    code += "from pathlib import Path; fmu.CACHE_FOLDER = Path('empty'); "
    code += f"fmu.build(toy_model.MODEL, {str(tmp_path)!r}, python_front())"
    path = os.pathsep.join([str(Path(__file__).parent), *sys.path])
    environment = {"PYTHONHASHSEED": "5", "PYTHONPATH": path, "TZ": "A3"}
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, env=environment)
    assert (tmp_path / "Toy.fmu").read_bytes() == python_fmus["Toy"].read_bytes()


def test_an_unchanged_build_is_left_alone(tmp_path: Path) -> None:
    seen: list[Any] = []
    first = build_all(tmp_path, progress=seen.append)
    stamps = [built.path.stat().st_mtime_ns for built in first]
    second = build_all(tmp_path)
    assert seen == first
    assert [built.changed for built in first] == [True, True]
    assert [built.changed for built in second] == [False, False]
    assert [built.path.stat().st_mtime_ns for built in second] == stamps
    assert {built.path for built in first} == {tmp_path / "python/Controller.fmu", tmp_path / "python/Vehicle.fmu"}
    first[0].path.write_bytes(b"not a zip")
    assert [built.changed for built in build_all(tmp_path)] == [True, False]
    with pytest.raises(ValueError, match="kind 'wasm': expected one of"):
        build_all(tmp_path, kinds=("wasm",))


def test_the_archive_depends_on_its_content_alone() -> None:
    one, other = {"a": b"1", "b.so": b"2"}, {"b.so": b"2", "a": b"1"}
    assert archive_bytes(one) == archive_bytes(other)
    assert content_guid(one) == content_guid(other)
    assert content_guid({"a": b"12", "b": b""}) != content_guid({"a": b"1", "b": b"2"})
    entries = zipfile.ZipFile(io.BytesIO(archive_bytes(one))).infolist()
    assert {entry.date_time for entry in entries} == {(1980, 1, 1, 0, 0, 0)}
    assert {entry.compress_type for entry in entries} == {zipfile.ZIP_DEFLATED}


def test_guid_is_in_the_description_and_changes_with_the_content(python_fmus: Any) -> None:
    guids = {archive_guid(path) for path in python_fmus.values()}
    assert len(guids) == len(python_fmus)
    for path in python_fmus.values():
        assert description(path).get("guid") == archive_guid(path)


def test_every_real_has_a_unit_and_every_variable_a_meaning(python_fmus: Any, model: Any) -> None:
    root = description(python_fmus[model.name])
    defined = {node.get("name"): node for node in root.find("UnitDefinitions")}
    for scalar in root.find("ModelVariables"):
        assert scalar.get("description"), scalar.get("name")
        assert scalar.get("variability"), scalar.get("name")
        real = scalar.find("Real")
        if real is not None:
            assert real.get("unit") in defined, scalar.get("name")
            if real.get("unit") == "rad":
                assert real.get("displayUnit") == "deg"
    degrees = [node for name, node in defined.items() if name == "rad"]
    for node in degrees:
        assert float(node.find("DisplayUnit").get("factor")) == pytest.approx(57.29577951308232, rel=1e-15)


def test_value_references_are_one_running_number_in_the_order_of_the_types(python_fmus: Any, model: Any) -> None:
    scalars = list(description(python_fmus[model.name]).find("ModelVariables"))
    names = {int(scalar.get("valueReference")): scalar.get("name") for scalar in scalars}
    assert [names[vr] for vr in range(len(scalars))] == [item.name for item in fmi_variables(model)]


def test_what_is_connected_comes_first(python_fmus: Any, model: Any) -> None:
    scalars = list(description(python_fmus[model.name]).find("ModelVariables"))
    order = [scalar.get("causality") for scalar in scalars]
    assert order == sorted(order, key=["input", "output", "parameter", "local", "independent"].index)
    assert scalars[-1].get("name") == "time"


def test_outputs_depend_on_no_input_and_at_the_start_on_parameters(python_fmus: Any, model: Any) -> None:
    root = description(python_fmus[model.name])
    scalars = list(root.find("ModelVariables"))
    outputs = [str(place) for place, scalar in enumerate(scalars, 1) if scalar.get("causality") == "output"]
    structure = root.find("ModelStructure")
    assert [node.get("index") for node in structure.find("Outputs")] == outputs
    assert {node.get("dependencies") for node in structure.find("Outputs")} == {""}
    assert [node.get("index") for node in structure.find("InitialUnknowns")] == outputs
    depended = {place for node in structure.find("InitialUnknowns") for place in node.get("dependencies").split()}
    assert {scalars[int(place) - 1].get("causality") for place in depended} == {"parameter"}


def test_capabilities_and_default_experiment(python_fmus: Any, model: Any) -> None:
    root = description(python_fmus[model.name])
    simulation = root.find("CoSimulation")
    for flag in ("canHandleVariableCommunicationStepSize", "canGetAndSetFMUstate", "canSerializeFMUstate"):
        assert simulation.get(flag) == "true"
    for flag in ("needsExecutionTool", "canBeInstantiatedOnlyOncePerProcess"):
        assert simulation.get(flag) == "false"
    assert float(root.find("DefaultExperiment").get("stepSize")) == model.step_size
    assert root.get("generationDateAndTime").endswith("Z")
    assert len(root.find("LogCategories")) == 5


def test_the_kind_of_fmu_changes_only_what_it_says(model: Any) -> None:
    one: Any = ElementTree.fromstring(model_description(model, guid="a", generation_tool="b", flags={"x": True}))
    other: Any = ElementTree.fromstring(model_description(model, guid="c", generation_tool="d", flags={"x": False}))
    for root in (one, other):
        for name in ("guid", "generationTool"):
            del root.attrib[name]
        del root.find("CoSimulation").attrib["x"]
    assert ElementTree.tostring(one) == ElementTree.tostring(other)


def test_documentation_names_every_variable(python_fmus: Any, model: Any) -> None:
    page = read(python_fmus[model.name], "documentation/index.html").decode()
    for variable in fmi_variables(model)[:-1]:
        assert f"<td class='v'>{variable.name}</td>" in page
    assert "CPython 3.11" in page
    assert b"MIT License" in read(python_fmus[model.name], "documentation/licenses/license.txt")
    assert b"Permission is hereby granted" in read(python_fmus[model.name], "documentation/licenses/pythonfmu.txt")


def test_icon_is_a_picture(python_fmus: Any, model: Any) -> None:
    content = read(python_fmus[model.name], "model.png")
    assert content.startswith(b"\x89PNG\r\n\x1a\n")
    width, height = struct.unpack(">II", content[16:24])
    length = struct.unpack(">I", content[33:37])[0]
    pixels = zlib.decompress(content[41 : 41 + length])
    assert (width, height) == (96, 96)
    assert len(pixels) == height * (1 + 4 * width)
    rows = [pixels[1 + row * (1 + 4 * width) : (row + 1) * (1 + 4 * width)] for row in range(height)]
    colours = {row[place : place + 4] for row in rows for place in range(0, 4 * width, 4)}
    assert len(colours) > 10
    assert bytes([255, 255, 255, 0]) in colours


def test_terminals_keep_to_their_schema(python_fmus: Any, model: Any) -> None:
    schema = Path(fmpy.__file__).parent / "schema/fmi3/fmi3TerminalsAndIcons.xsd"
    document = etree.fromstring(read(python_fmus[model.name], "terminalsAndIcons/terminalsAndIcons.xml"))
    assert document.get("fmiVersion") == "2.0", "that of the model description, or FMI Library refuses the FMU"
    document.set("fmiVersion", "3.0")
    etree.XMLSchema(file=str(schema)).assertValid(document)
    members = [node.get("variableName") for node in document.iter("TerminalMemberVariable")]
    assert len(members) == len(set(members))
    ports = {item.name for item in fmi_variables(model) if item.causality in ("input", "output")}
    assert set(members) <= ports if model.terminals else set(members) == ports


def test_every_connected_signal_is_in_a_terminal_of_both() -> None:
    signals = [{item.name: name for name, item in _terminal_members(model)} for model in (VEHICLE, APA)]
    ports = [{v.name: v.causality for v in fmi_variables(model)} for model in (VEHICLE, APA)]
    pairs = {name for name in ports[0] if {ports[0][name], ports[1].get(name)} == {"input", "output"}}
    assert len(pairs) > 30
    assert set(signals[0]) == set(signals[1]) == pairs
    assert signals[0] == signals[1]


def _terminal_members(model: Any) -> Any:
    known = {item.name: item for item in fmi_variables(model)}
    root = ElementTree.fromstring(terminals(model))
    return [(t.get("name"), known[node.attrib["variableName"]]) for t in root.iter("Terminal") for node in t]


@pytest.mark.parametrize(
    ("name", "exponents", "factor", "display"),
    [
        ("m/s2", {"m": 1, "s": -2}, 1.0, None),
        ("1", {}, 1.0, None),
        ("1/m2", {"m": -2}, 1.0, None),
        ("N.m/rad", {"kg": 1, "m": 2, "s": -2, "rad": -1}, 1.0, ("N.m/deg", 0.017453292519943295)),
        ("rad/s", {"s": -1, "rad": 1}, 1.0, ("deg/s", 57.29577951308232)),
        ("kg/(m.s)", {"kg": 1, "m": -1, "s": -1}, 1.0, None),
        ("kg.m2", {"kg": 1, "m": 2}, 1.0, None),
        ("km/h", {"m": 1, "s": -1}, 1.0 / 3.6, None),
        ("m.s-1", {"m": 1, "s": -1}, 1.0, None),
    ],
)
def test_units(name: Any, exponents: Any, factor: Any, display: Any) -> None:
    this = unit(name)
    assert this.exponents == exponents
    assert this.factor == pytest.approx(factor, rel=1e-15)
    assert this.display == (display and display[0])
    assert this.display_factor == pytest.approx(display[1] if display else 1.0, rel=1e-14)


@pytest.mark.parametrize("name", ["", "furlong", "m//", "m/", "m/(s", "m^x", "rad s"])
def test_an_unreadable_unit_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="unit"):
        unit(name)
