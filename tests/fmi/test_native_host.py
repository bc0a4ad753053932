"""The native FMU in a host without Python: what it needs, leaks, fuzzed calls, sanitizers."""

import shutil
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import pytest

from controller_fmu import SYSTEM_MODELS
from fmus.native.library_cache import C_FILES
from fmus.native.platforms import LINUX
from fmus.native.sources import fmu_sources, unit_name
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.presentation.export.system_of import one_model
from tests.fmi.built import native_fmu_of
from tests.fmi.conftest import ALL_MODELS, MODELS
from tests.fmi.elf import dynamic
from tests.fmi.raw import OK, Library
from tests.fmi.raw3 import Library3

HERE = Path(__file__).parent
LIMIT = 400_000
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the host program uses dlopen")


STACK = 128 * 1024
"""Bytes: the default of a thread of musl. A thread has 512 kB on macOS, a program 1 MB on Windows."""


def host_program(source: str, folder: Path) -> Path:
    """Return a host program that does everything in a thread of ``STACK``, made by the compiler of the FMUs."""
    program = folder / "host"
    options = [
        "-target",
        LINUX.triple,
        "-std=gnu11",
        "-O1",
        "-Wall",
        "-Wextra",
        f"-I{C_FILES}",
        f"-DHOST_STACK={STACK}",
    ]
    libraries = ["-ldl", "-lm", "-lpthread"]
    command = [sys.executable, "-m", "ziglang", "cc", *options, str(HERE / source), "-o", str(program), *libraries]
    subprocess.run(command, check=True)
    return program


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The host program for FMI 2.0."""
    return host_program("host.c", tmp_path_factory.mktemp("host"))


@pytest.fixture(scope="module")
def host3(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The host program for FMI 3.0."""
    return host_program("host3.c", tmp_path_factory.mktemp("host3"))


@pytest.fixture
def library(native_fmus: Any, model: Any, tmp_path: Path) -> Any:
    return Library(native_fmus[model.name], tmp_path)


def run(*command: Any, **more: Any) -> Any:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, env={}, check=False, **more)
    assert done.returncode == 0, (done.returncode, done.stdout, done.stderr)
    return done.stdout


def test_needs_nothing_but_the_c_library(library: Any, model: Any) -> None:
    content = library.file.read_bytes()
    needed, undefined, defined = dynamic(content)
    assert set(needed) <= {"libc.so.6", "libm.so.6"}
    assert "malloc" in undefined
    assert not [name for name in undefined if name.startswith(("Py", "_Py", "fmi2", model.name))]
    assert all(name.startswith("fmi2") for name in defined)
    assert len(defined) == 34
    assert len(content) < LIMIT


def test_steps_in_a_host_without_python(host: Any, library: Any) -> None:
    names = [v.name for v in library.description.modelVariables if v.causality == "output" and v.type == "Real"][:20]
    references = [library.refs[name] for name in names]
    text = run(host, "run", library.file, library.description.guid, 50, 0.01, *references)
    rows = [[float.fromhex(word) for word in line.split()] for line in text.splitlines()]
    component = library.initialized()
    for number, row in enumerate(rows):
        assert library.step(component, number * 0.01) == OK
        assert [library.get(component, name) for name in names] == row
    assert number == 49
    library.free(component)


def test_ten_thousand_instances_leave_no_memory_behind(host: Any, library: Any) -> None:
    before, after = map(int, run(host, "many", library.file, library.description.guid, 10_000).split())
    assert after < before + 200, "kB; the smallest leak, 32 bytes per instance, would be 280"


def test_a_hundred_instances_do_not_know_of_each_other(native_fmus: Any, tmp_path: Path) -> None:
    toy = Library(native_fmus["Toy"], tmp_path)
    crowd = [toy.initialized(stiffness=float(10 + number)) for number in range(100)]
    for k in range(20):
        for component in crowd:
            assert toy.step(component, 0.01 * k) == OK
    together = [toy.outputs(component) for component in crowd]
    for number in (0, 50, 99):
        alone = toy.initialized(stiffness=float(10 + number))
        for k in range(20):
            toy.step(alone, 0.01 * k)
        assert toy.outputs(alone) == together[number]
        toy.free(alone)
    assert len({str(values) for values in together}) == 100
    for component in crowd:
        toy.free(component)


def test_instances_on_several_threads(native_fmus: Any, tmp_path: Path) -> None:
    toy = Library(native_fmus["Toy"], tmp_path)
    found = {}

    def drive(number: Any) -> None:
        component = toy.initialized(stiffness=float(10 + number))
        for k in range(500):
            toy.step(component, 0.01 * k)
        found[number] = toy.outputs(component)
        toy.free(component)

    threads = [threading.Thread(target=drive, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    together = dict(found)
    for number in range(4):
        drive(number)
    assert found == together
    assert len({str(values) for values in found.values()}) == 4


@pytest.mark.parametrize("seed", [1, 2])
def test_no_random_call_crashes(host: Any, native_fmus: Any, any_model: Any, tmp_path: Path, seed: int) -> None:
    library = Library(native_fmus[any_model.name], tmp_path)
    text = run(host, "fuzz", library.file, library.description.guid, seed, 20_000, timeout=120)
    calls, refused, messages, functions = (int(word.split()[0]) for word in text.split(", "))
    assert calls == 20_000
    assert 0.2 < refused / calls < 0.8
    assert messages > refused / 2
    assert functions == len(dynamic(library.file.read_bytes())[2]), "all that the library exports"


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in MODELS else pytest.mark.release) for name in ALL_MODELS]
)
def test_no_random_call_of_fmi_3_crashes(host3: Any, fmi3_fmus: Any, name: str, tmp_path: Path) -> None:
    library = Library3(fmi3_fmus[name], tmp_path)
    text = run(host3, library.file, library.description.guid, 1, 30_000, timeout=120)
    calls, refused, messages, functions = (int(word.split()[0]) for word in text.split(", "))
    assert calls == 30_000
    assert 0.2 < refused / calls < 0.8
    assert messages > refused / 3
    assert functions == len(dynamic(library.file.read_bytes())[2]), "all that the library exports"


