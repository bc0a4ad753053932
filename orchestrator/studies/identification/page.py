"""The page of an identification: log and model in one replay, residuals as curves, the parameters above."""

from pathlib import Path
from typing import Any

import numpy as np

from fmus.files import write_whole
from modelkit.signal import Signal
from modelkit.variables import Variable
from orchestrator.presentation.report.page import page
from orchestrator.presentation.report.payload import Arrays
from orchestrator.presentation.report.plots import plot_of, plots_of, words_of
from orchestrator.presentation.report.replay import KEYS, page_of_limited_size
from orchestrator.presentation.report.run_data import ribbons_of, run_data
from orchestrator.presentation.report.still import origin_of
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.studies.identification.compiled_vehicle import OUTPUTS, PARAMETERS, SIGNALS
from orchestrator.studies.identification.frames import FrameFit
from orchestrator.studies.identification.result import Identification, interval_text, notes, sentence, value_text
from orchestrator.studies.identification.signals import FRAMES, unit_of

PREFIX = "vehicle."
RESIDUAL = "residual."
MAX_INSTANTS = 20_000
"""Of a page, before it is thinned."""


def write_identification_page(path: Path, found: Identification, title: str) -> None:
    """Write the page; fewer instants are kept if it would pass 1 MB."""
    measured, model = _recordings(found, title)
    write_whole(path, page_of_limited_size(lambda most: _page(found, measured, model, title, most)))


def _page(found: Identification, measured: Recording, model: Recording, title: str, most: int) -> str:
    arrays, origin, runs = Arrays(), origin_of(measured), []
    for run, label, about in ((measured, "A", "A: log"), (model, "B", "B: model")):
        shown = run_data(run, arrays, [], label=label, most=most, keep=[], origin=origin)
        runs.append({**shown, "checks": [], "about": about})
    missing = [name for item in found.identifiability.undetermined for name in item.names]
    rows = {item.candidate.name: item for item in found.parameters}
    header = {
        "title": title,
        "name": title,
        "subtitle": "A: log \u00b7 B: model, its path aligned with the log once; residuals: aligned window by window",
        "verdict": {
            "text": f"{len(rows) - len(missing)} of {len(rows)} identified",
            "kind": "warn" if missing else "good",
        },
        "facts": [
            *(
                [name, f"{value_text(item)}{_unit(item.unit)} ({interval_text(item)})"]
                for name, item in rows.items()
                if item.identified
            ),
            *(["Not identified", sentence(item)] for item in found.identifiability.undetermined),
            *(["Note", line] for line in notes(found)),
        ],
        "plots": [*plots_of([measured, model], [], []), *_residual_plots(model)],
        "ribbons": ribbons_of([measured, model], 2),
        "changes": [
            [name, f"{item.candidate.start:g}", f"{value_text(item)}" if item.identified else "\u2013"]
            for name, item in rows.items()
        ],
        "runs": runs,
        "foot": f"Parameters: start of the search, then identified value. {KEYS}",
    }
    return page(title, arrays.pack(header))


def _residual_plots(model: Recording) -> list[dict[str, Any]]:
    """Return the plots of the residuals: one for signals of one unit, poses apart from each other."""
    groups: dict[tuple[str, str], list[str]] = {}
    for name in model.signals:
        if name.startswith(RESIDUAL):
            unit = model.variables[name].signal.unit
            groups.setdefault((name.rpartition(".")[0], unit), []).append(name)
    return [
        plot_of(f"Residual: {', '.join(map(words_of, names))}", unit, 0.0, names, [])
        for (_, unit), names in groups.items()
    ]


def _unit(unit: str) -> str:
    return "" if unit == "1" else f" {unit}"


def _recordings(found: Identification, title: str) -> tuple[Recording, Recording]:
    """Return log and model at common instants."""
    problem, estimate = found.problem, found.estimate
    drive = problem.drive
    longest = max(drive.compared.values(), key=lambda item: len(item.t))
    t = longest.t if len(longest.t) <= MAX_INSTANTS else np.linspace(0.0, drive.duration, MAX_INSTANTS)
    measured = {name: np.interp(t, item.t, item.values) for name, item in {**drive.followed, **drive.compared}.items()}
    requests = {name: item.sample_and_hold(t) for name, item in drive.inputs.items()}
    simulated = problem.simulation(estimate.theta)
    ours = {name: np.interp(t, simulated.t, simulated.rows[:, OUTPUTS[name]]) for name in measured}
    for frame in drive.frames:
        ours |= _place_on_log(found, frame, t)
    residuals = {
        name: np.interp(t, drive.compared[name].t, values)
        for name, values in problem.residuals(estimate.theta, estimate.noise).items()
    }
    info = {"scenario": {"name": "identified", "title": title}}
    names = {**measured, **requests}
    variables = {f"{PREFIX}{name}": SIGNALS[name] for name in names}
    variables |= {f"{PREFIX}{name}": item for name, item in PARAMETERS.items()}
    variables |= {
        f"{RESIDUAL}{name}": Variable(name, float, Signal(unit_of(name), f"model minus log: {name}"), 0.0)
        for name in residuals
    }
    t_ns = np.rint(t * 1e9).astype(np.int64)
    both = {f"{PREFIX}{name}": values for name, values in requests.items()}
    log = {f"{PREFIX}{name}": values for name, values in measured.items()}
    model = {f"{PREFIX}{name}": values for name, values in ours.items()}
    model |= {f"{RESIDUAL}{name}": values for name, values in residuals.items()}
    starts = problem.known | {item.name: item.start for item in problem.candidates}
    parameters = [
        {f"{PREFIX}{name}": value for name, value in group.items()} for group in (starts, starts | found.values)
    ]
    return (
        Recording(t_ns, both | log, parameters[0], variables, info),
        Recording(t_ns, both | model, parameters[1], variables, info),
    )


def _place_on_log(found: Identification, frame: str, t: Array) -> dict[str, Array]:
    """Return a pose of the model with one shift and turn for the whole drive."""
    drive = found.problem.drive
    names = [name for name in FRAMES[frame] if name in drive.compared]
    windows = {name: np.zeros(len(drive.compared[name].t), dtype=np.intp) for name in names}
    fit = FrameFit(frame, drive, windows, 1)
    columns = tuple(OUTPUTS[name] for name in FRAMES[frame])
    moved = fit.place(found.problem.simulation(found.estimate.theta), columns, found.estimate.noise)
    return {name: np.interp(t, drive.compared[name].t, values) for name, values in moved.items()}
