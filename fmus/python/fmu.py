"""From a model package to an FMI 2.0 co-simulation FMU that runs the package's Python code (PythonFMU inside)."""

from pathlib import Path

from fmus.contents.archive import DESCRIPTION, archive_guid, content_guid, write_archive
from fmus.contents.description import ABILITIES, model_description, project_version
from fmus.contents.extras import documentation, reference_result
from fmus.python.bundle import bundle, runtime_folder, runtime_licence, runtime_version
from modelkit.model import Model

NEEDS = """
<p>This FMU holds its model as Python source and runs it in the Python of the host: CPython 3.11 or later on
linux64 or win64. A host that is a Python program (FMPy, libcosimpy, OMSimulator's Python package) needs nothing more;
any other host must have the library of Python 3 loaded. Only Python's standard library is used: the part of PythonFMU
that runs at simulation time is inside, numpy is not needed.</p>
<p>The path into which the FMU is extracted must be plain ASCII.</p>
"""


def build(model: Model, out_dir: Path) -> Path:
    """Return the path of ``out_dir/<model.name>.fmu``; written only if its content would change."""
    files = _content(model)
    guid = content_guid({**files, DESCRIPTION: _description(model, "")})
    path = Path(out_dir) / f"{model.name}.fmu"
    if archive_guid(path) != guid:
        files[DESCRIPTION] = _description(model, guid)
        write_archive(path, {**files, **reference_result(model)})
    return path


def _content(model: Model) -> dict[str, bytes]:
    """Return all files except the description and the reference result, which follow from the others."""
    sources = bundle(model)
    files = {f"resources/{path}": text for path, text in sources.files.items()}
    files["resources/slavemodule.txt"] = sources.script.encode()
    files.update(_binaries(model.name))
    files.update(documentation(model, NEEDS))
    files["documentation/licenses/pythonfmu.txt"] = runtime_licence()
    return files


def _description(model: Model, guid: str) -> bytes:
    tool = f"apa-cosim {project_version()} with PythonFMU {runtime_version()}"
    return model_description(model, guid=guid, generation_tool=tool, flags=ABILITIES)


def _binaries(name: str) -> dict[str, bytes]:
    folder = runtime_folder() / "resources" / "binaries"
    libraries = (path for path in folder.rglob("*") if path.suffix in (".so", ".dll", ".dylib"))
    return {f"binaries/{path.parent.name}/{name}{path.suffix}": path.read_bytes() for path in libraries}
