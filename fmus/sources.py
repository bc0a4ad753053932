"""Which files a model is made of, their hash, and a model found again by its name."""

import hashlib
import importlib
from pathlib import Path

from modelkit.model import Model

MODELKIT_FILES = ("modelkit.maths", "modelkit.random", "modelkit.signal", "modelkit.vocabulary", "modelkit.geometry")


def source_files(model: Model) -> list[Path]:
    """Return all Python files of the model's package and of modelkit, in a fixed order."""
    import modelkit

    roots = [Path(str(package.__file__)).parent for package in (modelkit, model.package)]
    return [path for root in roots for path in sorted(root.rglob("*.py"))]


def source_hash(model: Model, *more: str) -> str:
    """Return 32 hexadecimal digits over the names and contents of the source files, and ``more``."""
    digest = hashlib.sha256()
    for path in source_files(model):
        text = path.read_bytes().replace(b"\r\n", b"\n")
        for part in (path.name.encode(), text):
            digest.update(len(part).to_bytes(8, "little") + part)
    for item in (model.package.__name__, model.name, *more):
        digest.update(len(item).to_bytes(8, "little") + item.encode())
    return digest.hexdigest()[:32]


def reference(model: Model) -> str:
    """Return ``package:NAME`` under which :func:`load` finds ``model``; ``ValueError`` if its package has no such."""
    for name, item in vars(model.package).items():
        if item is model:
            return f"{model.package.__name__}:{name}"
    raise ValueError(f"{model.package.__name__} must have the Model of {model.name} as a module variable")


def load(text: str) -> Model:
    """Return the Model called ``package:NAME``."""
    package, _, name = text.partition(":")
    model = getattr(importlib.import_module(package), name)
    if not isinstance(model, Model):
        raise TypeError(f"{text} is no modelkit.model.Model")
    return model
