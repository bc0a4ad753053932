"""The C is for readers: names, comments, order, width; and it is the same whenever and wherever it is made."""

import hashlib
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from fmus.compiler import translate
from fmus.compiler.target.layout import without_unused
from fmus.native.sources import translate_model
from orchestrator.inputs.scenario.models import MODELS
from tests.compiler.c_model import COMPILER, ZIG, compiled
from tests.compiler.language import load, model_of, whole_module

DOCS = Path(__file__).parents[2] / "docs" / "model-language.md"
WALLS = '''\
"""Where the nearest wall is."""

from enum import IntEnum
from typing import Annotated, NamedTuple

from modelkit.signal import Signal

FAR = 5.0


class Side(IntEnum):
    NOWHERE = 0
    LEFT = 1
    RIGHT = 2


{text}


class In(NamedTuple):
    readings: tuple[float, ...] = (FAR, FAR)


class Nothing(NamedTuple):
    unused: float = 0.0


Out = Wall


def initialize(params: Nothing) -> tuple[Nothing, Wall]:
    return Nothing(), Wall()


def step(state: Nothing, inputs: In, params: Nothing, dt_ns: int) -> tuple[Nothing, Wall]:
    return state, nearest(inputs.readings)
'''


@pytest.fixture(scope="module")
def translations() -> Any:
    return [translate_model(model) for model in MODELS.values()]


def test_lines_fit_on_a_page(translations: Any) -> None:
    for item in translations:
        for text in (item.header, item.source):
            assert max(map(len, text.splitlines())) <= 120
            assert text.isascii() or not re.search(r"[^\x00-\x7f]", re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL))


def test_every_function_has_its_docstring_and_its_file(translations: Any) -> None:
    vehicle = translations[0].source
    assert "/* Return the car at rest at its start pose, wheel straight, in park. */\nstatic " in vehicle
    for file in ("modelkit/geometry.py", "vehicle_fmu/steering.py", "vehicle_fmu/model.py"):
        assert f"/* -------- {file} ---" in vehicle
    assert vehicle.index("modelkit/geometry.py -") < vehicle.index("vehicle_fmu/steering.py -")
    assert vehicle.index("vehicle_fmu/steering.py -") < vehicle.index("vehicle_fmu/model.py -")


def test_units_and_meanings_are_in_the_header(translations: Any) -> None:
    assert "double wheelbase; /* [m] front to rear axle */" in translations[0].header
    assert "Body_SINGLE_TRACK = 1, /* Three degrees of freedom, linear tyres. */" in translations[0].header


def test_only_the_entries_are_external(translations: Any) -> None:
    for item in translations:
        heads = re.findall(r"^(?!static|typedef|enum|#|/| |\}|\{|$)(.*)\(", item.source, re.MULTILINE)
        assert heads == [f"void {item.name}_{entry}" for entry in ("defaults", "initialize", "step")]
        assert re.findall(r"#include (.*)", item.source) == [f'"{item.name}.h"', "<math.h>"]
        assert re.findall(r"#include (.*)", item.header) == ["<stdbool.h>", "<stdint.h>"]
        assert not re.search(r"\b((malloc|free|memcpy)\(|static (?!const|inline)\w+ \w+( =|;|\[))", item.source)


def test_text_is_the_same_for_any_hash_seed(translations: Any) -> None:
    program = (
        "import hashlib, vehicle_fmu; from fmus.compiler import translate; t = translate(vehicle_fmu.MODEL);"
        "print(hashlib.sha256((t.header + t.source).encode()).hexdigest())"
    )
    seed = "0" if os.environ.get("PYTHONHASHSEED") != "0" else "4711"
    environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)}
    other = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    here = translations[list(MODELS).index("vehicle")]
    assert other.stdout.strip() == hashlib.sha256((here.header + here.source).encode()).hexdigest()


