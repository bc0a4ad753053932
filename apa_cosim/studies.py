"""Studies of many runs, as tables."""

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from apa_cosim.runs import Run, run
from orchestrator.commands.sweep import select_study
from orchestrator.inputs.text.errors import RunError, suggestion
from orchestrator.inputs.text.locked_folder import lock_folder
from orchestrator.simulation.cosim.kinds import fastest_kind
from orchestrator.studies.sweep.repeat import write_scenario
from orchestrator.studies.sweep.sweep import Options
from orchestrator.studies.sweep.sweep import sweep as run_study
from orchestrator.studies.sweep.table import Table

if TYPE_CHECKING:
    import pandas as pd


class StudyTable:
    """A row for each run: what was varied, outcome, reason, final errors, measures; SI units."""

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        self._table = Table(self.path)

    def __len__(self) -> int:
        return self._table.count

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return self._table.names()

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return one column. Raises ``KeyError`` with the names that come close."""
        if name not in self.columns:
            raise KeyError(f"{name}: no such column{suggestion(name, self.columns)}")
        return np.asarray(self._table.column(name))

    def share(self, outcome: str = "parked") -> float:
        """Return the share of the runs that ended so, by the study's own judgement where it has one."""
        return float(np.mean(self[self._table.ends] == outcome))

    def to_pandas(self) -> "pd.DataFrame":
        """Return the whole table. Needs pandas."""
        import pandas as pd

        return pd.DataFrame({name: self[name] for name in self.columns})

    def replay(self, row: int) -> Run:
        """Return one row's run again, with all signals: the same bits. Raises ``BadInput`` for a row it has not."""
        with tempfile.TemporaryDirectory() as folder:
            scenario = write_scenario(self._table, row, Path(folder) / "scenario.yaml")
        return run(scenario, fmus=fastest_kind())

    def __repr__(self) -> str:
        return f"<StudyTable {self.path}: {len(self)} runs>"


def sweep(
    study: str | Path,
    changes: Mapping[str, object] | None = None,
    *,
    folder: Path | str | None = None,
    first: int = 0,
    every: int = 1,
    resume: bool = False,
) -> StudyTable:
    """Return the table of a study, shipped or of a YAML file, run on all cores.

    ``folder``: where the table goes (``runs/NAME``). ``every``: only each so-manieth run, beginning at ``first``.
    ``resume``: go on with an interrupted one. Raises ``BadInput``; ``RunError`` if it was interrupted;
    ``NotRunError`` if runs could not take place.
    """
    sets = [f"{key}={value}" for key, value in (changes or {}).items()]
    chosen = select_study(str(study), sets)
    chosen = chosen._replace(design=chosen.design.part(first, every))
    out = Path(folder) if folder is not None else Path("runs") / chosen.name
    with lock_folder(out):
        swept = run_study(chosen, out, Options(resume=resume))
    if swept.not_run is not None:
        raise swept.not_run
    if swept.table is None:
        raise RunError(f"{chosen.name}: interrupted after {swept.done} of {swept.count} runs; go on with resume=True")
    return StudyTable(swept.table)


def read_table(path: Path | str) -> StudyTable:
    """Return the table of a study that was run before. Raises ``BadInput``."""
    return StudyTable(path)
