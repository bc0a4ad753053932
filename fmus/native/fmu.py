"""From a model package to an FMI 2.0 co-simulation FMU that needs nothing at run time but libc and libm."""

import math
from collections.abc import Iterable
from pathlib import Path

from fmus.contents.archive import DESCRIPTION, archive_guid, content_guid, write_archive
from fmus.contents.description import FmiVariable, fmi_variables, limits, model_description, project_version
from fmus.contents.extras import documentation, reference_result
from fmus.flat_entry import sizes
from fmus.native.fat_binary import fat_binary
from fmus.native.platforms import HEADERS, NATIVE, PLATFORMS, SOURCES, Platform, link
from fmus.native_ir import IR_MAKERS, object_code
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
MAKERS = (*IR_MAKERS, "contents/description.py", "native/fmu.py", "native_ir.py", "native/platforms.py")
"""Files that decide what is in the binaries."""
NUL = r'"\0"'
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
    """Return the C source with the GUID and what is known of each variable, in the order of the value references."""
    known = fmi_variables(model)
    for place, variable in enumerate(known):
        if variable.vr != place:
            raise ValueError(f"{variable.name}: value reference {variable.vr} is not its place {place}")
    names = [variable.name.encode() for variable in known]
    places = [sum(len(name) + 1 for name in names[:number]) for number in range(len(names))]
    parameters = [variable for variable in known if variable.causality == "parameter"]
    starts = [_number(float(variable.start)) for variable in known if variable.start is not None]
    parts = [
        f'#include "model.h"\n\n#include <math.h>\n\nconst char model_guid[] = {_text(guid)};\n',
        _table("unsigned char model_kinds[MODEL_VARIABLES]", [KINDS[variable.kind] for variable in known]),
        _table("double model_starts[MODEL_PARAMETERS + MODEL_INPUTS + 1]", [*starts, "0"]),
        _table("double model_limits[MODEL_PARAMETERS + 1][2]", [*map(_limits, parameters), "{0, 0}"]),
        _table("uint32_t model_name_places[MODEL_VARIABLES]", [str(place) for place in places]),
        "const char model_names[] =\n" + "\n".join(f"    {_text(name.decode())} {NUL}" for name in names) + ";\n",
    ]
    return "\n".join(parts)


def _table(declaration: str, items: Iterable[str]) -> str:
    lines = "".join(f"    {item},\n" for item in items)
    return f"const {declaration} = {{\n{lines}}};\n"


def _limits(variable: FmiVariable) -> str:
    low, high = limits(variable)
    return f"{{{_number(-math.inf if low is None else low)}, {_number(math.inf if high is None else high)}}}"


def _number(value: float) -> str:
    if math.isinf(value):
        return "INFINITY" if value > 0.0 else "-INFINITY"
    return float(value).hex()


def _text(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _guid(model: Model, platforms: list[str]) -> str:
    """Return a GUID that depends on the model's sources, the FMI side, the platforms and the makers of the code."""
    here = Path(__file__).parent.parent
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