def test_header_is_c_plus_plus(translations: Any, tmp_path: Path) -> None:
    compiler = [*ZIG.command[:-1], "c++"] if COMPILER.is_zig else ["g++"]
    for item in translations:
        (tmp_path / f"{item.name}.h").write_text(item.header)
    lines = [f'#include "{item.name}.h"' for item in translations]
    (tmp_path / "both.cpp").write_text("\n".join([*lines, "Vehicle vehicle;", ""]))
    command = [*compiler, "-Wall", "-Wextra", "-pedantic", "-Werror", "-c", "-o", "both.o", "both.cpp"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    if done.returncode and "g++" in compiler and "cc1plus" in done.stderr:
        pytest.skip("gcc without C++")
    assert not done.returncode, done.stderr


def test_what_the_models_remember_is_changed_where_it_lies(translations: Any) -> None:
    """Neither the step nor what it calls makes a second state."""
    for item in translations:
        states = re.findall(r"^    (\w*State) next\w*;$", item.source, re.MULTILINE)
        assert not {f"{item.name}State", "CarState", "ParkingState", "ApaState"} & set(states)
    vehicle = next(item.source for item in translations if item.name == "Vehicle")
    assert "    CarState *car = &state->car;\n" in vehicle
    assert re.search(r"\n \* Changes ``state``\.\n \*/\nstatic void step_car\(CarState \*state, ", vehicle)
    step = vehicle[vehicle.index("static void advance(") :]
    assert "CarState next" not in step
    assert "    step(state, inputs, params, dt_ns, outputs);\n}" in step


COMMENTED = '''
def f(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    """Return something, in 1/s /* really */.

    And more.
    """
    # before the first
    a = x  # beside it
    # before if
    if p:
        # inside
        a = y
    # before else is not kept apart
    else:
        a = 2.0 * y  # fmt: skip
    return a
'''


def test_comments_stay_where_they_are(tmp_path: Path) -> None:
    module = load(whole_module(COMMENTED), tmp_path, "commented")
    source = translate(model_of(module)).source
    body = source[source.index("/* Return something") : source.index("/* -------- entries")]
    assert "/* Return something, in 1/s / * really * /.\n *\n * And more.\n */\n" in body
    order = ["before the first", "beside it", "double a = x", "before if", "if (p)", "inside", "a = y;", "} else {"]
    places = [body.index(text) for text in order]
    assert places == sorted(places)
    assert "fmt: skip" not in body


NAMES = '''
class double(NamedTuple):
    """Names that C has taken."""

    int: float = 0.0
    _hidden_: float = 1.0
    NAN: float = 2.0


def remainder(x: float) -> float:
    return x * 2.0


def _smaller(a: float, b: float) -> float:
    return a if a < b else b


def smaller(a: float, b: float) -> float:
    return _smaller(b, a) + 1.0


def f(x: float, y: float, n: int, m: int, p: bool, q: bool) -> float:
    sin = math.sin(1.0) + remainder(x)
    smaller_ = smaller(x, y) + _smaller(x, y)
    while_ = double(x, NAN=y)
    NULL = while_.int + while_.NAN
    return sin + smaller_ + NULL + int_of(n) + Trial_step(y)


def int_of(n: int) -> int:
    return n + math.floor(0.5)


def Trial_step(next: float) -> float:
    state = next
    return state
'''


def test_names_that_c_has_taken(tmp_path: Path) -> None:
    text = whole_module(NAMES).replace("    _hidden_: float = 1.0\n", "")
    module = load(text, tmp_path, "names")
    translation = translate(model_of(module))
    (tmp_path / "Trial.h").write_text(translation.header)
    (tmp_path / "Trial.c").write_text(translation.source)
    compiled(tmp_path, "names", "Trial.c")
    assert "double_names" in translation.source
    assert "double int_;" in translation.source
    assert "static inline double remainder_names(" in translation.source


def test_the_example_of_the_documentation_is_true(tmp_path: Path) -> None:
    blocks = dict(re.findall(r"<!-- (python|c) -->\n\n```\w+\n(.*?)```", DOCS.read_text(), re.DOTALL))
    module = load(WALLS.format(text=blocks["python"]), tmp_path, "walls")
    translation = translate(model_of(module))
    for part in blocks["c"].strip().split("\n\n"):
        assert part in translation.header + translation.source


def test_a_variable_is_unread_although_a_member_has_its_name() -> None:
    lines = ["const Plan *plan = &memory->plan;", "const Goal goal = plan_goal(memory);", "memory->plan.goal = goal;"]
    assert without_unused(lines) == lines[1:]
    assert without_unused([*lines, "return plan->goal.x > goal.x;"]) == [*lines, "return plan->goal.x > goal.x;"]
