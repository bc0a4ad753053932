"""From LLVM IR to an object file for any platform: hide all but the entries, optimise, emit.

Numba runs in a process of its own, told to know nothing of this machine's processor, so that the
same sources give the same bytes everywhere. The IR is kept in ``fmus/dist/cache`` under the hash
of the model's sources.
"""

import os
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import llvmlite.binding as llvm  # type: ignore[import-untyped]

from fmus.locks import one_at_a_time
from fmus.places import CACHE
from fmus.sources import reference, source_hash
from modelkit.model import Model

HEAD = ";; module\n"
WIDE = 60
"""Scalars a function may take before it is always inlined."""
NUMBA_S_CHOICE = re.compile(r"\b(noinline|alwaysinline)\b")
"""Numba says of each function whether it is inlined; LLVM, which sees all callers, decides better."""
ENTRIES = ("model_initialize", "model_step")
KEPT = 4
IR_MAKERS = ("compiled.py", "compiled_modules.py", "compiled_types.py", "compiled_views.py", "flat_entry.py")
"""Files beside this one that numba's code depends on."""
LIBM = frozenset(
    """acos asin atan atan2 ceil cos cosh exp fabs floor fmax fmin log pow rint round sin sinh sqrt tan tanh
    trunc""".split()  # noqa: SIM905
)
"""Functions of the C library that a model may call."""


def intermediate_code(model: Model) -> str:
    """Return numba's IR of both entries, from the cache if the sources are the same."""
    tools = f"numba {version('numba')}, llvmlite {version('llvmlite')}"
    path = CACHE / f"{model.name}-{source_hash(model, tools, _own_sources())}.ll"
    with one_at_a_time(path):
        if not path.exists():
            part = path.with_name(f"{path.name}.{os.getpid()}.part")
            part.write_text(_run_numba(model))
            part.replace(path)
            _forget_old(model)
        return path.read_text()


def _forget_old(model: Model) -> None:
    """Delete all but the newest codes of ``model``; each can have many megabytes."""
    by_age = sorted(CACHE.glob(f"{model.name}-*.ll"), key=lambda path: path.stat().st_mtime)
    for path in by_age[:-KEPT]:
        path.unlink(missing_ok=True)


def _own_sources() -> str:
    return "".join((Path(__file__).parent / name).read_text() for name in IR_MAKERS)


def _run_numba(model: Model) -> str:
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
        "PYTHONHASHSEED": "0",
        "NUMBA_CPU_NAME": "generic",
        "NUMBA_CPU_FEATURES": "",
        "NUMBA_DISABLE_INTEL_SVML": "1",
    }
    command = [sys.executable, "-m", "fmus.compiled", reference(model)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise TypeError(f"{model.name}: {done.stderr.strip()}")
    return done.stdout


def object_code(model: Model, triple: str) -> bytes:
    """Return a relocatable object file for ``triple`` that defines the two entries and needs libm only.

    Raises ``TypeError`` if the model's code needs anything else.
    """
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    machine = llvm.Target.from_triple(triple).create_target_machine(cpu="", opt=2, reloc="pic", codemodel="default")
    module = _module(intermediate_code(model))
    module.triple = triple
    module.data_layout = str(machine.target_data)
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=2))
    builder.getModulePassManager().run(module, builder)
    foreign = [item.name for item in module.functions if item.is_declaration and not _allowed(item.name)]
    if foreign:
        raise TypeError(f"{model.name}: its code needs {', '.join(foreign)}, which a native FMU does not have")
    return bytes(machine.emit_object(module))


def _allowed(name: str) -> bool:
    return name in LIBM or name.startswith("llvm.")


def _module(text: str) -> llvm.ModuleRef:
    """Return all modules linked into one, with the entries under their plain names and everything else internal."""
    free = NUMBA_S_CHOICE.sub("nounwind", text)
    first, *others = [llvm.parse_assembly(part) for part in free.split(HEAD)[1:]]
    for other in others:
        first.link_in(other)
    for item in (*first.functions, *first.global_variables):
        if not item.is_declaration:
            item.linkage = "internal"
    for name in ENTRIES:
        _export(first, name)
    _inline_wide_calls(first)
    return first


def _inline_wide_calls(module: llvm.ModuleRef) -> None:
    """Mark functions that take a whole state: passing it costs more than the call saves."""
    for item in module.functions:
        wide = not item.is_declaration and sum(1 for _ in item.arguments) > WIDE
        if wide and item.name not in ENTRIES:
            item.add_function_attribute("alwaysinline")


def _export(module: llvm.ModuleRef, name: str) -> None:
    entry = [item for item in module.functions if name in item.name and not item.is_declaration]
    if len(entry) != 1:
        raise TypeError(f"{len(entry)} functions are called {name}; no function of a model may have this name")
    entry[0].name = name
    entry[0].linkage = "external"
    entry[0].visibility = "hidden"
