"""The model of docs/write-a-model.md, one file, becomes every kind of FMU and a C library; a mistake gets one line."""

import json
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest
from fmpy import simulate_fmu

from fmus.native.compilers import can_compile
from orchestrator.cli import main
from tests.fmi.fmpy_check import problems_of

PAGE = (Path(__file__).parents[2] / "docs" / "write-a-model.md").read_text(encoding="utf-8")
(TANK,) = re.findall(r"^```python\n(.*?)^```", PAGE, re.S | re.M)
ROWS = re.findall(r"^\| (.+) \| `(.+)` \| `tank\.py:(\d+): (.+)` \|$", PAGE, re.M)
"""The table of mistakes: what, the line as it is wrong, its number, the answer."""
INFLOW = '    inflow: Annotated[float, Signal("m3/s", "through the valve")] = 0.0'
SPAN = 10.0
MISTAKES = {
    "a list": ("    outflow = params", "    parts = [0.5, 0.5]\n    outflow = params"),
    "a string": ("    outflow = params", '    mode = "open"\n    outflow = params'),
    "an argument without a type": ("def measured(level: float, params", "def measured(level, params"),
    "a result without a type": ("params: Params) -> Output:", "params: Params):"),
    "a float that starts at `0`": (INFLOW, INFLOW.replace("0.0", "0")),
    "no unit and meaning": (INFLOW, "    inflow: float = 0.0"),
    "no meaning": (INFLOW, INFLOW.replace(', "through the valve"', "")),
    "a unit that is none": (INFLOW, INFLOW.replace("m3/s", "litres")),
    "no default": (INFLOW, INFLOW.removesuffix(" = 0.0")),
    "no type": (INFLOW, "    inflow = 0.0"),
    "a list as a field": (INFLOW, "    inflow: list[float] = []"),
    "a default out of its range": ("0.1, 10.0)] = 3.0", "0.1, 10.0)] = 30.0"),
    "an int that becomes a float": (
        "    outflow = params",
        "    part = 0\n    part = part + 0.5\n    outflow = params",
    ),
    "a parameter that is not there": ("params.hole", "params.holes"),
    "a function that raises": ("math.sqrt(2.0 * 9.81", "math.sqrt(-2.0 * 9.81"),
    "a module of others": ("import math\n", "import math\nimport numpy as np\n"),
    "a syntax error": ("    outflow = params", "    outflow == = params"),
}
LINES = Path(__file__).with_name("own_model_mistakes.tsv").read_text(encoding="utf-8").splitlines()[1:]
ANSWERS = {what: (int(number), text) for what, number, text in (line.split("\t") for line in LINES)}
"""What is said of each mistake, and of which line."""


def answer(folder: Any, text: Any, capsys: pytest.CaptureFixture[str], name: str = "tank.py") -> Any:
    """Return exit code and what is said of a model file with ``text``."""
    (folder / name).write_text(text, encoding="utf-8")
    code = main(["build", "--model", str(folder / name), "--out", str(folder / "out")])
    assert not (folder / "out").exists() or code == 0
    return code, capsys.readouterr().err


def wrong(what: Any) -> Any:
    """Return the model with a mistake, and the number and text of the line that has it."""
    old, new = MISTAKES[what]
    assert TANK.count(old) == 1, old
    text = TANK.replace(old, new)
    pairs = enumerate(zip(text.splitlines(), TANK.splitlines(), strict=False), start=1)
    number = next(number for number, (one, other) in pairs if one != other)
    return text, number, text.splitlines()[number - 1].strip()


