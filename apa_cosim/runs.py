"""A scenario, driven or read back from its log."""

import html
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import yaml

from orchestrator.evaluation.verdict.logged_scenario import read_logged_scenario
from orchestrator.evaluation.verdict.summary import Summary, summarize
from orchestrator.inputs.scenario.load_scenario import scenario_names
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.read_log import log_file, read_info
from orchestrator.presentation.log.read_log import read_log as read_recording
from orchestrator.session.foreign import ImportedFmus, bind_parameters, fmu_of, load_bound_scenario, parameters_of
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.kinds import default_kind
from orchestrator.simulation.cosim.recording import Recording

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

__all__ = ["Run", "load_scenario", "read_log", "run", "scenario_names"]
Changes = Mapping[str, object]
"""Key -> value as in ``--set``: a number in SI units, a text with a unit, a truth value, a list or mapping."""
FRAME = '<iframe srcdoc="{page}" style="width: 100%; height: 44rem; border: 0" title="{title}"></iframe>'


@dataclass(frozen=True)
class Run:
    """One run: what was asked, all signals at all exchanges, and the verdict."""

    scenario: Scenario
    recording: Recording
    summary: Summary

    @property
    def outcome(self) -> str:
        """``parked``, ``finished``, ``not_parked``, ``not_finished``, ``failed`` or ``aborted``."""
        return self.summary.outcome

    @property
    def reason(self) -> str:
        """Why it came out so."""
        return self.summary.reason

    @property
    def t(self) -> Array:
        """Time of each exchange [s]."""
        return self.recording.t

    @property
    def signals(self) -> Mapping[str, Array]:
        """Name (``vehicle.pose.x``) -> values over :attr:`t`, SI units; modes as numbers."""
        return self.recording.signals

    def __getitem__(self, name: str) -> Array:
        """Return one signal. Raises ``KeyError`` with the names that come close."""
        try:
            return self.signals[name]
        except KeyError:
            from orchestrator.inputs.text.errors import suggestion

            raise KeyError(f"{name}: no such signal{suggestion(name, self.signals)}") from None

    def unit(self, name: str) -> str:
        """Return the SI unit of a signal; 1 for what has none."""
        return self.recording.variables[name].signal.unit

    def to_pandas(self) -> "pd.DataFrame":
        """Return all signals as columns over time [s]. Needs pandas."""
        import pandas as pd

        return pd.DataFrame(self.signals, index=pd.Index(self.t, name="t"))

    def plot(self) -> "Figure":
        """Return the picture of the run: top view, speed, position and heading over time, states."""
        from orchestrator.presentation.drawing.figure import overview
        from orchestrator.presentation.drawing.picture_data import overview_of

        return overview(overview_of(self.recording, self.summary, self.scenario))

    def save(self, folder: Path | str) -> Path:
        """Write ``report.html`` (the replay), ``overview.png`` and ``summary.json`` to a folder; return the replay.

        Raises ``BadInput`` if the folder has the log of another run: a folder is one run's.
        """
        from orchestrator.inputs.text.locked_folder import lock_folder
        from orchestrator.presentation.report.replay import write_replay
        from orchestrator.presentation.report.results import LOG, PAGE, write_picture, write_summary

        path = Path(folder)
        with lock_folder(path):
            if (path / LOG).is_file():
                self._refuse_another(path / LOG)
            write_summary(path, self.summary)
            write_picture(path, self.recording, self.summary, self.scenario)
            write_replay(path / PAGE, self.recording, self.summary, [])
        return path / PAGE

    def _refuse_another(self, log: Path) -> None:
        there, here = (json.dumps(info | {"end": None}, default=str) for info in (read_info(log), self.recording.info))
        if json.loads(there) != json.loads(here):
            raise BadInput("has the log of another run; save to a folder of its own", file=log.parent)

    def _repr_html_(self) -> str:
        """Return the replay for a notebook."""
        from orchestrator.presentation.report.replay import replay_page

        page = replay_page(self.recording, self.summary, [])
        return FRAME.format(page=html.escape(page, quote=True), title=html.escape(self.scenario.title))

    def __repr__(self) -> str:
        return f"<Run {self.scenario.name}: {self.outcome}, {self.summary.headline}; {self.summary.duration:g} s>"


def load_scenario(name: str | Path, changes: Changes | None = None) -> Scenario:
    """Return a shipped scenario by its name, or one of a YAML file, with some keys changed.

    Raises ``BadInput`` with file, key, value and what would be right.
    """
    return load_bound_scenario(str(name), _sets(changes), ImportedFmus()).scenario


def run(
    scenario: str | Path | Scenario,
    changes: Changes | None = None,
    *,
    fmus: str | None = None,
    log: Path | str | None = None,
    controller: Path | str | None = None,
    vehicle: Path | str | None = None,
) -> Run:
    """Return a scenario's run.

    ``fmus``: ``native``, ``python``, or ``none`` for the models in process; by default native where a C compiler is
    there. They are built if need be. ``log``: write an MCAP file here as well. ``controller``, ``vehicle``: a
    third-party FMU, or a model ``law.py:MODEL``, in the place of ours. Raises ``BadInput``.
    """
    given = ImportedFmus(
        {name: fmu_of(str(path)) for name, path in (("controller", controller), ("vehicle", vehicle)) if path}
    )
    chosen, foreign = with_foreign(scenario, changes, given)
    return Run(
        chosen, *record_scenario(chosen, fmus or default_kind(), foreign, Path(log) if log is not None else None)
    )


def record_scenario(
    scenario: Scenario, kind: str, foreign: ImportedFmus, log: Path | None = None
) -> tuple[Recording, Summary]:
    """Return what a scenario's run has recorded, and its verdict; FMUs of ``kind`` are built if need be."""
    files = {} if kind == "none" else fmu_files(kind)
    ran = run_scenario(scenario, files, kind=kind, log=log, foreign=foreign)
    return ran.recording, summarize(ran.recording, scenario, ran.wall_time)


def with_foreign(
    scenario: str | Path | Scenario, changes: Changes | None, given: ImportedFmus
) -> tuple[Scenario, ImportedFmus]:
    """Return a scenario, and the FMUs of others that it is run with: ``given`` ones and its own system's."""
    if not isinstance(scenario, Scenario):
        fitted = load_bound_scenario(str(scenario), _sets(changes), given)
        return fitted.scenario, fitted.foreign
    if changes:
        raise TypeError("changes are made when a scenario is loaded: load_scenario(name, changes)")
    given = given.with_system(scenario.system)
    own = {instance: parameters_of(path, instance) for instance, path in given.files.items()}
    return bind_parameters(scenario, own)[0], given


def read_log(path: Path | str) -> Run:
    """Return the run in a log of ours, or in a run's folder. Raises ``BadInput``."""
    file = log_file(str(path))
    recording = read_recording(file)
    scenario = read_logged_scenario(recording, str(file), file.stem)
    return Run(scenario, recording, summarize(recording, scenario, 0.0))


def _sets(changes: Changes | None) -> list[str]:
    return [f"{key}={_text(value)}" for key, value in (changes or {}).items()]


def _text(value: object) -> str:
    if isinstance(value, str):
        return value
    return str(yaml.safe_dump(value, default_flow_style=True, width=1_000_000)).removesuffix("...\n").strip()