OTHERS = {f"system {system.name.lower()}": lambda system=system: SYSTEM_MODELS[system] for system in SYSTEM_MODELS}
OTHERS |= {
    f"container {name}": lambda name=name: one_model(load_scenario(name, []))
    for name in ("guo2015-case4", "apa-parallel")
}
"""FMUs that users build beside those of :data:`ALL_MODELS`: of one system, and of a scenario as a whole."""


@pytest.mark.release
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", OTHERS)
def test_no_random_call_of_other_fmus_crashes(host: Any, host3: Any, name: str, fmi: int, tmp_path: Path) -> None:
    path = native_fmu_of(OTHERS[name](), fmi)
    if fmi == 2:
        library: Any = Library(path, tmp_path)
        text = run(host, "fuzz", library.file, library.description.guid, 1, 20_000, timeout=300)
    else:
        library = Library3(path, tmp_path)
        text = run(host3, library.file, library.description.guid, 1, 30_000, timeout=300)
    calls, refused, _, functions = (int(word.split()[0]) for word in text.split(", "))
    assert calls >= 20_000
    assert 0.2 < refused / calls < 0.8
    assert functions == len(dynamic(library.file.read_bytes())[2]), "all that the library exports"


def sanitized(model: Any, fmi: Any, source: Any, folder: Any) -> Any:
    """Return (library, host program), made with AddressSanitizer and the undefined-behaviour sanitizer."""
    for name, text in fmu_sources(model, "{sanitized}", fmi).items():
        (folder / name).write_text(text)
    options = ["-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-Wall", "-Wextra"]
    library, program = folder / "model.so", folder / "host"
    how = {"check": True, "capture_output": True, "cwd": folder}
    unit = [unit_name(model, fmi), "-std=c99", f"-DFMI{fmi}_OVERRIDE_FUNCTION_PREFIX", "-fPIC", "-shared"]
    subprocess.run(["gcc", *options, *unit, "-o", str(library), "-lm"], **how)
    host = [f"-I{folder}", "-std=gnu11", str(HERE / source), "-o", str(program), "-ldl", "-lm"]
    subprocess.run(["gcc", *options, *host], **how)
    return library, program


needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc for its AddressSanitizer")


@pytest.mark.release
@needs_gcc
def test_sanitizers_find_nothing(any_model: Any, tmp_path: Path) -> None:
    library, program = sanitized(any_model, 2, "host.c", tmp_path)
    run(program, "many", library, "{sanitized}", 100)
    assert "refused" in run(program, "fuzz", library, "{sanitized}", 3, 20_000, timeout=300)


@pytest.mark.release
@needs_gcc
def test_sanitizers_find_nothing_in_fmi_3(any_model: Any, tmp_path: Path) -> None:
    library, program = sanitized(any_model, 3, "host3.c", tmp_path)
    for seed in (1, 2):
        text = run(program, library, "{sanitized}", seed, 30_000, timeout=300)
        calls, refused, messages, _ = (int(word.split()[0]) for word in text.split(", "))
        assert calls == 30_000
        assert 0.2 < refused / calls < 0.8
        assert messages > refused / 3


@pytest.mark.release
@needs_gcc
@pytest.mark.parametrize("fmi", [2, 3])
def test_instances_in_several_threads_share_nothing(any_model: Any, fmi: int, tmp_path: Path) -> None:
    """ThreadSanitizer sees every access to memory."""
    for name, text in fmu_sources(any_model, "{threads}", fmi).items():
        (tmp_path / name).write_text(text)
    options = ["-g", "-O1", "-fsanitize=thread", f"-I{tmp_path}"]
    options += [f"-DFMI={fmi}", f"-DFMI{fmi}_OVERRIDE_FUNCTION_PREFIX"]
    sources = [unit_name(any_model, fmi), str(HERE / "threads.c")]
    command = ["gcc", *options, "-std=gnu11", *sources, "-o", "threads", "-lm", "-lpthread"]
    subprocess.run(command, check=True, cwd=tmp_path)
    assert run(tmp_path / "threads", "{threads}", timeout=300) == "3200 messages\n"


@pytest.mark.skipif(shutil.which("valgrind") is None, reason="needs valgrind")
def test_valgrind_finds_nothing(host: Any, native_fmus: Any, tmp_path: Path) -> None:
    toy = Library(native_fmus["Toy"], tmp_path)
    check = ["valgrind", "--quiet", "--leak-check=full", "--error-exitcode=9"]
    command = [*check, str(host), "fuzz", str(toy.file), toy.description.guid, "5", "3000"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
