"""Whole runs as machine code: many at once, without Python in between and without the interpreter's lock.

The text of a run comes from ``batch_source``; the models are made compilable by ``compiled``. The
machine code is kept in ``fmus/dist/cache`` under a hash of every source it is made from, because
numba's own cache does not notice an edit in another file.
"""

import hashlib
import importlib.util
import os
import platform
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numba
from numba import types

from fmus.batch_source import Ending, Kept, run_source
from fmus.compiled import OPTIONS, make_compilable
from fmus.sources import source_hash
from modelkit.model import Model

CACHE = Path(__file__).parent / "dist" / "cache"
ROWS = types.void(
    types.Array(types.float64, 2, "C", readonly=True),
    types.Array(types.int64, 2, "C", readonly=True),
    types.float64[:, ::1],
)
HEAD = '"""Made by fmus/compiled_batch.py; safe to delete."""\n\n\n'
LOOP = """

def rows(p, times, out):
    for number in range(out.shape[0]):
        run(p[number], times[number], out[number])
"""
Rows = Callable[[Any, Any, Any], None]
"""``rows(p, times, out)``: one run for each line of the three arrays, see ``run_source``; holds no lock."""


def compiled_rows(models: Mapping[str, Model], ending: Ending | None, kept: Sequence[Kept]) -> Rows:
    """Return the compiled function, from the cache if no source has changed. Compiles for some ten seconds otherwise.

    Raises ``KeyError`` for a kept signal that no model has.
    """
    scope: dict[str, Any] = {}
    text = HEAD + run_source(models, ending, kept, scope) + LOOP
    for model in models.values():
        make_compilable(model.package)
    name = f"apa_rows_{_digest(text, models)}"
    with _alone(name):
        module = _module(name, text, scope)
        module.run = numba.njit(forceinline=True, **OPTIONS)(module.run)
        compiled: Rows = numba.njit(ROWS, cache=True, **OPTIONS)(module.rows)
    return compiled


@contextmanager
def _alone(name: str) -> Iterator[None]:
    """Let one process compile at a time, where the system has file locks; the others find it in the cache."""
    CACHE.mkdir(parents=True, exist_ok=True)
    with (CACHE / f"{name}.lock").open("w", encoding="ascii") as lock:
        if sys.platform != "win32":
            import fcntl

            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _digest(text: str, models: Mapping[str, Model]) -> str:
    here = Path(__file__).parent
    own = "".join(path.read_text() for path in sorted(here.glob("compiled*.py")))
    tools = f"numba {version('numba')}, llvmlite {version('llvmlite')}, python {platform.python_version()}"
    parts = [text, own, tools, *(source_hash(model) for model in models.values())]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]


def _module(name: str, text: str, scope: Mapping[str, Any]) -> Any:
    """Return ``text`` as a module with a file of its own, which numba's cache asks for."""
    path = CACHE / f"{name}.py"
    if not path.exists():
        part = path.with_name(f"{path.name}.{os.getpid()}.part")
        part.write_text(text)
        part.replace(path)
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    vars(module).update(scope)
    return module
