"""Which files a model is made of, and their hash."""

import hashlib
from pathlib import Path

from modelkit.model import Model


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
