"""From a model package to an FMI 2.0 co-simulation FMU that needs nothing at run time but libc and libm."""

from collections.abc import Iterable
from pathlib import Path

from fmus.contents.archive import DESCRIPTION, archive_guid, content_guid, write_archive
from fmus.contents.description import model_description, project_version
from fmus.contents.extras import documentation, reference_result
from fmus.native.compilers import Compiler, find_compiler
from fmus.native.fat_binary import fat_binary
from fmus.native.platforms import PLATFORMS, Platform
from fmus.native.sources import fmu_sources, unit_name
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
<p>This FMU is machine code for {platforms}, made from the C in its folder <code>sources</code>, which was made from
the model's Python source. It needs no Python, no other library than the C library, and no licence. Several instances
may run in one process and on several threads, each instance on one thread at a time.</p>
<p>For another target compile <code>sources/{unit}</code> alone; its first lines say with which flags. The functions
get a prefix by <code>-DFMI2_FUNCTION_PREFIX={name}_</code>.</p>
<p>A parameter outside its range, a variable that does not exist, a call out of order or a step that is not
in (0, 3600] s is answered with fmi2Error and a message to the logger; nothing is changed by such a call.</p>
"""


def build(
    model: Model, out_dir: Path, platforms: Iterable[str] = tuple(PLATFORMS), compiler: Compiler | None = None
) -> Path:
    """Return the path of ``out_dir/<model.name>.fmu``; written only if its content would change.

    Raises ``TypeError`` if the model cannot be translated, ``RuntimeError`` without a C compiler or if it fails.
    """
    names = sorted(platforms)
    chosen = compiler or find_compiler()
    files = contents(model, names, "")
    made_by = {"compiler": chosen.words.encode(), "platforms": " ".join(names).encode()}
    guid = content_guid({**files, **made_by})
    path = Path(out_dir) / f"{model.name}.fmu"
    if archive_guid(path) != guid:
        files = contents(model, names, guid)
        for name in names:
            platform = PLATFORMS[name]
            files[f"binaries/{name}/{model.name}{platform.suffix}"] = library(model, platform, guid, chosen)
        write_archive(path, {**files, **reference_result(model)})
    return path


def contents(model: Model, platforms: list[str], guid: str) -> dict[str, bytes]:
    """Return all files but the binaries and the reference result."""
    unit = unit_name(model, 2)
    files = documentation(model, NEEDS.format(platforms=", ".join(platforms), unit=unit, name=model.name))
    files |= {f"sources/{name}": text.encode() for name, text in fmu_sources(model, guid).items()}
    tool = f"apa-cosim {project_version()}, native"
    files[DESCRIPTION] = model_description(model, guid=guid, generation_tool=tool, flags=FLAGS, sources=(unit,))
    return files


def library(model: Model, platform: Platform, guid: str, compiler: Compiler) -> bytes:
    """Return the shared library of ``model`` for ``platform``; it answers to ``guid`` only."""
    sources, unit = fmu_sources(model, guid), unit_name(model, 2)
    name = f"{model.name}{platform.suffix}"
    slices = [compiler.library(sources, unit, name, target) for target in platform.targets]
    return fat_binary(slices) if len(slices) > 1 else slices[0]
