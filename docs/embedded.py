"""Writes docs/tables/embedded.md: ``python docs/embedded.py``, or some tables: ``... memory stack size time misra``.

Stack needs gcc 10 or later, MISRA needs cppcheck with its addon; without them these tables stay as they are.
"""

import ctypes
import re
import shutil
import struct
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np

from fmus.native.compilers import FLAGS
from fmus.native.libraries import declare_functions, memory_size, model_files
from fmus.native.library_cache import cache_library
from fmus.native.sources import translate_model
from modelkit.model import Model
from modelkit.variables import flatten, variables, with_values
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files

FOLDER = Path(__file__).parent
PAGE = FOLDER / "tables" / "embedded.md"
ROUNDS = 15
TARGETS = {
    "Cortex-M7, double FPU (thumbv7em)": ("thumb-freestanding-eabihf", "-mcpu=cortex_m7+fp_armv8d16"),
    "Cortex-M7, single FPU only": ("thumb-freestanding-eabihf", "-mcpu=cortex_m7"),
    "64-bit ARM": ("aarch64-freestanding",),
}
DRIVES = {
    "kinematic": ("vehicle", "guo2015-case4", ()),
    "single track": ("vehicle", "guo2015-case4", ("vehicle.body=single_track",)),
    "double track": ("vehicle", "guo2015-case4", ("vehicle.body=double_track",)),
    "Guo 2015": ("controller", "guo2015-case4", ()),
    "Zhang 2022": ("controller", "zhang2022", ()),
    "HSIC": ("controller", "hsic", ()),
    "preview": ("controller", "preview", ("stop_time=20",)),
}
MATH_H = """#ifndef MATH_H
#define MATH_H
#define NAN (__builtin_nanf(""))
#define INFINITY (__builtin_inff())
#define isnan(x) __builtin_isnan(x)
#define isinf(x) __builtin_isinf(x)
#define isfinite(x) __builtin_isfinite(x)
#define signbit(x) __builtin_signbit(x)
double acos(double), asin(double), atan(double), atan2(double, double), ceil(double), copysign(double, double);
double cos(double), exp(double), fabs(double), floor(double), fmod(double, double), log(double), pow(double, double);
double sin(double), sqrt(double), tan(double), trunc(double);
#endif
"""
"""A freestanding compiler has no math.h; the target's C library brings one, and the functions."""


def main(names: list[str]) -> None:
    """Write the tables called ``names``, or all, into the page."""
    text = PAGE.read_text(encoding="utf-8")
    tables = {"memory": memory, "stack": stack, "size": size, "time": times, "misra": misra}
    for name in names or tables:
        lines = tables[name]()
        print(name, *lines, sep="\n")
        if lines:
            text = replaced(text, name, lines)
    PAGE.write_text(text, encoding="utf-8")


def replaced(text: str, name: str, lines: list[str]) -> str:
    """Return ``text`` with the table after ``<!-- name -->`` made of ``lines``."""
    block = "\n".join(lines)
    return re.sub(rf"(<!-- {name} -->\n)(\n\|.*?\n(?=\n))?", lambda found: f"{found[1]}\n{block}\n", text, flags=re.S)


def memory() -> list[str]:
    """Return the table of bytes of an instance."""
    lines = ["| bytes | parameters | inputs | outputs | state | instance |", "|---|---:|---:|---:|---:|---:|"]
    for name, model in MODELS.items():
        sizes = (ctypes.c_int64 * 5)()
        library(name).embedded_sizes(sizes)
        lines.append(f"| {model.name} | " + " | ".join(f"{number:,}" for number in sizes) + " |")
    return lines


def library(name: str) -> ctypes.CDLL:
    """Return the model's C with the functions of ``embedded.c``."""
    model, unit = MODELS[name], "embedded_unit.c"
    words = {"MODEL": model.name, "SOURCE": f'"{model.name}.c"', "MEMBERS": f'"{model.name}_members.h"'}
    head = "".join(f"#define EMBEDDED_{key} {value}\n" for key, value in words.items())
    files = {**model_files(model), unit: head + (FOLDER / "embedded.c").read_text(encoding="utf-8")}
    return ctypes.CDLL(str(cache_library(f"embedded_{name}", unit, files)))


def stack() -> list[str]:
    """Return the table of the deepest stack of each entry, from gcc's graph of calls."""
    if shutil.which("gcc") is None:
        return []
    lines = ["| bytes of stack | initialize | step |", "|---|---:|---:|"]
    for model in MODELS.values():
        with tempfile.TemporaryDirectory() as directory:
            write(model, Path(directory))
            command = ["gcc", *FLAGS, "-fcallgraph-info=su", "-c", f"{model.name}.c", "-o", "model.o"]
            subprocess.run(command, cwd=directory, check=True)
            depth = deepest((Path(directory) / "model.ci").read_text(encoding="utf-8"))
        deep = (depth[f"{model.name}_{entry}"] for entry in ("initialize", "step"))
        lines.append(f"| {model.name} | " + " | ".join(f"{number:,}" for number in deep) + " |")
    return lines


