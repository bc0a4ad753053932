"""The papers that can be reproduced: every module of this folder that has a function ``reproduce``."""

import importlib
from pathlib import Path

from orchestrator.inputs.text.errors import BadInput, suggestion
from orchestrator.studies.papers.result import Reproduce


def papers() -> list[str]:
    """Return their names, sorted. None is imported: that takes a second."""
    files = sorted(Path(__file__).parent.glob("*.py"))
    return [file.stem for file in files if "\ndef reproduce(" in file.read_text(encoding="utf-8")]


def paper(name: str) -> Reproduce:
    """Return the function that reproduces the paper ``name``. Raises ``BadInput`` with what is known."""
    known = papers()
    if name not in known:
        raise BadInput(f"{name}: no such paper{suggestion(name, known)}; known are {', '.join(known)}, all")
    function: Reproduce = importlib.import_module(f"{__package__}.{name}").reproduce
    return function
