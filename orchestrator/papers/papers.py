"""The papers that can be reproduced: every module of this folder that has a function ``reproduce``."""

import importlib
import pkgutil

import orchestrator.papers as folder
from orchestrator.papers.result import Reproduce
from orchestrator.text.errors import BadInput, suggestion


def papers() -> list[str]:
    """Return their names, sorted."""
    names = sorted(module.name for module in pkgutil.iter_modules(folder.__path__))
    return [name for name in names if hasattr(importlib.import_module(f"{folder.__name__}.{name}"), "reproduce")]


def paper(name: str) -> Reproduce:
    """Return the function that reproduces the paper ``name``. Raises ``BadInput`` with what is known."""
    known = papers()
    if name not in known:
        raise BadInput(f"{name}: no such paper{suggestion(name, known)}; known are {', '.join(known)}, all")
    function: Reproduce = importlib.import_module(f"{folder.__name__}.{name}").reproduce
    return function
