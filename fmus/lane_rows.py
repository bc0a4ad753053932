"""Whole runs as machine code, several at a time: each in one lane of the processor's vectors.

The numbers are those of runs one after the other, to the last bit: see ``native/c/lane_math.h``.
"""

import ctypes
import platform
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fmus.compiled_batch import BatchTables, Doubles, RecordedSignal, Rows, StopCondition
from fmus.native.compilers import CompilerError, processor
from fmus.native.library_cache import lane_batch_library
from fmus.native.platforms import host
from fmus.native.structures import Long, Pointer
from fmus.study_slices import StudyCode
from modelkit.model import Model

FEWEST_RUNS = 4
"""Runs below which most lanes would be empty."""


def has_lanes() -> bool:
    """Return whether this machine has vectors of four doubles or more, the library that ``lane_math.h`` knows, and all
    that makes code for them."""
    flags = processor().split()
    return (
        host() == "linux64"
        and {"avx2", "fma"} <= set(flags)
        and platform.libc_ver()[0] == "glibc"
        and find_spec("pycparser") is not None
    )


def compile_lane_rows(
    models: Mapping[str, Model],
    ending: StopCondition | None,
    kept: Sequence[RecordedSignal],
    code: StudyCode,
    alone: Rows,
) -> Rows | None:
    """Return the runs of a study's own ``code`` in lanes; None where no model has a form in lanes, no compiler
    knows vectors, or the platform's functions are others.

    A model without such a form has an instance for each lane. ``alone``: the same runs one after the other, which
    makes them where there are few. The runs have no faults.
    """
    libraries = load_libraries(models, code) if has_lanes() else []
    if not any(libraries):
        return None
    runner = ctypes.CDLL(str(lane_batch_library(code.options)))
    runner.lane_rows.restype = runner.lanes_agree.restype = Long
    runner.lane_rows.argtypes = [Pointer, Pointer, Long, Pointer, Pointer, Pointer]
    if not runner.lanes_agree():
        return None
    tables = BatchTables(models, ending, kept, (), code)
    lanes = tables.array(Pointer, [library and library.lane_library() for library in libraries])

    def rows(parameters: Doubles, times: NDArray[np.int64], disturbed: Doubles, out: Doubles) -> None:
        """Run all; no lock is held meanwhile."""
        if len(parameters) < FEWEST_RUNS:
            alone(parameters, times, disturbed, out)
            return
        tables.check(parameters, times, disturbed, out)
        pointers = (array.ctypes.data for array in (parameters, times, out))
        if runner.lane_rows(tables.address, lanes, len(parameters), *pointers):
            raise MemoryError

    return rows


def load_libraries(models: Mapping[str, Model], code: StudyCode) -> list[Any]:
    """Return the library in lanes of each model, None for one without such a form; none at all if none compiles."""
    from fmus.compiler.lanes import NoLanesError
    from fmus.native.libraries import load_lanes

    libraries: list[Any] = []
    for name, model in models.items():
        try:
            libraries.append(load_lanes(model, code.slices[name], code.options))
        except NoLanesError:
            libraries.append(None)
        except CompilerError:
            return []
    return libraries
