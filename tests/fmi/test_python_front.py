"""The library before PythonFMU's: any path and URI, no logger, nothing asked for, wrong GUID, the end of the process.

Each case is a process of its own that calls the binary by ctypes, as a crash ends it.
"""

import json
import os
import platform
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
import toy_model

from fmus.native.compilers import can_compile
from fmus.native.libraries import python_front
from fmus.native.library_cache import C_FILES
from fmus.python.fmu import BEHIND, build
from tests.fmi.raw import DISCARD, ERROR, OK

HERE = Path(__file__).parent
pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() != "x86_64" or not can_compile(), reason="linux64 with a C compiler"
)
NAMES = [
    *("it's 50%41 #1", "q?m=1&n äö 日本"),
    *(
        pytest.param(name, marks=pytest.mark.release)
        for name in ("plain", "a blank", "a+b", "Program Files (x86)", "it's", "#1", "100%", "50%41", "a,b@c;d", "äö")
    ),
]
FORMS = {
    "file:///": lambda path: f"file://{quote(path)}",
    "file:/": lambda path: f"file:{quote(path)}",
    "file://localhost/": lambda path: f"file://localhost{quote(path)}",
    "FILE:/// with a slash behind": lambda path: f"FILE://{quote(path)}/",
    "small digits": lambda path: "file://" + "".join(f"%{ord(c):02x}" if c == " " else c for c in path),
    "not escaped": lambda path: f"file://{path}",
    "a path": lambda path: path,
    "nothing": lambda path: "",
    "of another place": lambda path: "http://example.org/fmu",
}
EACH_CHANGE = ("file:///", "FILE:/// with a slash behind", "a path", "of another place")


@pytest.fixture(scope="module")
def unpacked(python_fmus: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("unpacked") / "fmu"
    with zipfile.ZipFile(python_fmus["Toy"]) as archive:
        archive.extractall(folder)
    return folder


@pytest.fixture
def reference(unpacked: Any) -> Any:
    from fmpy import read_model_description

    known = read_model_description(str(unpacked)).modelVariables
    return next(v.valueReference for v in known if v.name == "oscillators[1].position")


@pytest.fixture(scope="module")
def expected() -> Any:
    """Where the first oscillator is after five steps."""
    params, inputs = toy_model.MODEL.params(), toy_model.MODEL.inputs()
    state, outputs = toy_model.MODEL.initialize(params)
    for _ in range(5):
        state, outputs = toy_model.MODEL.step(state, inputs, params, 10_000_000)
    return outputs.oscillators[0].position


def child(**reported: Any) -> Any:
    """Return what a process found that called the FMU in ``folder``; it must have ended in peace."""
    environment = {**os.environ, "MALLOC_PERTURB_": "165", "PYTHONPATH": os.pathsep.join([str(HERE), *sys.path])}
    command = [
        sys.executable,
        str(HERE / "python_child.py"),
        json.dumps({**reported, "folder": str(reported["folder"])}),
    ]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False, timeout=60)
    assert done.returncode == 0, (done.returncode, done.stderr)
    return json.loads(done.stdout)


def check(found: Any, expected: Any) -> None:
    assert found["made"], found["heard"]
    assert found["steps"] == [OK] * 5
    assert (found["get"], found["value"]) == (OK, expected)
    assert found["nothing"] == found["before"] == [OK] * 8
    assert found["null"] == ERROR
    assert found["without"] == [ERROR, 0]


@pytest.mark.parametrize("name", NAMES)
def test_any_path(unpacked: Any, reference: Any, expected: Any, tmp_path: Path, name: Any) -> None:
    folder = tmp_path / name / "fmu"
    shutil.copytree(unpacked, folder)
    check(child(folder=folder, uri=FORMS["file:///"](f"{folder}/resources"), reference=reference), expected)


@pytest.mark.parametrize(
    "form", [pytest.param(form, marks=() if form in EACH_CHANGE else pytest.mark.release) for form in FORMS]
)
def test_any_form_of_uri(unpacked: Any, reference: Any, expected: Any, tmp_path: Path, form: Any) -> None:
    folder = tmp_path / "a blank (and more)"
    shutil.copytree(unpacked, folder)
    check(child(folder=folder, uri=FORMS[form](f"{folder}/resources"), reference=reference), expected)


def test_no_uri_no_logger_no_functions(unpacked: Any, reference: Any, expected: Any) -> None:
    for less in ({"uri": None}, {"logger": False}, {"functions": False}):
        reported = {"folder": unpacked, "uri": f"file://{unpacked}/resources", "reference": reference, **less}
        check(child(**reported), expected)