def deepest(graph: str) -> dict[str, int]:
    """Return function -> bytes of stack of it and of what it calls, C library left out; there is no recursion."""
    nodes = re.findall(r'node: \{ title: "([^"]+)" label: "[^"]*\\n(\d+) bytes', graph)
    own = {name: int(size) for name, size in nodes}
    calls: dict[str, set[str]] = {}
    for caller, called in re.findall(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"', graph):
        calls.setdefault(caller, set()).add(called)
    found: dict[str, int] = {}

    def depth(name: str) -> int:
        if name not in found:
            found[name] = own.get(name, 0) + max(map(depth, calls.get(name, ())), default=0)
        return found[name]

    for name in own:
        depth(name)
    return found


def write(model: Model, folder: Path) -> None:
    """Write the model's C and a math.h into ``folder``."""
    code = translate_model(model)
    (folder / f"{code.name}.h").write_text(code.header, encoding="utf-8")
    (folder / f"{code.name}.c").write_text(code.source, encoding="utf-8")


def size() -> list[str]:
    """Return the table of bytes of code and data on each target."""
    lines = ["| kB | model | .text | .rodata | .data | .bss |", "|---|---|---:|---:|---:|---:|"]
    for target, options in TARGETS.items():
        for model in MODELS.values():
            with tempfile.TemporaryDirectory() as directory:
                folder = Path(directory)
                write(model, folder)
                (folder / "math.h").write_text(MATH_H, encoding="ascii")
                command = [sys.executable, "-m", "ziglang", "cc", "-target", *options, *FLAGS, "-g0", "-I."]
                command += ["-fno-sanitize=all", "-c", f"{model.name}.c", "-o", "model.o"]
                subprocess.run(command, cwd=folder, check=True)
                found = sections((folder / "model.o").read_bytes())
            lines.append(
                f"| {target} | {model.name} | " + " | ".join(f"{number / 1000:.1f}" for number in found) + " |"
            )
    return lines


def sections(elf: bytes) -> tuple[int, int, int, int]:
    """Return bytes of code, constants, data and zeroed data of an object file (ELF, little-endian)."""
    wide = elf[4] == 2
    (start,) = struct.unpack_from("<Q" if wide else "<I", elf, 0x28 if wide else 0x20)
    entry, count = struct.unpack_from("<HH", elf, 0x3A if wide else 0x2E)
    sums = [0, 0, 0, 0]
    for place in range(start, start + entry * count, entry):
        _, kind = struct.unpack_from("<II", elf, place)
        flags, _, _, bytes_ = struct.unpack_from("<QQQQ" if wide else "<IIII", elf, place + 8)
        if flags & 2:
            sums[0 if flags & 4 else 1 if not flags & 1 else 3 if kind == 8 else 2] += bytes_
    return sums[0], sums[1], sums[2], sums[3]


def times() -> list[str]:
    """Return the table of step times: for each step of a drive the least of some rounds; then mean and worst."""
    lines = ["| microseconds | mean | worst | steps |", "|---|---:|---:|---:|"]
    for label, (name, drive, sets) in DRIVES.items():
        scenario, model, made = load_scenario(drive, list(sets)), MODELS[name], declare_functions(library(name))
        signals = run_scenario(scenario, fmu_files("native"), kind="native").recording.signals
        rows = np.column_stack([signals[f"{name}.{item.name}"] for item in variables(model.inputs)]).astype(float)
        params = np.array(flatten(with_values(model.params, dict(getattr(scenario, name)))), dtype=float)
        instance, outputs = np.zeros(memory_size(made), dtype=np.uint8), np.zeros(len(variables(model.outputs)))
        least, count, step = np.full(len(rows), np.inf), ctypes.c_int64(len(rows)), ctypes.c_int64(scenario.step_ns)
        made.embedded_drive.argtypes = [ctypes.c_void_p] * 2 + [ctypes.c_int64] * 2 + [ctypes.c_void_p]
        for _ in range(ROUNDS):
            made.model_start(instance.ctypes.data, params.ctypes.data, outputs.ctypes.data)
            made.embedded_drive(instance.ctypes.data, rows.ctypes.data, count, step, least.ctypes.data)
        lines.append(f"| {label} ({drive}) | {least.mean() / 1e3:.2f} | {least.max() / 1e3:.1f} | {len(rows):,} |")
    return lines


def misra() -> list[str]:
    """Return the table of what cppcheck's MISRA addon finds, by rule."""
    if shutil.which("cppcheck") is None:
        return []
    found: dict[str, Counter[str]] = {}
    for model in MODELS.values():
        with tempfile.TemporaryDirectory() as directory:
            write(model, Path(directory))
            command = ["cppcheck", "--addon=misra", "--std=c99", "--enable=style", "--suppress=missingIncludeSystem"]
            command += ["--template={id}", f"{model.name}.c"]
            done = subprocess.run(command, cwd=directory, check=True, capture_output=True, text=True)
        for rule in re.findall(r"^misra-c2012-(\d+\.\d+)", done.stderr, re.M):
            found.setdefault(rule, Counter())[model.name] += 1
    names = [model.name for model in MODELS.values()]
    lines = [f"| rule | {' | '.join(names)} |", "|---|" + "---:|" * len(names)]
    for rule in sorted(found, key=lambda rule: [int(part) for part in rule.split(".")]):
        lines.append(f"| {rule} | " + " | ".join(str(found[rule][name]) for name in names) + " |")
    return lines


if __name__ == "__main__":
    main(sys.argv[1:])
