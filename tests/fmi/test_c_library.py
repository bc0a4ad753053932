"""A model as a C library: its example prints CPython's numbers, its memory is one struct."""

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fmus.contents.variables import fmi_variables
from fmus.native.c_library import write_c_library
from fmus.native.libraries import load_model, memory_size
from modelkit.variables import flatten, variables
from tests.fmi.host import random_inputs
from tests.fmi.test_python_fmu import STEPS, in_process

NEEDED = ("make", "cc", "ar")


def example_rows(text: Any) -> Any:
    """Return [(time, {name: value})] of what an example prints."""
    rows = []
    for line in text.splitlines():
        time, *words = line.split()
        rows.append((float(time), dict(zip(words[::2], map(float, words[1::2]), strict=True))))
    return rows


@pytest.mark.skipif(not all(map(shutil.which, NEEDED)), reason=f"needs {', '.join(NEEDED)}")
def test_the_example_prints_cpythons_numbers(model: Any, tmp_path: Path) -> None:
    write_c_library(model, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        ["Makefile", "main.c", f"{model.name}.c", f"{model.name}.h"]
    )
    assert len((tmp_path / "main.c").read_text().splitlines()) <= 31
    subprocess.run(["make", "--silent"], cwd=tmp_path, check=True)
    done = subprocess.run([tmp_path / "example"], capture_output=True, text=True, check=True)
    rows = example_rows(done.stdout)
    names = [item.name for item in variables(model.outputs)]
    params, inputs, step_ns = model.params(), model.inputs(), round(model.step_size * 1e9)
    state, outputs = model.initialize(params)
    time_ns = 0
    for time, found in rows:
        while time_ns < round(time * 1e9):
            state, outputs = model.step(state, inputs, params, step_ns)
            time_ns += step_ns
        expected = dict(zip(names, flatten(outputs), strict=True))
        assert len(found) == 4
        assert found == {name: expected[name] for name in found}
    assert len(rows) > 10


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.release)])
def test_the_library_equals_the_model_to_the_bit(model: Any, seed: int) -> None:
    given = random_inputs(fmi_variables(model), seed, len(STEPS))
    expected = in_process(model, given, STEPS)
    library, names = load_model(model), [item.name for item in variables(model.inputs)]
    memory = np.zeros(memory_size(library), dtype=np.uint8)
    p, y = np.array(flatten(model.params()), dtype=float), np.zeros(len(expected[0]))
    library.model_start(memory.ctypes.data, p.ctypes.data, y.ctypes.data)
    assert y.tobytes() == np.array(expected[0], dtype=float).tobytes()
    time = 0.0
    for number, (size, values) in enumerate(zip(STEPS, given, strict=True), start=1):
        u = np.array([values[name] for name in names], dtype=float)
        dt_ns = round((time + size) * 1e9) - round(time * 1e9)
        library.model_step(memory.ctypes.data, u.ctypes.data, y.ctypes.data, dt_ns)
        time += size
        assert y.tobytes() == np.array(expected[number], dtype=float).tobytes()


def test_the_command_writes_both_models(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "orchestrator", "export", "c", str(tmp_path)], capture_output=True, text=True, check=True
    )
    assert len(done.stdout.splitlines()) == 8
    assert (tmp_path / "Vehicle" / "Vehicle.c").is_file()
    assert (tmp_path / "Controller" / "Makefile").is_file()
