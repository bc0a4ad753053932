"""Lanes of runs: the same bits as runs one after the other, for any branch that a lane takes, and in any lane."""

import itertools
import math
import subprocess
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

import tests.compiler.test_lanes as here
from fmus.compiled_batch import RecordedSignal, compile_rows
from fmus.compiler.lanes import NoLanesError
from fmus.compiler.slicing import Slice
from fmus.lane_rows import compile_lane_rows, has_lanes
from fmus.native import tangents
from fmus.native.compilers import LINUX_ALONE, CompilerError, find_compiler
from fmus.native.libraries import load_lanes
from fmus.native.library_cache import lane_headers
from fmus.study_slices import StudyCode
from modelkit.model import Model
from modelkit.variables import variables
from tests.compiler.language import HEAD, load, results
from tests.compiler.programs import programs

pytestmark = pytest.mark.skipif(not has_lanes(), reason="no vectors of four doubles, or no glibc")

RUNS = 29
"""No multiple of the lanes: at the end some are empty."""
FRAME = """

class Par(NamedTuple):
    x: float = 0.0
    y: float = 0.0
    n: int = 0
    m: int = 0
    p: bool = False
    q: bool = False


class In(NamedTuple):
    unused: float = 0.0


class State(NamedTuple):
    steps: int = 0


class Out(NamedTuple):
{fields}


def initialize(params: Par) -> tuple[State, Out]:
    return State(), Out()


def step(state: State, inputs: In, params: Par, dt_ns: int) -> tuple[State, Out]:
    x, y, n, m, p, q = params.x, params.y, params.n + state.steps, params.m, params.p, params.q
    return State(state.steps + 1), Out(
{calls}
    )
"""
STARTS = {"float": "0.0", "int": "0", "bool": "False"}
FLOATS = np.array([0.0, -0.0, 1.0, -1.0, 0.5, 2.5, 1e308, 5e-324, np.inf, np.nan, 0.1, -3.0])
OPTIONS = (("-O3", "-mcpu=haswell"), find_compiler("zig").options_for_this_machine())
"""Four lanes, and what this machine has."""
numbers = itertools.count()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return tmp_path_factory.mktemp("lanes")


def differing(model: Model, parameters: Any, times: Any, options: Any) -> list[str]:
    """Return the outputs whose last values, or the ends, differ between lanes and runs one after the other."""
    code = StudyCode({model.name: all_of(model)}, options)
    names = [f"{model.name}.{item.name}" for item in variables(model.outputs)]
    kept = [RecordedSignal(how, name) for name in names for how in ("last", "travel")]
    alone = compile_rows({model.name: model}, None, kept, (), code)
    lanes = compile_lane_rows({model.name: model}, None, kept, code, alone)
    assert lanes is not None
    rows = [np.empty((len(parameters), 2 + len(kept))) for _ in range(2)]
    for make, out in zip((alone, lanes), rows, strict=True):
        make(parameters, times, np.empty((len(parameters), 0)), out)
        out[np.isnan(out)] = np.nan
    columns = ["end", "time", *(f"{item.how} {item.signal}" for item in kept)]
    places = (rows[0].view(np.int64) != rows[1].view(np.int64)).any(axis=0)
    return [name for name, place in zip(columns, places, strict=True) if place]


def times_of(count: int) -> Any:
    """Return times of runs of different lengths and steps, the model due at each, second or third step."""
    rows = np.arange(count)
    return np.stack([10_000_000 + 1_000 * (rows % 3), 45_000_000 + 7_000_000 * (rows % 5), 1 + rows % 3], axis=1)


