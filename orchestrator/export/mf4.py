"""``apa export mf4``: a run as ASAM MDF 4, with units, comments and the names of states. Needs asammdf."""

import argparse
import datetime
from pathlib import Path
from typing import Any

import numpy as np

from fmus.files import whole
from fmus.installation import missing_package
from orchestrator.cosim.recording import Recording
from orchestrator.export.csv import add_run_arguments
from orchestrator.log.read_log import read_log
from orchestrator.text.errors import BadInput
from orchestrator.text.owned import owned_with
from orchestrator.text.patterns import matching

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
    with owned_with(arguments.log, out):
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
    signals = [_signal(Signal, recording, name) for name in names]
    with MDF(version="4.10") as file:
        file.start_time = datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC)
        file.append(signals, acq_name="apa-cosim", comment=str(recording.info.get("scenario", {}).get("name", "")))
        with whole(path) as part:
            file.save(part, overwrite=True)


def _signal(kind: Any, recording: Recording, name: str) -> Any:
    variable, values = recording.variables[name], recording.signals[name]
    states = recording.states(name)
    whole = variable.kind is not float and bool(np.isfinite(values).all())
    unit = "" if variable.signal.unit in UNITLESS else variable.signal.unit
    conversion = _conversion(states) if states and whole else None
    samples = values.astype(np.int32) if whole else values
    return kind(samples, recording.t, unit=unit, name=name, conversion=conversion, comment=variable.signal.text)


def _conversion(states: dict[int, str]) -> dict[str, Any]:
    """Return asammdf's form of a table from values to texts."""
    table: dict[str, Any] = {}
    for number, (value, text) in enumerate(states.items()):
        table[f"val_{number}"] = value
        table[f"text_{number}"] = text.encode()
    return table
