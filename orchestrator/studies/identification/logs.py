"""Logs of drives as columns over time: CSV, MDF 4, and MCAP of ours or with protobuf or JSON messages."""

import gc
import logging
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fmus.installation import missing_package
from orchestrator.inputs.text.errors import BadInput, excerpt, lacks_resources, suggestion_or_choices, why_no_file
from orchestrator.inputs.text.quantities import unit_symbol
from orchestrator.inputs.text.table_file import TableError, read_table, unit_in_name
from orchestrator.presentation.log.read_log import read_info, read_log
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.system.units import UnfitUnitsError, conversion
from orchestrator.studies.identification.compiled_vehicle import SIGNALS
from orchestrator.studies.identification.signals import USED, MeasuredDrive, Series, drive_of
from orchestrator.testing.steptest.stimuli import StimulatedInput, column_values, table_times

MDF_SUFFIXES = (".mf4", ".mdf", ".dat")
MCAP_SUFFIX = ".mcap"
MAX_SAMPLES = 2_000_000
"""Of one signal."""


class Columns(NamedTuple):
    """Names and units of the columns as the user gives them, and the part of the log."""

    names: Mapping[str, str] = {}
    """Signal of the vehicle -> its column, where that has another name."""
    units: Mapping[str, str] = {}
    """Column -> its unit, where the log states none."""
    span: tuple[float, float] = (-np.inf, np.inf)
    """Part of the log that is used [s]."""


class Log(ABC):
    """A log with columns by name."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @abstractmethod
    def names(self) -> list[str]:
        """Return the names of its columns."""

    @abstractmethod
    def series(self, column: str, signal: str, unit: str | None) -> Series:
        """Return a column as the signal of the vehicle, in SI. Raises ``BadInput``."""

    def convert(self, values: Array, given: str | None, column: str, signal: str) -> Array:
        """Return values in the unit ``given`` (None: unknown) in that of the signal. Raises ``BadInput``."""
        variable = SIGNALS[signal]
        taken = variable.signal.unit
        hint = unit_in_name(column) if given is None and variable.kind is float else None
        if hint not in (None, taken):
            text = f"column {column} may be in {hint} by its name; write --unit '{column}={hint}' or '{column}={taken}'"
            raise BadInput(text, file=self.path)
        if given is None or variable.kind is not float:
            return values
        try:
            factor, offset = conversion(unit_symbol(given), taken, {}, {})
        except UnfitUnitsError:
            raise BadInput(f"column {column} is in {given}; expected {taken}", file=self.path) from None
        return values * factor + offset


class _CsvLog(Log):
    def __init__(self, path: Path) -> None:
        super().__init__(path)
        try:
            self._table = read_table(path)
        except TableError as error:
            raise BadInput(str(error), file=path) from None
        except OSError as error:
            raise BadInput(f"cannot be read: {error.strerror}", file=path) from error

    @cached_property
    def _times(self) -> Array:
        """Return the times of all rows [s]. Raises ``TableError``."""
        return np.array(table_times(self._table))

    def names(self) -> list[str]:
        return [head.name for place, head in enumerate(self._table.heads) if place != self._table.time]

    def series(self, column: str, signal: str, unit: str | None) -> Series:
        place = StimulatedInput(SIGNALS[signal], self.path, column)
        try:
            number = self._table.column(column)
            kept = [row for row, cells in enumerate(self._table.rows) if cells[number]]
            rows, lines = [self._table.rows[row] for row in kept], [self._table.lines[row] for row in kept]
            table = self._table._replace(rows=rows, lines=lines)
            if not kept:
                raise TableError(f"column {column} is empty")
            return Series(self._times[kept], np.array(column_values(table, number, place, unit)), column)
        except (TableError, UnfitUnitsError) as error:
            raise BadInput(str(error), file=self.path) from None


def _from_mdf(path: Path, read: Callable[[], Any]) -> Any:
    """Return what asammdf reads; it prints nothing of a damaged file, nor does what it leaves behind of one.

    Raises ``BadInput`` for whatever it raises.
    """
    logging.getLogger("asammdf").disabled = True
    before, sys.unraisablehook = sys.unraisablehook, lambda _: None
    try:
        try:
            return read()
        except MemoryError:
            raise
        except Exception as error:
            reason = f"is no MDF file ({type(error).__name__}: {excerpt(error)})"
        gc.collect()
        raise BadInput(reason, file=path)
    finally:
        sys.unraisablehook = before


class _MdfLog(Log):
    def __init__(self, path: Path) -> None:
        super().__init__(path)
        try:
            from asammdf import MDF
        except ImportError:
            raise BadInput(missing_package("asammdf", "export")) from None
        self._file = _from_mdf(path, lambda: MDF(path))
        self._names = [name for name in self._file.channels_db if name not in ("time", "t")]

    def names(self) -> list[str]:
        return self._names

    def series(self, column: str, signal: str, unit: str | None) -> Series:
        places = self._file.channels_db[column]
        if len(places) > 1:
            raise BadInput(f"has {len(places)} channels {column}: rename one of them", file=self.path)
        found = _from_mdf(self.path, lambda: self._file.get(column, raw=SIGNALS[signal].kind is not float))
        if found.samples.dtype.kind not in "fiub" or found.samples.ndim != 1:
            raise BadInput(f"channel {column} has no numbers", file=self.path)
        values = self.convert(found.samples.astype(np.float64), unit or found.unit or None, column, signal)
        return Series(found.timestamps.astype(np.float64), values, column)


class _OwnLog(Log):
    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self._recording = read_log(path)

    def names(self) -> list[str]:
        return list(self._recording.signals)

    def series(self, column: str, signal: str, unit: str | None) -> Series:
        given = unit or self._recording.variables[column].signal.unit
        values = self.convert(np.asarray(self._recording.signals[column]), given, column, signal)
        return Series(self._recording.t, values, column)


class _McapLog(Log):
    """Numbers of all messages as ``/topic.field``; orientations also as their yaw angle."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self._columns: dict[str, tuple[list[float], list[float]]] = {}
        try:
            self._read()
        except OSError as error:
            raise BadInput(f"cannot be read: {error.strerror}", file=path) from error
        except BadInput:
            raise
        except Exception as error:
            if lacks_resources(error):
                raise
            raise BadInput(f"is no MCAP file ({type(error).__name__}: {error})", file=path) from error

    def _read(self) -> None:
        import json

        from mcap.reader import make_reader
        from mcap_protobuf.decoder import DecoderFactory

        protobuf = DecoderFactory()
        with self.path.open("rb") as stream:
            for schema, channel, message in make_reader(stream).iter_messages():
                if channel.message_encoding == "json":
                    content: object = json.loads(message.data)
                else:
                    decode = protobuf.decoder_for(channel.message_encoding, schema)
                    if decode is None:
                        continue
                    content = decode(message.data)
                for name, value in _numbers(content, channel.topic):
                    times, values = self._columns.setdefault(name, ([], []))
                    times.append(message.log_time / 1e9)
                    values.append(value)

    def names(self) -> list[str]:
        return list(self._columns)

    def series(self, column: str, signal: str, unit: str | None) -> Series:
        times, values = self._columns[column]
        return Series(np.array(times), self.convert(np.array(values), unit, column, signal), column)