def test_an_instance_that_is_never_freed_does_no_harm_at_the_end(unpacked: Any, reference: Any, expected: Any) -> None:
    check(child(folder=unpacked, reference=reference, leave=True), expected)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"guid": "{00000000-0000-0000-0000-000000000000}"}, "the GUID is not that of this FMU"),
        ({"guid": ""}, "the GUID is not that of this FMU"),
        ({"guid": None}, "the GUID is not that of this FMU"),
        ({"name": ""}, "an instance needs a name"),
        ({"name": None}, "an instance needs a name"),
    ],
)
def test_a_wrong_instantiation_is_refused_with_a_message(unpacked: Any, reference: Any, wrong: Any, said: str) -> None:
    found = child(folder=unpacked, reference=reference, **wrong)
    assert not found["made"]
    assert found["heard"] == [[ERROR, said]]
    assert not child(folder=unpacked, reference=reference, logger=False, **wrong)["made"]


def test_a_path_that_pythonfmu_misreads_is_refused(unpacked: Any, reference: Any, tmp_path: Path) -> None:
    folder = tmp_path / "a%20b"
    shutil.copytree(unpacked, folder)
    found = child(folder=folder, uri=FORMS["file:///"](f"{folder}/resources"), reference=reference)
    assert not found["made"]
    assert "%%20 in it" in found["heard"][0][1], "the host formats it as printf does"


def test_without_a_compiler_the_library_of_pythonfmu_stands_alone_and_the_page_says_so(tmp_path: Path) -> None:
    alone = build(toy_model.MODEL, tmp_path / "alone")
    both = build(toy_model.MODEL, tmp_path / "both", python_front())
    with zipfile.ZipFile(alone) as one, zipfile.ZipFile(both) as other:
        assert one.read("binaries/linux64/Toy.so") == other.read(f"binaries/linux64/{BEHIND}")
        assert other.read("binaries/linux64/Toy.so") == python_front()
        assert one.read("binaries/win64/Toy.dll") == other.read("binaries/win64/Toy.dll")
        assert one.read("resources/guid.txt") != other.read("resources/guid.txt")
        pages = [archive.read("documentation/index.html").decode() for archive in (one, other)]
    assert "On linux64 and win64 the library of PythonFMU" in pages[0]
    assert "On win64 the library of PythonFMU" in pages[1]
    front = python_front()
    assert front is not None
    assert len(front) < 40_000


def test_on_an_unknown_machine_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fmus.native.platforms.sys.platform", "plan9")
    assert python_front() is None


def test_the_answers_of_the_slave_come_through(python_fmus: Any, unpacked: Any, reference: Any) -> None:
    """A step before initialization is the slave's to refuse."""
    from tests.fmi.host import Host

    with Host(python_fmus["Toy"]) as host:
        assert host.step(0.0, 0.01) == DISCARD
        assert host.log[0][0] == ERROR


# Hosts that are no Python programs

PYTHON = Path(str(sysconfig.get_config_var("LIBDIR"))) / str(sysconfig.get_config_var("INSTSONAME"))


@pytest.fixture(scope="module")
def c_host(tmp_path_factory: pytest.TempPathFactory) -> Any:
    program = tmp_path_factory.mktemp("c_host") / "host"
    gcc = shutil.which("gcc")
    compiler = [gcc] if gcc else [sys.executable, "-m", "ziglang", "cc"]
    words = ["-std=gnu11", "-O1", f"-I{C_FILES}", str(HERE / "host.c"), "-o", str(program), "-ldl", "-lm"]
    subprocess.run([*compiler, *words], check=True)
    return program


def ran(c_host: Any, unpacked: Any, *words: Any, preload: bool = True) -> Any:
    guid = (unpacked / "resources/guid.txt").read_text()
    environment = {"PYTHONHOME": sys.base_prefix, "MALLOC_PERTURB_": "165"}
    environment |= {"LD_PRELOAD": str(PYTHON)} if preload else {}
    command = [c_host, words[0], unpacked / "binaries/linux64/Toy.so", guid, *words[1:]]
    return subprocess.run(command, capture_output=True, text=True, env=environment, check=False, timeout=60)


@pytest.mark.skipif(not PYTHON.is_file(), reason="Python's library is not shared here")
def test_a_host_in_c_with_pythons_library_loaded_runs_it_and_ends(
    c_host: Any, unpacked: Any, reference: Any, expected: Any
) -> None:
    done = ran(c_host, unpacked, "run", "5", "0.01", str(reference))
    assert done.returncode == 0, done.stderr
    assert float.fromhex(done.stdout.split()[-1]) == expected
    assert ran(c_host, unpacked, "many", "20").returncode == 0


def test_a_host_in_c_without_python_is_refused(c_host: Any, unpacked: Any, reference: Any) -> None:
    done = ran(c_host, unpacked, "run", "5", "0.01", str(reference), preload=False)
    assert done.returncode == 3, "no instance, no crash"
