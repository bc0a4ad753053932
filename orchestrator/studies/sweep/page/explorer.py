"""What the page of a study needs to list the runs in a cell of its maps, and to replay any of them in the browser."""

import json
from typing import Any

import numpy as np

from orchestrator.inputs.scenario.models import MODELS, models_for
from orchestrator.inputs.scenario.scenario import DONE, Scenario
from orchestrator.studies.sweep.job import Job, chunk_scenario
from orchestrator.studies.sweep.page.statistics import (
    Map,
    axis,
    deciding_limit,
    default_axes,
    outcome_kind,
    reasons,
    value_text,
    varying_columns,
)
from orchestrator.studies.sweep.table import Table

MAX_ROWS, MAX_ROWS_OF_CELL = 4_000, 60
"""Runs that a page lists: in all, and of one cell."""
MAX_KEYS = 6
"""Parameters that a list of runs shows."""
TRUTH = ("target", "slot")


def explorer_data(table: Table, shown: list[Map], live: str) -> str:
    """Return the runs in the cells of the maps as JSON; ``live``: the page that replays them, if there is one."""
    cells = max(1, sum(int((item.runs > 0).sum()) for item in shown))
    most = max(1, min(MAX_ROWS_OF_CELL, MAX_ROWS // cells))
    chosen = _runs_of_maps(table, shown)
    listed = [_rows_of(item, mask, most) for item, mask in zip(shown, chosen, strict=True)]
    rows = sorted({row for cell in listed for found in cell.values() for row in found})
    keys = varying_columns(table)[:MAX_KEYS]
    columns = {name: table.column(name) for name in (table.ends, "duration", *keys)}
    columns["reason"] = reasons(table)
    data: dict[str, Any] = {
        "maps": [
            {
                "title": item.title,
                "edges": [_numbers(item.x.edges), _numbers(item.y.edges)],
                "labels": [item.x.labels, item.y.labels],
                "cells": {f"{place[0]},{place[1]}": found for place, found in cell.items()},
                "count": item.runs.tolist(),
            }
            for item, cell in zip(shown, listed, strict=True)
        ],
        "heads": [*keys, "deciding limit"],
        "rows": {row: _run_texts(table, columns, row, keys) for row in rows},
    }
    if live:
        data |= _replays(table, rows, live)
    return json.dumps(data, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def live_scenario(table: Table) -> Scenario | None:
    """Return the first run of a study as a scenario of the page that runs the models; None if such a page cannot.

    It cannot where FMUs, random faults, steps or the controller's model are the study's.
    """
    scenario = chunk_scenario(table.job, table.chunk(0), 0)
    if page_names(table.job) is None or scenario.system is not None or scenario.faults:
        return None
    column = "controller.system"
    systems = np.unique(table.column(column)).tolist() if column in table.job.keys else []
    if any(models_for({"system": int(value)}) != scenario.models for value in systems):
        return None
    return scenario.model_copy(update={"name": f"{table.about['study']['name']}-row"})


def page_names(job: Job) -> list[str] | None:
    """Return the name that each varied parameter has on the page that runs the models; None if one has none."""
    known = (*MODELS, *TRUTH)
    pairs = list(zip(job.owners, job.names, strict=True))
    return [f"{owner}.{name}" for owner, name in pairs] if all(owner in known for owner, _ in pairs) else None


def _runs_of_maps(table: Table, shown: list[Map]) -> list[Any]:
    """Return for each map which runs it has."""
    axes = default_axes(table)
    if axes is None or axes.split is None:
        return [np.ones(table.count, dtype=bool)] * len(shown)
    cell = axis(table, axes.split).cell
    return [cell == number for number in range(len(shown))]


def _rows_of(item: Map, chosen: Any, most: int) -> dict[tuple[int, int], list[int]]:
    """Return (row, column) of a cell -> its first runs."""
    found: dict[tuple[int, int], list[int]] = {}
    for number in np.flatnonzero(chosen):
        place = int(item.y.cell[number]), int(item.x.cell[number])
        rows = found.setdefault(place, [])
        if len(rows) < most:
            rows.append(int(number))
    return found


def _run_texts(table: Table, columns: dict[str, Any], row: int, keys: list[str]) -> list[str]:
    """Return outcome, its kind, reason, time [s], and the values of a run for people."""
    outcome = str(columns[table.ends][row])
    return [
        outcome.replace("_", " "),
        outcome_kind(outcome),
        str(columns["reason"][row]),
        f"{float(columns['duration'][row]):.1f} s",
        *(value_text(table, key, columns[key][row]) for key in keys),
        "" if outcome in DONE else deciding_limit(table, row),
    ]


def _numbers(values: Any) -> list[float]:
    return [float(value) for value in values]


def _replays(table: Table, rows: list[int], live: str) -> dict[str, Any]:
    """Return the page that replays runs, the parameters in its address, and their values in each run."""
    names = page_names(table.job) or []
    first = chunk_scenario(table.job, table.chunk(0), 0)
    seed = int(table.column("run_seed")[0])
    seeds = [
        f"{owner}.{name}"
        for owner in MODELS
        for name, value in first.parameters_of(owner).items()
        if name.rsplit(".", 1)[-1] == "seed" and value == seed and f"{owner}.{name}" not in names
    ]
    columns = [table.column(key) for key in table.job.keys]
    own = table.column("run_seed")
    return {
        "live": live,
        "scenario": f"{table.about['study']['name']}-row",
        "names": [*names, *seeds],
        "values": {row: [*(float(column[row]) for column in columns), *[int(own[row])] * len(seeds)] for row in rows},
    }
