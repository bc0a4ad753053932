"""The native FMU is its model, to the bit, and differs from the PythonFMU in nothing else."""

import re
import struct
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import fmpy
import pytest

from fmus.contents.archive import archive_guid
from fmus.contents.variables import fmi_variables
from fmus.native import compilers
from fmus.native import fmu as native_fmu
from fmus.native.platforms import host
from tests.fmi.fmpy_check import problems_of
from tests.fmi.host import OK, Host, random_inputs
from tests.fmi.test_python_fmu import STEPS, in_process


def bits(values: Any) -> Any:
    return [struct.pack("d", value) if isinstance(value, float) else value for value in values]


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.release)])
def test_equals_the_model_in_process_to_the_bit(native_fmus: Any, model: Any, seed: int) -> None:
    inputs = random_inputs(fmi_variables(model), seed, len(STEPS))
    expected = in_process(model, inputs, STEPS)
    with Host(native_fmus[model.name]) as fmu:
        fmu.initialize()
        assert bits(fmu.outputs()) == bits(expected[0])
        time = 0.0
        for number, (size, values) in enumerate(zip(STEPS, inputs, strict=True), start=1):
            fmu.set(values)
            assert fmu.step(time, size) == OK
            time += size
            assert bits(fmu.outputs()) == bits(expected[number])
        assert fmu.get(["time"]) == [time]
        assert fmu.log == []


def test_starts_at_any_time_and_steps_are_rounded_at_their_ends(native_fmus: Any) -> None:
    with Host(native_fmus["Toy"]) as fmu:
        fmu.initialize(start=7.5)
        assert fmu.get(["time"]) == [7.5]
        time = 7.5
        for number in range(1, 301):
            assert fmu.step(time, 1.0 / 3.0) == OK
            time = 7.5 + number * (1.0 / 3.0)
        assert fmu.get(["count"]) == [300]


def test_simulates_alone_and_gives_the_reference_result(native_fmus: Any, model: Any, tmp_path: Path) -> None:
    fmpy.extract(str(native_fmus[model.name]), str(tmp_path))
    reference = fmpy.util.read_csv(tmp_path / f"extra/org.fmi-standard.fmi-ls-ref/{model.name}_out.csv")
    stop, interval = reference["time"][-1], reference["time"][1]
    names = list(reference.dtype.names[1:])
    result = fmpy.simulate_fmu(
        str(native_fmus[model.name]), stop_time=stop, step_size=model.step_size, output_interval=interval, output=names
    )
    assert len(result) == len(reference) > 50
    for name in names:
        assert (result[name] == reference[name]).all(), name


def test_description_is_the_python_fmus_but_for_guid_tool_and_sources(
    native_fmus: Any, python_fmus: Any, model: Any
) -> None:
    def text(path: Any) -> Any:
        with zipfile.ZipFile(path) as archive:
            root: Any = ElementTree.fromstring(archive.read("modelDescription.xml"))
        for sources in root.findall("CoSimulation/SourceFiles"):
            root.find("CoSimulation").remove(sources)
        for name in ("guid", "generationTool"):
            del root.attrib[name]
        return ElementTree.canonicalize(ElementTree.tostring(root), strip_text=True)

    assert text(native_fmus[model.name]) == text(python_fmus[model.name])


def test_fmpy_refuses_a_name_that_is_none(native_fmus: Any, tmp_path: Path) -> None:
    with zipfile.ZipFile(native_fmus["Toy"]) as archive:
        archive.extractall(tmp_path / "toy")
    described = tmp_path / "toy" / "modelDescription.xml"
    text = described.read_text(encoding="utf-8")
    name = re.search(r'<ScalarVariable name="([^"]+)"', text)
    assert name
    described.write_text(text.replace(f'"{name[1]}"', '"1..x"', 1), encoding="utf-8")
    for _ in range(2):
        assert any('"1..x"' in problem for problem in problems_of(tmp_path / "toy"))


@pytest.mark.parametrize(
    "name", ["Toy", *(pytest.param(name, marks=pytest.mark.release) for name in ("Vehicle", "Controller"))]
)
def test_checkers_find_nothing(native_fmus: Any, name: str) -> None:
    """``test_python_fmu_file.py`` has the descriptions of the others, which are the same, on each change."""
    path = str(native_fmus[name])
    assert problems_of(path) == []
    command = [str(Path(sys.executable).parent / "fmutool"), "-input", path, "-check"]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    text = result.stdout + result.stderr
    assert "No semantic error" in text
    assert "ERROR" not in text
    assert "WARNING" not in text


def test_two_builds_are_the_same_bytes(native_fmus: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from toy_model import MODEL

    monkeypatch.setattr(native_fmu, "CACHE_FOLDER", tmp_path / "empty")
    again = native_fmu.build(MODEL, tmp_path / "elsewhere", [host()])
    assert again.read_bytes() == native_fmus["Toy"].read_bytes()
    stamp = again.stat().st_mtime_ns
    assert native_fmu.build(MODEL, tmp_path / "elsewhere", [host()]).stat().st_mtime_ns == stamp


def test_the_same_content_is_compiled_once(native_fmus: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from toy_model import MODEL

    monkeypatch.setattr(native_fmu, "CACHE_FOLDER", tmp_path / "cache")
    first = native_fmu.build(MODEL, tmp_path / "one", [host()])
    monkeypatch.setattr(native_fmu, "binaries", None)
    assert native_fmu.build(MODEL, tmp_path / "other", [host()]).read_bytes() == first.read_bytes()
    with pytest.raises(TypeError):
        native_fmu.build(MODEL, tmp_path / "other", [host()], fmi=3)


def test_another_model_has_another_guid(native_fmus: Any) -> None:
    guids = {fmpy.read_model_description(str(native_fmus[name])).guid for name in ("Toy", "Vehicle", "Controller")}
    assert len(guids) == 3


def test_another_flag_of_the_compiler_gives_another_guid(
    native_fmus: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from toy_model import MODEL

    with monkeypatch.context() as patch:
        patch.setattr(compilers, "SHARED", (*compilers.SHARED, "-DANOTHER"))
        shared = native_fmu.build(MODEL, tmp_path / "shared", [host()])
    with monkeypatch.context() as patch:
        patch.setattr(compilers, "ZIG", compilers.ZIG[:1])
        zig = native_fmu.build(MODEL, tmp_path / "zig", [host()], compilers.find_compiler("zig"))
    assert len({archive_guid(path) for path in (native_fmus["Toy"], shared, zig)}) == 3
