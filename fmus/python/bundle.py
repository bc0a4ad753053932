"""The Python sources inside a PythonFMU, below one package whose name is a hash of them.

So two FMUs, two builds of one FMU, and a host that has imported the same packages itself never share a module.
"""

import ast
import re
import sys
from functools import cache
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import fmus
import modelkit
from fmus.contents.archive import content_hash
from modelkit.model import Model

SLAVE_FILES = ("python/__init__.py", "python/binary.py", "python/layout.py", "python/slave.py")
RUNTIME_FILES = ("_version.py", "default_experiment.py", "enums.py", "fmi2slave.py", "logmsg.py", "variables.py")
TESTS = "test_"
"""How the files of a package begin that stay at home."""
RUNTIME_INIT = b'"""The part of PythonFMU that runs inside an FMU."""\n'
MIN_PYTHON = (3, 11)
"""Of the host; the script below is read by any Python 3, which it reports."""
SCRIPT = '''"""Entry point of this FMU."""

import sys

if sys.version_info < {minimum}:
    raise ImportError("this FMU needs Python %d.%d or later, its host has %d.%d" % ({minimum} + sys.version_info[:2]))

from {root}.fmus.python.layout import Layout
from {root}.fmus.python.{module} import {base}
from {root}.{package} import {attribute}

NAMESPACE = globals()
"""A second reference: PythonFMU drops one before the first instance exists (see ``fmus.python.binary.keep``)."""


class {script}({base}):
    model = {model}
    build = "{hash}"
    layout = Layout(model)
{more}'''


class SlaveClass(NamedTuple):
    """The class behind the FMI binary: its file in ``fmus.python``, its name, and further lines of its subclass."""

    module: str = "slave"
    name: str = "ModelSlave"
    more: str = ""


MODEL_SLAVE = SlaveClass()


class Bundle(NamedTuple):
    """Python sources ready to be put below ``resources``."""

    hash: str
    script: str
    """Name of the slave's module."""
    files: dict[str, bytes]


def bundle(model: Model, slave: SlaveClass = MODEL_SLAVE) -> Bundle:
    """Return all sources that ``model`` needs, with their imports pointing below the hashed root package."""
    name = model.package.__name__
    if "." in name:
        raise ValueError(f"{name}: the package of a model must be a top-level package, or a module")
    originals = {
        **_package("modelkit", modelkit.__file__),
        **_package(name, model.package.__file__),
        **{f"fmus/{file}": (_folder(fmus.__file__) / file).read_bytes() for file in _slave_files(slave)},
        "fmus/__init__.py": b"",
        **{f"pythonfmu/{file}": (runtime_folder() / file).read_bytes() for file in RUNTIME_FILES},
        "pythonfmu/__init__.py": RUNTIME_INIT,
    }
    script = SCRIPT.format(
        root="{root}",
        script="{script}",
        module=slave.module,
        base=slave.name,
        more=slave.more,
        hash="{hash}",
        package=name,
        minimum=MIN_PYTHON,
        **_model_names(model),
    )
    digest = content_hash({**originals, "script": script.encode()})
    root, module = f"fmu_{digest[:16]}", f"slave_{digest[:16]}"
    tops = {path.split("/")[0].removesuffix(".py") for path in originals}
    files = {f"{root}/{path}": rewrite(text, path, root, tops) for path, text in originals.items()}
    files[f"{root}/__init__.py"] = b""
    files[f"{module}.py"] = script.format(root=root, script=module.title(), hash=digest).encode()
    return Bundle(digest, module, files)


def _slave_files(slave: SlaveClass) -> tuple[str, ...]:
    own = f"python/{slave.module}.py"
    return SLAVE_FILES if own in SLAVE_FILES else (*SLAVE_FILES, own)


def rewrite(source: bytes, path: str, root: str, tops: set[str]) -> bytes:
    """Return ``source`` with ``from top.x import y`` made ``from root.top.x import y``, line numbers kept.

    Raises ``ValueError`` for ``import top.x`` and for packages that are neither bundled nor of the standard library.
    """
    lines = source.split(b"\n")
    for found in _imports(source):
        _check_import(found.module, f"{path}:{found.line}", tops if found.is_from else set())
        if found.is_from and found.module.split(".")[0] in tops:
            line = lines[found.line - 1]
            head, tail = line[: found.column], line[found.column :]
            lines[found.line - 1] = head + re.sub(rb"^from\s+", f"from {root}.".encode(), tail)
    return b"\n".join(lines)


class _Import(NamedTuple):
    module: str
    line: int
    column: int
    is_from: bool
    """``from module import ...``, not ``import module``."""


@cache
def _imports(source: bytes) -> tuple[_Import, ...]:
    """Return the absolute imports of a file: most files are in the FMUs of several models."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found += [_Import(alias.name, node.lineno, node.col_offset, False) for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            found.append(_Import(node.module or "", node.lineno, node.col_offset, True))
    return tuple(found)


def runtime_folder() -> Path:
    """Return the folder of the installed PythonFMU."""
    spec = find_spec("pythonfmu")
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError("pythonfmu is not installed")
    return _folder(spec.origin)


def runtime_version() -> str:
    """Return the version of the installed PythonFMU."""
    return metadata.version("pythonfmu")


def runtime_licence() -> bytes:
    """Return the licence text of the installed PythonFMU; it goes with its binaries."""
    text = metadata.distribution("pythonfmu").read_text("licenses/LICENSE")
    if not text:
        raise FileNotFoundError("the licence of pythonfmu is not in its distribution")
    return text.encode()


def _check_import(module: str, where: str, tops: set[str]) -> None:
    top = module.split(".")[0]
    if top not in tops and top not in sys.stdlib_module_names:
        raise ValueError(
            f"{where}: import of {module}: an FMU holds modelkit and the model's own package, "
            "imported as 'from package.file import name', and the standard library"
        )


def _model_names(model: Model) -> dict[str, str]:
    """Return the name under which the model's package offers it, and how it is made from that.

    A model may differ from that of the package by its name, its hidden variables and its start values.
    """
    for name in dict.fromkeys((*vars(model.package), *getattr(model.package, "__all__", ()))):  # also what comes late
        value = getattr(model.package, name)
        if not isinstance(value, Model):
            continue
        own = value._replace(name=model.name, view=value.view._replace(hidden=model.view.hidden))
        if own == model.with_start_values({}):
            starts = [item for item in model.view.starts if model.shows(item[0])]
            text = name
            if own != value:
                hidden = f"frozenset({sorted(model.view.hidden)!r})"
                text = f"{name}._replace(name={model.name!r}, view={name}.view._replace(hidden={hidden}))"
            return {"attribute": name, "model": f"{text}.with_start_values(dict({starts!r}))" if starts else text}
    raise ValueError(f"{model.package.__name__}: it must hold the Model of {model.name}")


def _package(name: str, origin: str | None) -> dict[str, bytes]:
    folder = _folder(origin)
    if origin is not None and Path(origin).name != "__init__.py":
        return {f"{name}.py": Path(origin).read_bytes()}
    sources = [file for file in folder.rglob("*.py") if not file.name.startswith(TESTS)]
    return {f"{name}/{file.relative_to(folder).as_posix()}": file.read_bytes() for file in sources}


def _folder(origin: str | None) -> Path:
    if origin is None:
        raise ValueError("a package without __init__.py cannot be bundled")
    return Path(origin).parent
