"""The folder that one run writes to: never one with another run in it, unless the user asks for that."""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path

from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.locked_folder import lock_folder
from orchestrator.presentation.report.results import LOG, SUMMARY

RUNS = Path("runs")
"""Where runs go by default, below the current folder."""


@contextmanager
def run_folder(chosen: Path | None, name: str, *, force: bool) -> Iterator[Path]:
    """Hold a folder for a run of the scenario ``name`` and give its path.

    By default ``runs/NAME``, or the first free one of ``runs/NAME-2``, ``runs/NAME-3``, ... A folder that the user has
    ``chosen`` must be without a run. ``force`` replaces what is there. Raises ``BadInput``.
    """
    if chosen is not None or force:
        folder = chosen or RUNS / name
        with lock_folder(folder):
            if has_run(folder) and not force:
                raise BadInput("has a run already; choose another --out, or replace it with --force", file=folder)
            yield folder
        return
    for number in count(1):
        folder = RUNS / name if number == 1 else RUNS / f"{name}-{number}"
        if has_run(folder):
            continue
        with lock_folder(folder):
            if not has_run(folder):
                yield folder
                return


def has_run(folder: Path) -> bool:
    """Return whether a folder has a log, also of an interrupted run, or a summary."""
    return any((folder / name).is_file() for name in (LOG, f"{LOG}.part", SUMMARY))
