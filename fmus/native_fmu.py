"""From a model package to an FMI 2.0 co-simulation FMU that needs nothing at run time but libc and libm."""

import math
from collections.abc import Iterable
from pathlib import Path

from fmus.archive import DESCRIPTION, archive_guid, content_guid, write_archive
from fmus.description import FmiVariable, fmi_variables, limits, model_description, project_version
from fmus.extras import documentation, reference_result
from fmus.fat_binary import fat_binary
from fmus.flat_entry import sizes
from fmus.native_ir import object_code
from fmus.platforms import HEADERS, NATIVE, PLATFORMS, SOURCES, Platform, link
from fmus.sources import source_hash
from modelkit.model import Model

FLAGS = {
    "needsExecutionTool": False,
    "canHandleVariableCommunicationStepSize": True,
    "canInterpolateInputs": False,
    "canBeInstantiatedOnlyOncePerProcess": False,
    "canNotUseMemoryManagementFunctions": True,
    "canGetAndSetFMUstate": True,
    "canSerializeFMUstate": True,
}
NEEDS = """
<p>This FMU is machine code for {platforms}, made from the model's Python source. It needs no Python, no other
library than the C library, and no licence. Several instances may run in one process and on several threads, each
instance on one thread at a time.</p>
<p>A parameter outside its range, a variable that does not exist, a call out of order or a step that is not
in (0, 3600] s is answered with fmi2Error and a message to the logger; nothing is changed by such a call.</p>
"""
MAKERS = (
    "compiled.py",
    "compiled_modules.py",
    "compiled_types.py",
    "description.py",
    "flat_entry.py",
    "native_fmu.py",
    "native_ir.py",
    "platforms.py",
)
"""Files that decide what is in the binaries."""
KINDS = {float: "REAL", int: "INTEGER", bool: "BOOLEAN"}


def build(model: Model, out_dir: Path, platforms: Iterable[str] = tuple(PLATFORMS)) -> Path:
    """Return the path of ``out_dir/<model.name>.fmu``; written only if its content would change.

    Raises ``TypeError`` if the model cannot be compiled, ``RuntimeError`` if the C compiler fails.
    """
    names = sorted(platforms)
    guid = _guid(model, names)
    path = Path(out_dir) / f"{model.name}.fmu"
    if archive_guid(path) != guid:
        write_archive(path, _files(model, names, guid))
    return path


def library(model: Model, platform: Platform, guid: str) -> bytes:
    """Return the shared library of ``model`` for ``platform``; it answers to ``guid`` only."""
    sources = {"model_sizes.h": sizes_header(model), "model_tables.c": tables(model, guid)}
    name = f"{model.name}{platform.suffix}"
    slices = [link(name, target, sources, object_code(model, target.triple)) for target in platform.targets]
    return fat_binary(slices) if len(slices) > 1 else slices[0]


def sizes_header(model: Model) -> str:
    """Return the C header with the number of scalars of each group."""
    count = sizes(model)
    names = {"PARAMETERS": "params", "INPUTS": "inputs", "OUTPUTS": "outputs", "STATES": "state"}
    return "".join(f"#define MODEL_{name} {count[group]}\n" for name, group in names.items())


def tables(model: Model, guid: str) -> str:
    """Return the C source with the GUID and one line per variable, in the order of the value references."""
    lines = ['#include "model.h"', "", "#include <math.h>", "", f"const char model_guid[] = {_text(guid)};", ""]
    lines.append("const Variable model_variables[MODEL_VARIABLES] = {")
    for place, variable in enumerate(fmi_variables(model)):
        if variable.vr != place:
            raise ValueError(f"{variable.name}: value reference {variable.vr} is not its place {place}")
        lines.append(f"    {{{_row(variable)}}},")
    return "\n".join([*lines, "};", ""])


def _row(variable: FmiVariable) -> str:
    low, high = limits(variable)
    numbers = (0.0 if variable.start is None else float(variable.start), low, high)
    start, lowest, highest = (_number(value) for value in numbers)
    lowest = "-INFINITY" if low is None else lowest
    return ", ".join((_text(variable.name), KINDS[variable.kind], start, lowest, highest))


def _number(value: float | None) -> str:
    if value is None or math.isinf(value):
        return "INFINITY" if value is None or value > 0.0 else "-INFINITY"
    return float(value).hex()


def _text(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _guid(model: Model, platforms: list[str]) -> str:
    """Return a GUID that depends on the model's sources, the FMI side, the platforms and the makers of the code."""
    here = Path(__file__).parent
    files = {f"native/{name}": (NATIVE / name).read_bytes() for name in (*SOURCES, *HEADERS)}
    files |= {name: (here / name).read_bytes() for name in MAKERS}
    files["model"] = source_hash(model).encode()
    files["platforms"] = " ".join(platforms).encode()
    return content_guid({**files, DESCRIPTION: _description(model, "")})


def _files(model: Model, platforms: list[str], guid: str) -> dict[str, bytes]:
    files = documentation(model, NEEDS.format(platforms=", ".join(platforms)))
    for name in platforms:
        platform = PLATFORMS[name]
        files[f"binaries/{name}/{model.name}{platform.suffix}"] = library(model, platform, guid)
    files[DESCRIPTION] = _description(model, guid)
    return {**files, **reference_result(model)}


def _description(model: Model, guid: str) -> bytes:
    tool = f"apa-cosim {project_version()}, native"
    return model_description(model, guid=guid, generation_tool=tool, flags=FLAGS)
