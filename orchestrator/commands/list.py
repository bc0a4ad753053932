"""``apa list``: what is there to run, to set, to look at and to judge by."""

import argparse
import ast
import json
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from rich.markup import escape
from rich.table import Table

from orchestrator.commands import STUDIES
from orchestrator.evaluation.verdict.limit_text import requirement_text
from orchestrator.inputs.scenario.catalogue import Entry, entries, match_entries, range_text, start_text, systems
from orchestrator.inputs.scenario.files import LIBRARY, car_names, library_names
from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.inputs.scenario.requirements import read_requirements
from orchestrator.inputs.text.console import console
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.yaml_file import read_mapping

EXAMPLES = """examples:
  apa list                             scenarios, controllers, cars, requirements, studies
  apa list parameters steering         parameters with this word in their name or meaning
  apa list parameters "controller.guo2015.*"
  apa list signals odometry --json
  apa list requirements gbt41630
  apa list runs                        runs in runs/, the latest first: time, scenario, changes, outcome
  apa list runs results --page         the same as a page, results/index.html
"""
KINDS = ("scenarios", "parameters", "signals", "controllers", "cars", "requirements", "studies", "runs")
Rows = list[dict[str, Any]]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("what", nargs="?", choices=KINDS, metavar="WHAT", help=f"one of {', '.join(KINDS)}")
    parser.add_argument(
        "pattern",
        nargs="?",
        metavar="PATTERN",
        help="a word, or a pattern such as vehicle.pose.*; for runs: their folder",
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--page", action="store_true", help="for runs: write FOLDER/index.html")


def run(arguments: argparse.Namespace) -> int:
    """Print names and what they mean. Returns 0; raises ``BadInput`` if nothing fits."""
    if arguments.what is None:
        return _overview(arguments.json)
    if arguments.page and arguments.what != "runs":
        raise BadInput("only runs have a page; write: apa list runs [FOLDER] --page", key="--page")
    heads, rows = LISTS[arguments.what](arguments.pattern)
    if arguments.page:
        from orchestrator.presentation.report.runs_page import write_runs_page

        print(write_runs_page(Path(arguments.pattern or RUNS), rows))
        return 0
    if arguments.pattern and not rows and arguments.what != "runs":
        raise BadInput(f"no {arguments.what} match", key=arguments.pattern)
    if arguments.json:
        print(json.dumps(rows, indent=2))
    else:
        _print(heads, rows)
    return 0


def _study_names() -> list[str]:
    return sorted([*library_names("studies"), *STUDIES])


def _overview(as_json: bool) -> int:
    heads, scenarios = _scenarios(None)
    names = {"cars": car_names(), "requirements": _requirement_sets(), "studies": _study_names()}
    if as_json:
        print(json.dumps({"scenarios": scenarios, "controllers": systems(), **names}, indent=2))
        return 0
    _print(heads, scenarios)
    out = console()
    print()
    _print(*_controllers(None))
    out.print(f"\ncars (--set car=NAME): {', '.join(names['cars'])}")
    out.print(f"requirements (apa list requirements): {', '.join(names['requirements'])}")
    out.print(f"studies (apa sweep NAME): {', '.join(names['studies'])}")
    out.print("parameters and signals: apa list parameters PATTERN, apa list signals PATTERN", markup=False)
    return 0


def _scenarios(pattern: str | None) -> tuple[dict[str, str], Rows]:
    found = [load_scenario(name) for name in scenario_names()]
    rows = [
        {"name": item.name, "title": item.title, "expected_outcome": item.expected_outcome, "file": item.file}
        for item in found
    ]
    heads = {"name": "scenario", "expected_outcome": "expected outcome", "title": "title"}
    return heads, [row for row in rows if _has(pattern, row["name"], row["title"])]


def _controllers(pattern: str | None) -> tuple[dict[str, str], Rows]:
    rows = [{"name": name, "text": text} for name, text in systems().items()]
    heads = {"name": "controller (--set controller.system=NAME)", "text": "meaning"}
    return heads, [row for row in rows if _has(pattern, row["name"], row["text"])]


def _cars(pattern: str | None) -> tuple[dict[str, str], Rows]:
    return _titles(car_names(), "cars", "car (--set car=NAME)", pattern)


def _studies(pattern: str | None) -> tuple[dict[str, str], Rows]:
    return _titles(_study_names(), "studies", "study (apa sweep NAME)", pattern)


def _titles(names: list[str], folder: str, head: str, pattern: str | None) -> tuple[dict[str, str], Rows]:
    """Return names with their titles, from a file of the library or the first line of the study's module."""
    rows = []
    for name in names:
        file = LIBRARY / folder / f"{name}.yaml"
        title = str(read_mapping(file).get("title", "")) if file.is_file() else _first_line(STUDIES[name])
        if _has(pattern, name, title):
            rows.append({"name": name, "title": title})
    return {"name": head, "title": "title"}, rows


def _first_line(module: str) -> str:
    """Return the first line of a module's docstring, without its import."""
    spec = find_spec(module)
    assert spec is not None
    assert spec.origin is not None
    text = ast.get_docstring(ast.parse(Path(spec.origin).read_text(encoding="utf-8"))) or ""
    return text.partition("\n")[0].rstrip(".")


def _requirements(pattern: str | None) -> tuple[dict[str, str], Rows]:
    heads = {"set": "set", "id": "id", "signal": "signal", "required": "required", "source": "source"}
    rows = []
    for name in _requirement_sets():
        for item in read_requirements(LIBRARY / "requirements" / f"{name}.yaml"):
            if _has(pattern, name, item.id, item.signal):
                rows.append(
                    {
                        "set": name,
                        "id": item.id,
                        "signal": item.signal,
                        "required": requirement_text(item),
                        "source": item.source,
                    }
                )
    return heads, rows


def _runs(folder: str | None) -> tuple[dict[str, str], Rows]:
    from orchestrator.presentation.report.run_index import find_runs

    heads = {"time": "time", "scenario": "scenario", "overrides": "overrides", "outcome": "outcome", "path": "path"}
    return heads, find_runs(Path(folder or RUNS))


def _variables(*roles: str) -> Any:
    def table_of(pattern: str | None) -> tuple[dict[str, str], Rows]:
        found = match_entries(entries(*roles), pattern)
        rows = [_row(item) for item in found]
        values = {"default": "default", "range": "range"} if "parameter" in roles else {"role": "role"}
        return {"name": "name", **values, "unit": "unit", "text": "meaning"}, rows

    return table_of


def _row(item: Entry) -> dict[str, Any]:
    plain = item.plain()
    allowed = range_text(item.variable) or ", ".join(plain["states"])
    return {**plain, "default": start_text(item.variable), "range": allowed}


LISTS = {
    "scenarios": _scenarios,
    "parameters": _variables("parameter"),
    "signals": _variables("output", "input"),
    "controllers": _controllers,
    "cars": _cars,
    "requirements": _requirements,
    "studies": _studies,
    "runs": _runs,
}
RUNS = "runs"
"""Where runs are unless a folder is named."""


def _requirement_sets() -> list[str]:
    return sorted(path.stem for path in (LIBRARY / "requirements").glob("*.yaml"))


def _has(pattern: str | None, *texts: str) -> bool:
    return pattern is None or any(pattern.lower().strip("*") in text.lower() for text in texts)


def _print(heads: dict[str, str], rows: Rows) -> None:
    table = Table(box=None, pad_edge=False)
    for key, head in heads.items():
        table.add_column(escape(head), no_wrap=key not in ("title", "text", "range", "overrides"), overflow="fold")
    for row in rows:
        many = f" to [{row['elements']}]" if row.get("elements", 1) > 1 else ""
        table.add_row(*(escape(f"{row[key]}{many if key == 'name' else ''}") for key in heads))
    console().print(table)