def test_random_programs_have_the_bits_of_single_runs(folder: Any) -> None:
    equal = []

    @settings(max_examples=8, derandomize=True, database=None, deadline=None, phases=[Phase.generate],
              suppress_health_check=list(HealthCheck))  # fmt: skip
    @given(programs(functions=3), st.integers(0, 2**32 - 1))
    def each(text: Any, seed: Any) -> None:
        model = program(text, folder, f"lanes_{next(numbers)}")
        random = np.random.default_rng(seed)
        parameters = np.column_stack([
            random.choice(FLOATS, (RUNS, 2)), random.integers(-4, 12, (RUNS, 2)), random.integers(0, 2, (RUNS, 2))
        ])  # fmt: skip
        if seed % 2:
            parameters[:, 2:4] = parameters[0, 2:4]
        try:
            load_lanes(model, all_of(model), OPTIONS[1])
        except NoLanesError:
            return
        assert differing(model, parameters.astype(np.float64), times_of(RUNS), OPTIONS[1]) == []
        equal.append(text)

    each()
    assert len(equal) >= 4


def program(text: Any, folder: Any, name: Any) -> Model:
    """Return a model whose outputs are the functions in ``text``, called with its parameters."""
    found = results(text)
    fields = "\n".join(f"    {name}: {kind} = {STARTS.get(kind, f'{kind}()')}" for name, kind in found)
    calls = "\n".join(f"        {name}(x, y, n, m, p, q)," for name, _ in found)
    module = load(HEAD + text + FRAME.format(fields=fields, calls=calls), folder, name)
    types = (module.State, module.Par, module.In, module.Out)
    return Model("Trial", "a trial", module, *types, module.initialize, module.step, 0.01, 1.0)


def all_of(model: Model) -> Slice:
    """Return the slice with all outputs of a model."""
    return Slice(frozenset(item.name for item in variables(model.outputs)), None)


class Parameters(NamedTuple):
    """Parameters."""

    start: float = 1.0
    rounds: int = 3
    upward: bool = True


class Inputs(NamedTuple):
    """Inputs."""

    unused: float = 0.0


class Cell(NamedTuple):
    """One of a row."""

    value: float = 0.0
    weight: float = 1.0


class State(NamedTuple):
    """What the model remembers."""

    row: tuple[Cell, ...] = (Cell(),) * 5
    next: int = 0


class Outputs(NamedTuple):
    """Outputs."""

    sum: float = 0.0
    found: int = 0
    ready: bool = False
    turned: float = 0.0


TABLE = (0.5, -0.25, 4.0)
SMALL_TABLE = (3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8, 9, 7, 9, 3)
LARGE_TABLE = (2.0, 7.0, 1.0, 8.0, 2.5, 8.5, 1.5, 8.25, 4.0, 5.0, 9.0, 0.5, 4.5, 5.5, 2.25, 3.5, 3.0)


def first_above(row: tuple[Cell, ...], limit: float) -> int:
    """Return the place of the first value above a limit, -1 if there is none."""
    for place in range(5):
        if row[place].value > limit:
            return place
    return -1


def halvings(value: float, most: int) -> int:
    """Return how often a value is halved until it is below 1, at most so often."""
    count = 0
    for _ in range(most):
        if value < 1.0:
            break
        value = 0.5 * value
        count = count + 1
    return count


def nearest(table: tuple[float, ...], value: float) -> float:
    """Return the number of a table, the same one for all runs, that is nearest to a value."""
    best = table[0]
    for number in table:
        if abs(number - value) < abs(best - value):
            best = number
    return best


def weighed(row: tuple[Cell, ...], upward: bool) -> float:
    """Return the weight of the first or last of a row: of another one in each run."""
    cell = row[0] if upward else row[4]
    return cell.value * cell.weight


def turned(angle: float, by: float) -> float:
    """Return a number made of sines and cosines, of an argument that changes between some of them."""
    cosine = math.cos(angle)
    sine = math.sin(angle)
    angle = angle + by * math.cos(angle)
    other = math.sin(angle)
    angle = angle + other * math.cos(angle)
    return cosine + 2.0 * sine + 3.0 * other + 4.0 * math.sin(angle) + 5.0 * math.cos(angle)


