"""``apa export rerun``: a run for the Rerun viewer, with a blueprint. Needs rerun-sdk."""

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from fmus.files import write_whole
from fmus.installation import missing_package
from modelkit.variables import Variable
from orchestrator.evaluation.verdict.geometry import CarOutline, boxes, place, sample_path, slot_box, vehicle_parameters
from orchestrator.evaluation.verdict.logged_scenario import read_logged_scenario
from orchestrator.inputs.text.console import say
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.locked_folder import lock_with
from orchestrator.inputs.text.patterns import matching
from orchestrator.presentation.drawing.decimation import decimate
from orchestrator.presentation.drawing.panels import PANELS
from orchestrator.presentation.export.csv import add_run_arguments
from orchestrator.presentation.log.line import Line
from orchestrator.presentation.log.messages import read_messages
from orchestrator.presentation.log.read_log import read_log
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording

EXAMPLES = """examples:
  apa export rerun runs/guo2015-case4/run.mcap
  rerun runs/guo2015-case4/run.rrd

Shows the top view, the curves and the messages. Needs rerun-sdk: pip install 'apa-cosim[export]'
"""
POSES_PER_SECOND = 20.0
MAX_POSES = 20_000.0
"""Poses of the car in the top view."""
DRIVEN_RATE = 4.0
MAX_DRIVEN_PATHS, MAX_DRIVEN_POINTS = 2000.0, 1000
"""Times in a run at which the path driven so far is drawn, and the points of the longest."""
CURVE_RATE = 100.0
TIMELINE = "time"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the format takes."""
    add_run_arguments(parser, ".rrd")


def run(arguments: argparse.Namespace) -> int:
    """Write the file. Returns 0."""
    out: Path = arguments.out or arguments.log.with_suffix(".rrd")
    with lock_with(arguments.log, out):
        recording = read_log(arguments.log)
        names = matching(recording.signals, arguments.signals)
        if recording.is_stored:
            recording = decimate(recording)
            say(f"apa: note: a long run; {recording.count} of its instants are exported")
        write_rerun(out, recording, names, read_messages(arguments.log))
    print(out)
    return 0


def write_rerun(path: Path, recording: Recording, names: list[str], words: list[Line]) -> None:
    """Write curves, top view, messages and blueprint. Raises ``BadInput`` if rerun-sdk is not installed."""
    try:
        import rerun as rr
    except ImportError:
        raise BadInput(missing_package("rerun-sdk", "export")) from None
    name = str(recording.info.get("scenario", {}).get("name", path.stem))
    stream = rr.RecordingStream(f"apa-cosim {name}", recording_id=path.stem)
    stored = stream.memory_recording()  # rerun-sdk waits for ever where it cannot write to a file
    stream.send_blueprint(blueprint(recording), make_active=False, make_default=True)
    _still(rr, stream, recording)
    _moving(rr, stream, recording)
    for signal in names:
        _curve(rr, stream, recording, signal)
    for line in words:
        stream.set_time(TIMELINE, duration=line.t)
        stream.log("messages", rr.TextLog(f"{line.name}: {line.text}", level=_level(line.level)))
    stream.flush()
    write_whole(path, stored.drain_as_bytes())
    stream.disconnect()


def blueprint(recording: Recording) -> Any:
    """Return the arrangement of views: the scene beside the curves a person looks at first."""
    import rerun.blueprint as rrb

    views = []
    for panel in PANELS:
        known = [entity(name) for name in panel.page_signals() if name in recording.signals]
        if known:
            views.append(rrb.TimeSeriesView(name=panel.title, origin="/signals", contents=known))
    left = rrb.Vertical(rrb.Spatial2DView(name="Top view", origin="/scene"), rrb.TextLogView(origin="/messages"))
    left.row_shares = [3.0, 1.0]
    return rrb.Blueprint(rrb.Horizontal(left, rrb.Vertical(*views)), collapse_panels=True)


def entity(name: str) -> str:
    """Return where a signal is found: ``/signals/vehicle/pose/x``."""
    return "/signals/" + name.replace(".", "/").replace("[", "/").replace("]", "")


def _flat(points: Array) -> Array:
    """Return points with y down, as pictures have it."""
    flipped: Array = points * np.array([1.0, -1.0])
    return flipped


def _still(rr: Any, stream: Any, recording: Recording) -> None:
    scenario = read_logged_scenario(recording)
    if scenario.slot is not None:
        line = rr.LineStrips2D([_flat(slot_box(scenario.slot).outline())], colors=[[120, 160, 220]])
        stream.log("scene/slot", line, static=True)
    obstacles = [
        _flat(box.outline()) for box in boxes(vehicle_parameters(scenario, recording.parameters_of("vehicle")))
    ]
    if obstacles:
        stream.log("scene/obstacles", rr.LineStrips2D(obstacles, colors=[[130, 130, 130]]), static=True)
    if len(recording.t):
        path = sample_path(recording.values_at("controller", len(recording.t) - 1))
        if len(path):
            stream.log("scene/planned", rr.LineStrips2D([_flat(path)], colors=[[230, 130, 30]]), static=True)


def _moving(rr: Any, stream: Any, recording: Recording) -> None:
    pose = [recording.signals.get(f"vehicle.pose.{axis}") for axis in ("x", "y", "heading")]
    if any(values is None for values in pose):
        return
    x, y, heading = (np.asarray(values) for values in pose)
    car = CarOutline.of(recording.parameters_of("vehicle")).outline()
    duration = max(1.0, recording.duration)
    rows = _rows(recording.t, min(POSES_PER_SECOND, MAX_POSES / duration))
    for row in rows:
        if not np.isfinite(x[row] + y[row] + heading[row]):
            continue
        stream.set_time(TIMELINE, duration=float(recording.t[row]))
        outline = _flat(place(car, float(x[row]), float(y[row]), float(heading[row])))
        stream.log("scene/car", rr.LineStrips2D([outline], colors=[[40, 110, 230]]))
    points = rows[:: max(1, len(rows) // MAX_DRIVEN_POINTS)]
    for row in _rows(recording.t, min(DRIVEN_RATE, MAX_DRIVEN_PATHS / duration)):
        stream.set_time(TIMELINE, duration=float(recording.t[row]))
        done = np.append(points[points < row], row)
        path = _flat(np.column_stack([x[done], y[done]]))
        stream.log("scene/driven", rr.LineStrips2D([path[np.isfinite(path).all(axis=1)]], colors=[[40, 110, 230]]))


def _curve(rr: Any, stream: Any, recording: Recording, name: str) -> None:
    variable: Variable = recording.variables[name]
    rows = _rows(recording.t, CURVE_RATE)
    label = f"{name} [{variable.signal.unit}]"
    stream.log(entity(name), rr.SeriesLines(names=label), static=True)
    columns = rr.Scalars.columns(scalars=recording.signals[name][rows])
    stream.send_columns(entity(name), [rr.TimeColumn(TIMELINE, duration=recording.t[rows])], columns)
    states = recording.states(name)
    if states:
        changes = np.flatnonzero(np.diff(recording.signals[name], prepend=np.nan))
        for row in changes:
            stream.set_time(TIMELINE, duration=float(recording.t[row]))
            value = recording.signals[name][row]
            stream.log("messages", rr.TextLog(f"{name}: {states.get(value, value)}", level="TRACE"))


def _rows(t: Array, rate: float) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Return rows at most ``rate`` per second, with the last."""
    if not len(t):
        return np.empty(0, dtype=np.intp)
    wanted = np.arange(t[0], t[-1], 1.0 / rate)
    return np.unique(np.append(np.searchsorted(t, wanted - 1e-9), len(t) - 1))


def _level(level: str) -> str:
    return {"warning": "WARN", "error": "ERROR", "fatal": "CRITICAL", "debug": "DEBUG"}.get(level, "INFO")