def read_drive(path: Path, columns: Columns) -> MeasuredDrive:
    """Return the drive in a log. Raises ``BadInput`` with the column and what would be right."""
    log = _open(path)
    known = log.names()
    units = {_column(name, known, "--unit", path): unit for name, unit in columns.units.items()}
    found = {}
    for signal in USED:
        column = _column_for(signal, known, columns, path)
        if column:
            found[signal] = _check_series(log.series(column, signal, units.get(column)), columns.span, path)
    if not found:
        shown = ", ".join(known[:12])
        raise BadInput(f"has no signal of the vehicle; name them: --column pose.x=COLUMN; it has {shown}", file=path)
    return drive_of(found, path)


def _open(path: Path) -> Log:
    if not path.is_file():
        raise BadInput(why_no_file(path), file=path)
    if path.suffix.lower() in MDF_SUFFIXES:
        return _MdfLog(path)
    if path.suffix.lower() != MCAP_SUFFIX:
        return _CsvLog(path)
    return _OwnLog(path) if read_info(path) else _McapLog(path)


def _column_for(signal: str, known: list[str], columns: Columns, path: Path) -> str:
    """Return the column of a signal: as the user names it, else the one of its name; empty without one."""
    if signal in columns.names:
        return _column(columns.names[signal], known, "--column", path)
    return next((name for name in (f"vehicle.{signal}", signal) if name in known), "")


def _column(name: str, known: list[str], key: str, path: Path) -> str:
    if name not in known:
        raise BadInput(f"has no column {name}{suggestion_or_choices(name, known)}", file=path, key=key)
    return name


def _check_series(series: Series, span: tuple[float, float], path: Path) -> Series:
    """Return the samples of the part that is used. Raises ``BadInput`` if they are no measurement."""
    t, values, column = series
    keep = (t >= span[0]) & (t <= span[1]) & np.isfinite(values)
    t, values = t[keep], values[keep]
    if len(t) < 2:
        raise BadInput(f"column {column} has {len(t)} samples there; expected two at least", file=path)
    if len(t) > MAX_SAMPLES:
        raise BadInput(f"column {column} has {len(t)} samples; use a part of it: --from S --to S", file=path)
    if not (np.diff(t) > 0.0).all():
        at = float(t[1:][np.diff(t) <= 0.0][0])
        raise BadInput(f"the times of column {column} do not rise at {at:g} s", file=path)
    return Series(t, values, column)


def _numbers(content: object, name: str) -> Iterator[tuple[str, float]]:
    """Yield the numbers of a message with their names, and the yaw angle of an orientation."""
    if isinstance(content, bool | int | float):
        yield name, float(content)
    elif isinstance(content, Mapping):
        parts = {str(key): value for key, value in content.items()}
        yield from _fields(parts, name)
    elif hasattr(content, "DESCRIPTOR"):
        message: Any = content
        yield from _fields({item.name: getattr(message, item.name) for item in message.DESCRIPTOR.fields}, name)


def _fields(parts: Mapping[str, object], name: str) -> Iterator[tuple[str, float]]:
    for key, value in parts.items():
        yield from _numbers(value, f"{name}.{key}")
    if parts.keys() == {"x", "y", "z", "w"}:
        x, y, z, w = (float(parts[key]) for key in ("x", "y", "z", "w"))  # type: ignore[arg-type]
        yield f"{name}.yaw", float(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))
