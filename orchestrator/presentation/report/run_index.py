"""The runs below a folder, read from the summary.json of each."""

import json
from pathlib import Path
from typing import Any

from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.readable import changes_text
from orchestrator.presentation.report.results import SUMMARY


def find_runs(folder: Path) -> list[dict[str, Any]]:
    """Return a row per run below ``folder``: time, scenario, overrides, outcome, reason, path, command; latest first.

    A folder whose summary.json cannot be read is left out. Raises ``BadInput`` if there is no such folder.
    """
    if not folder.is_dir():
        raise BadInput("no such folder", file=folder)
    rows = [row for file in sorted(folder.rglob(SUMMARY)) if (row := _row(file)) is not None]
    return sorted(rows, key=lambda row: str(row["time"]), reverse=True)


def _row(file: Path) -> dict[str, Any] | None:
    try:
        summary = json.loads(file.read_text(encoding="utf-8"))
        started = summary.get("started", {})
        return {
            "time": started.get("time", ""),
            "scenario": str(summary["scenario"]),
            "overrides": changes_text(dict(summary.get("overrides", {}))),
            "outcome": str(summary["outcome"]),
            "reason": str(summary["reason"]),
            "duration": float(summary["duration"]),
            "path": str(file.parent),
            "command": started.get("command", ""),
        }
    except (ValueError, KeyError, TypeError, AttributeError):
        return None
