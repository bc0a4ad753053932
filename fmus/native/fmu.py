"""From a model package to a co-simulation FMU, FMI 2.0 or 3.0, that needs nothing at run time but libc and libm."""

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

from fmus.cache_paths import CACHE_FOLDER
from fmus.contents.archive import DESCRIPTION, archive_bytes, archive_guid, content_guid
from fmus.contents.description import ABILITIES, model_description, project_version
from fmus.contents.description3 import ABILITIES as ABILITIES3
from fmus.contents.description3 import model_description3
from fmus.contents.fmu_documentation import documentation, reference_result
from fmus.contents.xml_file import xml_bytes
from fmus.files import write_whole
from fmus.locks import cache_file
from fmus.native.compilers import FLAGS, Compiler, find_compiler
from fmus.native.fat_binary import fat_binary
from fmus.native.libraries import in_c
from fmus.native.platforms import PLATFORMS
from fmus.native.sources import fmu_sources, unit_name
from modelkit.model import Model

CACHED_FMUS = 4
"""FMUs of a model and FMI version that stay in the cache: built elsewhere, the same content is not compiled again."""

NEEDS = """
<p>This FMU is machine code for {platforms}, made from the C in its folder <code>sources</code>, which was made from
the model's Python source. It needs no Python, no other library than the C library, and no licence. Several instances
may run in one process and on several threads, each instance on one thread at a time.</p>
<p>For another target compile <code>sources/{unit}</code> alone; its first lines say with which flags. Linked into one
image with other FMUs its functions have the prefix <code>{name}_</code>, as FMI{fmi}_FUNCTION_PREFIX defines.</p>
<p>A parameter outside its range, a variable that does not exist, a call out of order or a step that is not
in (0, 3600] s is answered with fmi{fmi}Error and a message to the logger; nothing is changed by such a call.</p>
<!-- stack -->
"""
PAGE = "documentation/index.html"
PLACE_OF_STACK = b"<!-- stack -->\n"
STACK = """<p>The largest stack frame of its functions, those of a step among them, has {frame} bytes. No function is
recursive.</p>
"""
INSIDE = """
<p>Inside are {parts}. Every {period:g} s, whatever the communication step, each takes the outputs of the other to its
inputs of the same name, those aside that are inputs of this FMU. Their variables have their name before them.</p>
"""


def build(
    model: Model,
    out_dir: Path,
    platforms: Iterable[str] = tuple(PLATFORMS),
    compiler: Compiler | None = None,
    fmi: int = 2,
) -> Path:
    """Return the path of ``out_dir/<model.name>.fmu``; written only if its content would change.

    Raises ``TypeError`` if the model cannot be translated, ``RuntimeError`` without a C compiler or if it fails.
    """
    names = sorted(platforms)
    chosen = compiler or find_compiler()
    recipes = {f"{name} {target.triple}": chosen.recipe(target) for name in names for target in PLATFORMS[name].targets}
    made_by = {name: recipe.encode() for name, recipe in recipes.items()}
    guid = content_guid({**contents(model, names, "", fmi), **made_by})
    path = Path(out_dir) / f"{model.name}.fmu"
    if archive_guid(path) != guid:
        build_archive = partial(archive, model, names, guid, chosen, fmi)
        cached = cache_file(
            CACHE_FOLDER, f"{model.name}-fmi{fmi}", guid.strip("{}"), ".fmu", build_archive, CACHED_FMUS
        )
        write_whole(path, cached.read_bytes())
    return path


def archive(model: Model, platforms: list[str], guid: str, compiler: Compiler, fmi: int = 2) -> bytes:
    """Return the FMU that answers to ``guid``, compiled. Raises as :func:`build`."""
    files = contents(model, platforms, guid, fmi)
    files |= reference_result(model) if model.assembly is None else reference_result(model, in_c)
    made, frame = binaries(model, platforms, guid, compiler, fmi)
    if frame:
        files[PAGE] = files[PAGE].replace(PLACE_OF_STACK, STACK.format(frame=frame).encode())
    return archive_bytes(files | made)


def contents(model: Model, platforms: list[str], guid: str, fmi: int = 2) -> dict[str, bytes]:
    """Return all files but the binaries and the reference result."""
    unit, tool = unit_name(model, fmi), f"apa-cosim {project_version()}, native"
    needs = NEEDS.format(platforms=", ".join(platforms), unit=unit, name=model.name, fmi=fmi)
    if model.assembly is not None:
        parts = " and ".join(f"{name} ({part.name})" for name, part in model.assembly.parts)
        needs += INSIDE.format(parts=parts, period=model.step_size)
    files = documentation(model, needs, fmi)
    files |= {f"sources/{name}": text.encode() for name, text in fmu_sources(model, guid, fmi).items()}
    if fmi == 3:
        files["sources/buildDescription.xml"] = build_description(model)
        files[DESCRIPTION] = model_description3(model, token=guid, generation_tool=tool, flags=ABILITIES3)
    else:
        files[DESCRIPTION] = model_description(model, guid=guid, generation_tool=tool, flags=ABILITIES, sources=(unit,))
    return files


def binaries(
    model: Model, platforms: list[str], guid: str, compiler: Compiler, fmi: int = 2
) -> tuple[dict[str, bytes], int]:
    """Return the shared libraries, under their paths in the FMU, and the largest stack frame in any of them [bytes].

    They answer to ``guid`` only. The frame is 0 if the compiler does not say.
    """
    sources, unit = fmu_sources(model, guid, fmi), unit_name(model, fmi)
    files: dict[str, bytes] = {}
    frame = 0
    for name in platforms:
        platform = PLATFORMS[name]
        file = f"{model.name}{platform.suffix}"
        compiled = [compiler.link(sources, [unit], file, target) for target in platform.targets]
        frame = max(frame, *(one.largest_frame for one in compiled))
        made = [one.content for one in compiled]
        if fmi == 3:
            files |= {f"binaries/{folder}/{file}": one for folder, one in zip(platform.folders3, made, strict=True)}
        else:
            files[f"binaries/{name}/{file}"] = fat_binary(made) if len(made) > 1 else made[0]
    return files, frame


def build_description(model: Model) -> bytes:
    """Return sources/buildDescription.xml of FMI 3.0: what to compile, and with which flags."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(root, "BuildConfiguration", modelIdentifier=model.name)
    options = {"compiler": "gcc", "compilerOptions": " ".join(FLAGS)}
    files = SubElement(configuration, "SourceFileSet", {"language": "C99", **options})
    SubElement(files, "SourceFile", name=unit_name(model, 3))
    text = "for a shared library: functions without prefix"
    definition = {"name": "FMI3_OVERRIDE_FUNCTION_PREFIX", "value": "1", "optional": "true", "description": text}
    SubElement(files, "PreprocessorDefinition", definition)
    text = "mathematical functions, where the C library does not have them in it"
    SubElement(configuration, "Library", name="m", external="true", description=text)
    return xml_bytes(root)