def initialize(params: Parameters) -> tuple[State, Outputs]:
    """Return the start."""
    return State(), Outputs(ready=params.upward)


def step(state: State, inputs: Inputs, params: Parameters, dt_ns: int) -> tuple[State, Outputs]:
    """Return the next state: branches, loops and places that differ between runs."""
    sign = 1.0 if params.upward else -1.0
    cell = Cell(sign * params.start * (1.0 + state.next) + TABLE[(state.next + params.rounds) % 3], 2.0)
    row = state.row[1:] + (cell,)
    total = 0.0
    for index in range(params.rounds):
        item = row[(index + state.next) % 5]
        total = total + item.value * item.weight
    place = first_above(row, 2.0) * 10 + halvings(abs(total), params.rounds)
    place = place + 100 * SMALL_TABLE[(state.next + 5 * params.rounds) % 16]
    found = turned(total, params.start) + math.atan(total) + LARGE_TABLE[(state.next + 6 * params.rounds) % 17]
    return State(row, state.next + 1), Outputs(total, place, total > 0.0, found)


@pytest.mark.parametrize("options", OPTIONS)
def test_branches_loops_and_places_that_differ_between_lanes(options: Any) -> None:
    model = Model("Laned", "a model", here, State, Parameters, Inputs, Outputs, initialize, step, 0.01, 1.0)
    random = np.random.default_rng(5)
    parameters = np.column_stack([random.normal(size=RUNS), random.integers(0, 7, RUNS), random.integers(0, 2, RUNS)])
    load_lanes(model, all_of(model), options)
    assert differing(model, parameters.astype(np.float64), times_of(RUNS), options) == []


MATHS = """
#include "lane_math.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t state = 88172645463325252u;

static double uniform(void) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) / 9007199254740992.0;
}

static int differs(double a, double b) { return a == a || b == b ? memcmp(&a, &b, sizeof a) != 0 : 0; }

int main(int count, char **arguments) {
    static const double special[] = {0.0, -0.0, NAN, INFINITY, -INFINITY, 5e-324, -1e-310, 1e308, 1000.0, 1e22,
                                     1.5707963267948966, 3.141592653589793, -0.4375, 2.4375, 1.1875, 0x1p-27};
    const long vectors = atol(arguments[count - 1]);
    long sine = 0, cosine = 0, tangent = 0, arc = 0;
    static LaneCall calls[LANE_FUNCTIONS + 4];
    for (long i = 0; i < vectors; i++) {
        const double size = i % 4 == 0 ? 2000.0 : i % 4 == 1 ? 4.0 : 1.0;
        lane_d x;
        lane_i live = LANE_INT(-1);
        memset(calls, 255, sizeof calls);
        LANE_EACH(l) x[l] = (2.0 * uniform() - 1.0) * (i % 4 == 3 ? exp(-50.0 * uniform()) : size);
        if (i < 16) LANE_EACH(l) x[l] = special[(i + l) % 16];
        live[i % LANES] = 0;
        const LaneCall turn = *lane_sincos_call(calls, 0, live, x);
        const lane_d t = lane_tan(calls, 1, live, x), c = lane_atan(calls, 2, live, x);
        const lane_d again = lane_tan(calls, 3, live, i % 2 ? x : x + 1.0);
        LANE_EACH(l) {
            if (!live[l]) continue;
            sine += differs(turn.result[l], sin(x[l]));
            cosine += differs(turn.other[l], cos(x[l]));
            tangent += differs(t[l], tan(x[l])) + differs(again[l], tan(i % 2 ? x[l] : x[l] + 1.0));
            arc += differs(c[l], atan(x[l]));
        }
    }
    printf("%ld %ld %ld %ld\\n", sine, cosine, tangent, arc);
    return 0;
}
"""


