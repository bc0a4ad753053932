"""A model of one's own as an instance: built when it, or what makes FMUs, has changed."""

import hashlib
from pathlib import Path
from threading import Lock

from fmus.user_model import BadModel, build_own, own_model
from orchestrator.inputs.text.console import working
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.fmu_files import sources_hash
from orchestrator.simulation.cosim.kinds import default_kind

READING = Lock()
"""A module is read anew each time: one at a time."""


def is_model(text: str) -> bool:
    """Return whether ``text`` means a model, ``law.py:MODEL`` or ``package:MODEL``, and no .fmu."""
    place, colon, name = text.rpartition(":")
    path = Path(place if colon and name.isidentifier() and place else text)
    return path.suffix == ".py" or (path / "__init__.py").is_file()


def own_fmu(text: str) -> Path:
    """Return the FMU of the model that ``text`` names, native where that can be built. Raises ``BadInput``."""
    from fmus.cache_paths import DIST

    try:
        with READING:
            model = own_model(text)
            kind = default_kind()
            folder = DIST / "own" / _hash(Path(str(model.package.__file__)), kind)
            path = folder / kind / f"{model.name}.fmu"
            if not path.is_file():
                with working(f"building {model.name}"):
                    build_own(model, folder, [kind])
        return path
    except (BadModel, RuntimeError) as error:
        raise BadInput(str(error)) from error


def _hash(file: Path, kind: str) -> str:
    """Return a hash of a model's sources and of all that makes an FMU of them."""
    digest = hashlib.sha256(f"{kind} {sources_hash()}".encode())
    sources = sorted(file.parent.rglob("*.py")) if file.name == "__init__.py" else [file]
    for source in sources:
        digest.update(f"{source.name}\0".encode() + source.read_bytes())
    return digest.hexdigest()[:24]
