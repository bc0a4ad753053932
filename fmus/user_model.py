"""A user's model: read from a file or a package folder, and what is wrong with it in one line each."""

import importlib.util
import sys
import traceback
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from fmus.build import Built, build_all
from fmus.compiler import UnsupportedError, translate
from fmus.model_fields import field_refusals
from fmus.native.c_library import write_c_library
from modelkit.model import Model

RESERVED = ("fmus", "modelkit", "orchestrator", "pythonfmu", "vehicle_fmu", "controller_fmu")
"""Packages that a PythonFMU or this project has."""
_loaded: set[str] = set()


class BadModel(ValueError):  # noqa: N818 - said as it is
    """What is wrong with a model, one line for each mistake."""


def own_model(text: str) -> Model:
    """Return the model that ``text`` names: ``tank.py:MODEL``, ``folder/package:MODEL``, or either without ``:MODEL``.

    Raises ``BadModel`` with file, line and what to write instead.
    """
    place, _, name = text.rpartition(":")
    if not (place and name.isidentifier()):
        place, name = text, "MODEL"
    module = _module(Path(place))
    model = getattr(module, name, None)
    if not isinstance(model, Model):
        has = ", ".join(key for key, value in vars(module).items() if isinstance(value, Model))
        advice = f"it has {has}" if has else f"write {name} = Model(...) at its end"
        raise BadModel(f"{place}: no Model is called {name}: {advice}")
    if not (model.name.isidentifier() and model.name.isascii()):
        raise BadModel(f"{place}: the name {model.name!r} of {name}: write letters, digits and _, such as Tank")
    if model.package is not module:
        raise BadModel(f"{place}: the package of {name} is another one: write sys.modules[__name__]")
    refusals = field_refusals(model)
    if refusals:
        raise BadModel(str(UnsupportedError(refusals)))
    return model


def build_own(
    model: Model, out: Path, kinds: Iterable[str], platforms: Iterable[str] | None = None, cc: str | None = None
) -> list[Built]:
    """Return what was built of ``model``: <out>/<kind>/<Name>.fmu, and <out>/c for the kind ``c``.

    Raises ``BadModel`` if the model cannot be it, ``RuntimeError`` without a C compiler or if it fails.
    """
    with lines_of(model):
        translate(model)
        made = build_all(out, [kind for kind in kinds if kind != "c"], None, platforms, cc, [model])
        if "c" in kinds:
            file = out / "c" / f"{model.name}.c"
            before = file.read_bytes() if file.is_file() else b""
            write_c_library(model, out / "c")
            made.append(Built("c", model.name, file, "", file.read_bytes() != before))
    return made


@contextmanager
def lines_of(model: Model) -> Iterator[None]:
    """Turn what a model's own functions raise, and what makers of FMUs say about it, into ``BadModel``."""
    try:
        yield
    except UnsupportedError as error:
        raise BadModel(str(error)) from error
    except (Exception, SystemExit) as error:
        file = Path(str(model.package.__file__))
        place = _place(error, file.parent if file.name == "__init__.py" else file)
        if place:
            advice = "an FMU's model never raises: test beforehand with if (inputs at their start values)"
            raise BadModel(f"{place}: {type(error).__name__}: {error}: {advice}") from error
        if isinstance(error, ValueError):
            raise BadModel(str(error)) from error
        raise


def _module(path: Path) -> ModuleType:
    """Return the module in the file or folder ``path``, run anew."""
    if not path.exists():
        raise BadModel(f"{path}: there is no such file")
    name, file = path.stem, path / "__init__.py" if path.is_dir() else path
    if not file.is_file() or file.suffix != ".py":
        raise BadModel(f"{path}: a model is a .py file, or a folder with __init__.py")
    _check_name(name, file)
    for known in [known for known in sys.modules if known == name or known.startswith(f"{name}.")]:
        del sys.modules[known]
    places = [str(path)] if path.is_dir() else None
    spec = importlib.util.spec_from_file_location(name, file.resolve(), submodule_search_locations=places)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    _loaded.add(name)
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise BadModel(_read_error(error, path)) from error
    return module


def _check_name(name: str, file: Path) -> None:
    """Raise ``BadModel`` if a module of this name cannot be had, or is another one."""
    if not name.isidentifier():
        raise BadModel(f"{file}: {name!r} is no name for a Python module: write letters, digits and _")
    taken = name in RESERVED or name in sys.stdlib_module_names
    if not taken and name not in _loaded:
        found = importlib.util.find_spec(name)
        taken = found is not None and (found.origin is None or not file.samefile(found.origin))
    if taken:
        raise BadModel(f"{file}: there is another Python module called {name}: rename the file")


def _read_error(error: BaseException, path: Path) -> str:
    """Return one line about what went wrong while a model was read."""
    if isinstance(error, SyntaxError):
        return f"{Path(error.filename or path).name}:{error.lineno}: {error.msg}"
    place = _place(error, path) or str(path)
    if isinstance(error, TypeError) and "Signal" in str(error) and "missing" in str(error):
        return f'{place}: a Signal without unit or meaning: write Signal("m/s", "what it is, in which direction")'
    if isinstance(error, ModuleNotFoundError):
        advice = "a model imports the standard library, modelkit and its own package"
        return f"{place}: there is no module {error.name}: {advice}"
    return f"{place}: {type(error).__name__}: {' '.join(str(error).split())}"


def _place(error: BaseException, path: Path) -> str:
    """Return ``file:line`` of the last line below ``path`` that ran, or an empty string."""
    here = path.resolve()
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        file = Path(frame.filename)
        if here == file or here in file.parents:
            return f"{file.name}:{frame.lineno}"
    return ""