@pytest.mark.parametrize("has_table", [True, False])
@pytest.mark.parametrize("options", OPTIONS)
def test_functions_have_the_bits_of_the_platform(options: Any, has_table: bool, tmp_path: Path) -> None:
    tangents = {} if has_table else {"lane_tangents.h": "#define LANE_TANGENTS 0\n"}
    for name, text in {**lane_headers(), "maths.c": MATHS, **tangents}.items():
        (tmp_path / name).write_text(text)
    find_compiler("zig").run(
        ["-std=gnu99", "-ffp-contract=off", *options, "-o", "maths", "maths.c", "-lm", *LINUX_ALONE], tmp_path
    )
    done = subprocess.run([str(tmp_path / "maths"), "40000"], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["0"] * 4


def test_no_lanes_without_a_compiler_that_knows_vectors(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*given: Any, **named: Any) -> Any:
        raise CompilerError("unknown type")

    monkeypatch.setattr("fmus.native.libraries.load_lanes", refuse)
    model = Model("Laned", "a model", here, State, Parameters, Inputs, Outputs, initialize, step, 0.01, 1.0)
    code = StudyCode({"Laned": Slice(frozenset({"sum"}), None)}, OPTIONS[0])
    kept = [RecordedSignal("last", "Laned.sum")]
    assert compile_lane_rows({"Laned": model}, None, kept, code, lambda *given: None) is None


@pytest.mark.parametrize(
    ("maker", "number", "other"),
    [("sine_table", "0x1.fffeaaaaeeeefp-8", "0x1p-7"), ("tangent_table", "0x1.100001b1a7010p-4", "0x1.1p-4")],
)
def test_no_lanes_where_the_platform_has_another_table(
    maker: str, number: str, other: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = lane_headers()[f"lane_{maker.partition('_')[0]}s.h"]
    assert number in table
    monkeypatch.setattr(f"fmus.native.library_cache.{maker}", lambda: table.replace(number, other))
    model = Model("Laned", "a model", here, State, Parameters, Inputs, Outputs, initialize, step, 0.01, 1.0)
    code = StudyCode({"Laned": Slice(frozenset({"sum"}), None)}, OPTIONS[0])
    kept = [RecordedSignal("last", "Laned.sum")]
    assert compile_lane_rows({"Laned": model}, None, kept, code, lambda *given: None) is None


def tangents_in_file() -> Any:
    """Return rows as a file of functions has them: x, tan x, cot x, rest."""
    x = (16.0 + np.arange(tangents.POINT_COUNT)) / 256.0
    return np.column_stack([x, [math.tan(a) for a in x], [1.0 / math.tan(a) for a in x], np.zeros(len(x))])


def test_the_tangents_of_the_platform_are_found_in_its_file() -> None:
    rows = tangents_in_file()
    around = np.array([math.nan, 0.0625, 1.0])
    data = b"".join([around.tobytes(), rows.tobytes(), around.tobytes(), b"xyz"])
    assert tangents.find_points(data) == rows.tolist()
    assert tangents.find_points(rows.tobytes()[:-8]) == []
    for column in range(3):
        other = rows.copy()
        other[100, column] *= 1.0 + 1e-6
        assert tangents.find_points(other.tobytes()) == []


def test_without_tangents_in_a_file_there_is_no_table(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    assert tangents.tangent_table().startswith(f"#define LANE_TANGENTS {tangents.ROW_COUNT}\n")
    for text in (None, "", f"7f00-7f01 r--p 0 0 0 {tmp_path}/libm.so.6\n"):
        mappings = tmp_path / "maps"
        mappings.unlink(missing_ok=True)
        if text is not None:
            mappings.write_text(text)
        monkeypatch.setattr(tangents, "MAPPINGS", mappings)
        assert tangents.tangent_table() == "#define LANE_TANGENTS 0\n"


def test_a_machine_without_vectors_has_no_lanes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fmus.lane_rows.processor", lambda: "flags: sse2 fma")
    assert not has_lanes()