@pytest.mark.parametrize("code", [0, 5])
def test_a_file_that_ends_the_program_is_no_success(
    code: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found, said = answer(tmp_path, f"import sys\n\nsys.exit({code})\n", capsys)
    assert (found, said.count("\n")) == (2, 1)
    assert f"tank.py:3: SystemExit: {code}" in said


@pytest.mark.parametrize("what", MISTAKES)
def test_a_mistake_is_answered_in_one_line(what: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, _, _ = wrong(what)
    code, said = answer(tmp_path, text, capsys)
    assert code == 2
    assert len(said.splitlines()) == 1, said
    assert said == f"apa: tank.py:{ANSWERS[what][0]}: {ANSWERS[what][1]}\n"
    assert "Traceback" not in said


def test_the_page_has_mistakes_as_they_are_answered() -> None:
    assert len(ROWS) >= 5
    for what, line, number, text in ROWS:
        assert (int(number), text) == ANSWERS[what]
        assert line == wrong(what)[0].splitlines()[int(number) - 1].strip()


@pytest.mark.parametrize(
    ("name", "argument", "said"),
    [
        ("nowhere.py", "nowhere.py", "nowhere.py: there is no such file"),
        ("math.py", "math.py", "there is another Python module called math: rename the file"),
        ("modelkit.py", "modelkit.py", "there is another Python module called modelkit: rename the file"),
        ("two-arcs.py", "two-arcs.py", "'two-arcs' is no name for a Python module"),
        ("tank.py", "tank.py:TANK", "no Model is called TANK: it has MODEL"),
        ("tank.txt", "tank.txt", "a model is a .py file, or a folder with __init__.py"),
    ],
)
def test_a_file_that_is_none_is_refused(
    name: str, argument: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if name != "nowhere.py":
        (tmp_path / name).write_text(TANK, encoding="utf-8")
    assert main(["build", "--model", str(tmp_path / argument), "--out", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line


def test_a_place_is_needed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "tank.py").write_text(TANK, encoding="utf-8")
    assert main(["build", "--model", str(tmp_path / "tank.py")]) == 2
    assert capsys.readouterr().err == "apa: --model: a model of your own needs a place: give --out\n"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The folder in which one command has built everything."""
    if not can_compile():
        pytest.skip("needs a C compiler")
    folder = tmp_path_factory.mktemp("own model")
    (folder / "tank.py").write_text(TANK, encoding="utf-8")
    assert main(["build", "--model", f"{folder / 'tank.py'}:MODEL", "--out", str(folder / "out"), "--json"]) == 0
    return folder / "out"


@pytest.mark.parametrize("compiler", [["gcc"], [sys.executable, "-m", "ziglang", "cc"]], ids=["gcc", "clang"])
@pytest.mark.parametrize("kind", ["c", "native", "fmi3"])
def test_its_c_compiles_without_a_warning(kind: str, compiler: Any, built: Any, tmp_path: Path) -> None:
    if shutil.which(compiler[0]) is None:
        pytest.skip("needs gcc")
    unit = {"c": "Tank.c", "native": "Tank_fmi2.c", "fmi3": "Tank_fmi3.c"}[kind]
    sources = built / "c"
    if kind != "c":
        sources = tmp_path / "sources"
        with zipfile.ZipFile(built / kind / "Tank.fmu") as archive:
            archive.extractall(tmp_path, [name for name in archive.namelist() if name.startswith("sources/")])
    flags = ["-std=c99", "-O2", "-pedantic", "-Wall", "-Wextra", "-Wconversion"]
    command = [*compiler, *flags, "-c", str(sources / unit), "-o", str(tmp_path / "unit.o")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def levels(path: Any) -> Any:
    result = simulate_fmu(path, stop_time=SPAN, output_interval=0.1, output=["level"], start_values={"inflow": 0.02})
    return result["level"].tolist()


def test_every_kind_gives_the_same_bits(built: Any) -> None:
    found = {kind: levels(built / kind / "Tank.fmu") for kind in ("python", "native", "fmi3")}
    assert len(found["native"]) == 101
    assert found["python"] == found["native"] == found["fmi3"]
    assert found["native"][0] == 1.0 > found["native"][-1] > 0.8


@pytest.mark.parametrize("kind", ["python", "native", "fmi3"])
def test_fmpy_finds_nothing_to_complain_about(built: Any, kind: str) -> None:
    assert problems_of(built / kind / "Tank.fmu") == []


def test_the_c_library_gives_the_bits_of_the_fmu(built: Any, tmp_path: Path) -> None:
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("needs a cc")
    text = (
        (built / "c" / "main.c")
        .read_text()
        .replace("    /* here is", "    model.inputs.inflow = 0.02;\n    /* here is")
    )
    (built / "c" / "main.c").write_text(text)
    program = str(tmp_path / "example")
    command = [compiler, "-std=c99", "-O2", "-ffp-contract=off", "main.c", "Tank.c", "-lm", "-o", program]
    subprocess.run(command, cwd=built / "c", check=True)
    printed = subprocess.run([tmp_path / "example"], check=True, capture_output=True, text=True).stdout
    rows = [line.split() for line in printed.splitlines()]
    fmu = levels(built / "native" / "Tank.fmu")
    assert len(rows) == 21
    assert [float(row[-1]) for row in rows] == [fmu[round(float(row[0]) * 10.0)] for row in rows]


BARE = '''
"""A pendulum that nobody drives: no inputs, and what it puts out is its state."""

import math
import sys
from typing import Annotated, NamedTuple

from modelkit.model import Model
from modelkit.signal import Signal


class Inputs(NamedTuple):
    """None."""


class Params(NamedTuple):
    """{params}"""


class State(NamedTuple):
    """Of the pendulum."""

    angle: Annotated[float, Signal("rad", "from hanging down")] = 0.5
    rate: Annotated[float, Signal("rad/s", "of the angle")] = 0.0


def initialize(params: Params) -> tuple[State, State]:
    return State(), State()


def step(state: State, inputs: Inputs, params: Params, dt_ns: int) -> tuple[State, State]:
    rate = state.rate - dt_ns * 1e-9 * 9.81 * math.sin(state.angle)
    state = State(state.angle + dt_ns * 1e-9 * rate, rate)
    return state, state


MODEL = Model(
    "Pendulum", "a pendulum", sys.modules[__name__], State, Params, Inputs, State, initialize, step, 0.01, 10.0
)
'''
LENGTH = (
    'Of it."""\n\n    length: Annotated[float, Signal("m", "of the rod", low=0.1, high=10.0)] = 1.0\n    """Unused.'
)


@pytest.mark.skipif(not can_compile(), reason="needs a C compiler")
@pytest.mark.parametrize("params", ["None.", LENGTH], ids=["no parameters", "a parameter"])
def test_a_model_without_inputs_whose_outputs_are_its_state(params: Any, tmp_path: Path) -> None:
    (tmp_path / "bare.py").write_text(BARE.format(params=params), encoding="utf-8")
    assert main(["build", "--model", str(tmp_path / "bare.py"), "--out", str(tmp_path / "out")]) == 0
    rows = []
    for kind in ("python", "native", "fmi3"):
        path = str(tmp_path / "out" / kind / "Pendulum.fmu")
        assert problems_of(path) == []
        result = simulate_fmu(path, stop_time=3.0, output_interval=0.01)
        assert result.dtype.names == ("time", "angle", "rate")
        rows.append(result.tolist())
    assert rows[0] == rows[1] == rows[2]
    assert -0.5 < rows[0][-1][1] < -0.4
    compiler = shutil.which("cc")
    if compiler is not None:
        flags = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-o", "example"]
        subprocess.run([compiler, *flags, "main.c", "Pendulum.c", "-lm"], cwd=tmp_path / "out" / "c", check=True)


def test_the_second_time_nothing_has_changed(built: Any, capsys: pytest.CaptureFixture[str]) -> None:
    model = str(built.parent / "tank.py")
    kept = {path: path.read_bytes() for path in built.rglob("Tank.*")}
    (built / "c" / "main.c").unlink()
    assert main(["build", "--model", model, "--out", str(built), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [(row["kind"], row["changed"]) for row in rows] == [
        (kind, False) for kind in ("python", "native", "fmi3", "c")
    ]
    assert {path: path.read_bytes() for path in kept} == kept


def test_the_python_fmu_holds_the_file_below_its_own_root(built: Any) -> None:
    with zipfile.ZipFile(built / "python" / "Tank.fmu") as archive:
        (name,) = (name for name in archive.namelist() if name.endswith("/tank.py"))
        root = name.split("/")[1]
        assert f"from {root}.modelkit.model import Model" in archive.read(name).decode()


def test_a_package_of_several_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    package = tmp_path / "basin"
    package.mkdir()
    text = TANK.replace("import math\n", "from basin.law import outflow\n")
    text = text.replace("params.hole * math.sqrt(2.0 * 9.81 * state.level)", "outflow(params.hole, state.level)")
    text = text.replace("    outflow = outflow(", "    lost = outflow(").replace("inflow - outflow)", "inflow - lost)")
    (package / "__init__.py").write_text(text, encoding="utf-8")
    law = "import math\n\n\ndef outflow(hole: float, level: float) -> float:\n"
    (package / "law.py").write_text(f"{law}    return hole * math.sqrt(2.0 * 9.81 * level)\n", encoding="utf-8")
    assert main(["build", "--model", str(package), "--out", str(tmp_path / "out"), "--fmus", "python"]) == 0
    assert levels(tmp_path / "out" / "python" / "Tank.fmu")[-1] < 1.0
    (package / "law.py").write_text(f"{law}    return [hole]\n", encoding="utf-8")
    code = main(["build", "--model", str(package), "--out", str(tmp_path / "out")])
    assert (code, capsys.readouterr().err.splitlines()[-1][:24]) == (2, "apa: basin/law.py:5: a l")
