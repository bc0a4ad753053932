"""``apa export mf4``: a run as ASAM MDF 4, with units, comments and the names of states. Needs asammdf."""

import argparse
import datetime
import os
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np

from fmus.files import whole
from fmus.installation import missing_package
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.locked_folder import lock_with
from orchestrator.inputs.text.patterns import matching
from orchestrator.presentation.export.csv import add_run_arguments
from orchestrator.presentation.log.read_log import read_log
from orchestrator.simulation.cosim.recording import Recording

EXAMPLES = """examples:
  apa export mf4 runs/guo2015-case4/run.mcap

Modes carry a value-to-text conversion. Needs asammdf (LGPL): pip install 'apa-cosim[export]'
"""
UNITLESS = ("1",)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the format takes."""
    add_run_arguments(parser, ".mf4")


def run(arguments: argparse.Namespace) -> int:
    """Write the file. Returns 0."""
    out: Path = arguments.out or arguments.log.with_suffix(".mf4")
    if out.suffix != ".mf4":
        raise BadInput("the name of an MDF 4 file ends in .mf4", file=out)
    with lock_with(arguments.log, out):
        recording = read_log(arguments.log)
        write_mf4(out, recording, matching(recording.signals, arguments.signals))
    print(out)
    return 0


def write_mf4(path: Path, recording: Recording, names: list[str]) -> None:
    """Write the signals ``names``. Raises ``BadInput`` if asammdf is not installed."""
    try:
        from asammdf import MDF, Signal
    except ImportError:
        raise BadInput(missing_package("asammdf", "export")) from None
    parts = recording.parts()
    first = next(parts).recording
    wholes = {name for name in names if _is_whole(recording, name)}
    with (
        MDF(version="4.10") as file,
        open(os.devnull, "w") as nowhere,
        redirect_stdout(nowhere),
    ):  # asammdf prints rates
        file.start_time = datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC)
        comment = str(recording.info.get("scenario", {}).get("name", ""))
        signals = [_signal(Signal, first, name, name in wholes) for name in names]
        file.append(signals, acq_name="apa-cosim", comment=comment)
        for piece, _, _ in parts:
            values = [(_samples(piece, name, name in wholes), None) for name in names]
            file.extend(0, [(piece.t, None), *values])
        with whole(path) as part:
            file.save(part, overwrite=True)


def _is_whole(recording: Recording, name: str) -> bool:
    """Return whether a signal has whole numbers only."""
    if recording.variables[name].kind is float:
        return False
    return all(np.isfinite(part.signals[name]).all() for part, _, _ in recording.parts())


def _samples(recording: Recording, name: str, is_whole: bool) -> Any:
    values = recording.signals[name]
    return values.astype(np.int32) if is_whole else values


def _signal(kind: Any, recording: Recording, name: str, is_whole: bool) -> Any:
    variable, states = recording.variables[name], recording.states(name)
    unit = "" if variable.signal.unit in UNITLESS else variable.signal.unit
    conversion = _conversion(states) if states and is_whole else None
    samples = _samples(recording, name, is_whole)
    return kind(samples, recording.t, unit=unit, name=name, conversion=conversion, comment=variable.signal.text)


def _conversion(states: dict[int, str]) -> dict[str, Any]:
    """Return asammdf's form of a table from values to texts."""
    table: dict[str, Any] = {}
    for number, (value, text) in enumerate(states.items()):
        table[f"val_{number}"] = value
        table[f"text_{number}"] = text.encode()
    return table
