"""What the C of a model is made of, as words and digits that name what is kept of it. Imports no compiler of models."""

import hashlib
from pathlib import Path
from typing import Any

from modelkit.model import Model
from modelkit.variables import flatten

ROOT = Path(__file__).parents[2]
SUFFIXES = (".py", ".c", ".h")
CACHED_TRANSLATIONS = 4
"""Translations of older sources that stay in the cache."""


def own_packages(model: Model) -> list[Path] | None:
    """Return the packages that ``model`` is made of if they are this project's own, else None."""
    packages = [Path(str(package.__file__)).parent for package in model.sources()]
    return None if any(package.parent != ROOT for package in packages) else packages


def words_of(model: Model) -> list[str]:
    """Return what the C of ``model`` depends on beside the sources."""
    parts: list[Any] = [model.state, model.params, model.inputs, model.outputs, model.initialize, model.step]
    parts += [] if model.store is None else [model.store]
    words = [model.name, model.description, *(f"{part.__module__} {part.__qualname__}" for part in parts)]
    words += [repr(flatten(start)) for start in (model.params(), model.first_params(), model.inputs())]
    if model.assembly is not None:
        words += [str(model.assembly.period_ns), *sorted(model.assembly.opened)]
        words += [word for name, part in model.assembly.parts for word in (name, *words_of(part))]
    return words


def hash_of(folders: list[Path], more: str) -> str:
    """Return digits that depend on the names and contents of all Python and C files in ``folders``, and ``more``."""
    digest = hashlib.sha256(more.encode())
    for path in (path for folder in folders for path in sorted(folder.rglob("*.[pch]*"))):
        if path.suffix not in SUFFIXES:
            continue
        digest.update(f"{path.relative_to(ROOT)}\0{path.read_text(encoding='utf-8')}\0".encode())
    return digest.hexdigest()[:32]
