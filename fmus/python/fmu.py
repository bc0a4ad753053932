"""From a model package to an FMI 2.0 co-simulation FMU that runs the package's Python code (PythonFMU inside)."""

from pathlib import Path
from typing import NamedTuple

from fmus.cache_paths import CACHE_FOLDER
from fmus.contents.archive import DESCRIPTION, archive_bytes, archive_guid, content_guid
from fmus.contents.description import ABILITIES, model_description, project_version
from fmus.contents.fmu_documentation import documentation, reference_result
from fmus.files import write_whole
from fmus.locks import cache_file
from fmus.python.bundle import MODEL_SLAVE, SlaveClass, bundle, runtime_folder, runtime_licence, runtime_version
from fmus.python.layout import POLICY_FILE
from modelkit.model import Model

NEEDS = """
<p>This FMU holds its model as Python source and runs it in the Python of the host: CPython 3.11 or later on
linux64 or win64. A host that is a Python program (FMPy, libcosimpy, OMSimulator's Python package) needs nothing more;
any other host must have the library of Python 3 loaded. Only Python's standard library is used: the part of PythonFMU
that runs at simulation time is inside, numpy is not needed.</p>
"""
NEEDS_OF_POLICY = """
<p>It runs a policy, <code>resources/policy.onnx</code>, with numpy and onnxruntime, which the Python of the host must
have.</p>
"""
LIMITS = """
<p>{where} the library of PythonFMU {version} is called as it is. The path into which the FMU is extracted must be
plain there: letters, digits, blanks and <code>- . _ ~</code>, for of a URI it understands <code>file:///</code> and
<code>%20</code> alone. It crashes on others, without a logger, and on null pointers; it takes any GUID; and in a host
that is no Python program it may abort when the process ends. The native FMU of the same model has none of these
limits.</p>
"""
FRONT = """
<p>On linux64 a library of apa-cosim stands before that of PythonFMU. It takes any path but one with the characters
<code>%20</code> in a name, any form of URI, and hosts without a logger, and refuses a wrong GUID. A call at the wrong
time or of an unknown variable is logged and makes the next fmi2DoStep be discarded, where the native FMU answers with
fmi2Error at once.</p>
"""
BEHIND = "pythonfmu-export.so"
"""The library of PythonFMU behind ours."""
CACHED_FMUS = 4
"""FMUs of a name that stay in the cache: their reference results take seconds."""


class PolicyFile(NamedTuple):
    """What makes an FMU of the policy's controller that of one policy."""

    network: bytes
    """The content of its ONNX file."""
    period_ns: int
    """Between two actions."""


def build(model: Model, out_dir: Path, front: bytes | None = None, policy: PolicyFile | None = None) -> Path:
    """Return the path of ``out_dir/<model.name>.fmu``; written only if its content would change.

    ``front`` is the library that stands before PythonFMU's on linux64: see ``python_front.c``. ``policy``: the FMU
    carries it out, and has no reference result, as onnxruntime is not ours.
    """
    files = _content(model, front, policy)
    guid = content_guid({**files, DESCRIPTION: _description(model, "")})
    path = Path(out_dir) / f"{model.name}.fmu"
    if archive_guid(path) != guid:

        def pack() -> bytes:
            own = {DESCRIPTION: _description(model, guid), "resources/guid.txt": guid.encode()}
            return archive_bytes({**files, **own, **(reference_result(model) if policy is None else {})})

        cached = cache_file(CACHE_FOLDER, f"{model.name}-python", guid.strip("{}"), ".fmu", pack, CACHED_FMUS)
        write_whole(path, cached.read_bytes())
    return path


def _content(model: Model, front: bytes | None, policy: PolicyFile | None) -> dict[str, bytes]:
    """Return all files except those that follow from the others: description, GUID, reference result."""
    more = "" if policy is None else f"    period_ns = {policy.period_ns}\n"
    slave = MODEL_SLAVE if policy is None else SlaveClass("policy_slave", "PolicySlave", more)
    sources = bundle(model, slave)
    limits = LIMITS.format(where="On win64" if front else "On linux64 and win64", version=runtime_version())
    files = {f"resources/{path}": text for path, text in sources.files.items()}
    files["resources/slavemodule.txt"] = sources.script.encode()
    files.update(_binaries(model.name))
    if front:
        first = f"binaries/linux64/{model.name}.so"
        files |= {f"binaries/linux64/{BEHIND}": files[first], first: front}
    if policy is not None:
        files[f"resources/{POLICY_FILE}"] = policy.network
    needs = NEEDS if policy is None else NEEDS + NEEDS_OF_POLICY
    files.update(documentation(model, needs + (FRONT if front else "") + limits))
    files["documentation/licenses/pythonfmu.txt"] = runtime_licence()
    return files


def _description(model: Model, guid: str) -> bytes:
    tool = f"apa-cosim {project_version()} with PythonFMU {runtime_version()}"
    return model_description(model, guid=guid, generation_tool=tool, flags=ABILITIES)


def _binaries(name: str) -> dict[str, bytes]:
    folder = runtime_folder() / "resources" / "binaries"
    libraries = (path for path in folder.rglob("*") if path.suffix in (".so", ".dll", ".dylib"))
    return {f"binaries/{path.parent.name}/{name}{path.suffix}": path.read_bytes() for path in libraries}
