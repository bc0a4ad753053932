"""Writes docs/reference from the types, the charts' tables, the scenarios and the command line.

Nothing in docs/reference is written by hand; ``make docs`` runs this before the site is built.
"""

import importlib
import inspect
import os
import pkgutil
import re
import sys
from collections.abc import Iterator
from enum import IntEnum
from pathlib import Path
from types import ModuleType
from typing import Any

ROOT = Path(__file__).parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "docs")]


from equations import equations  # noqa: E402
from pydantic import BaseModel  # noqa: E402

import controller_fmu  # noqa: E402
from benchmarks.results import read_table  # noqa: E402
from fmus.native.web import can_build  # noqa: E402
from modelkit.model import Model  # noqa: E402
from modelkit.states import parts_of  # noqa: E402
from modelkit.variables import Variable, variables  # noqa: E402
from orchestrator.cli import parser  # noqa: E402
from orchestrator.evaluation.verdict.judge import Check  # noqa: E402
from orchestrator.evaluation.verdict.limit_text import requirement_text  # noqa: E402
from orchestrator.evaluation.verdict.summary import Event, Final, FmuUsed, Summary  # noqa: E402
from orchestrator.inputs.scenario.catalogue import collapse_arrays, range_text, start_text, texts_of  # noqa: E402
from orchestrator.inputs.scenario.end_condition import EndCondition  # noqa: E402
from orchestrator.inputs.scenario.fault import Fault  # noqa: E402
from orchestrator.inputs.scenario.files import LIBRARY  # noqa: E402
from orchestrator.inputs.scenario.load_scenario import NOT_WRITTEN, load_scenario, scenario_names  # noqa: E402
from orchestrator.inputs.scenario.models import APART, MODELS, apart_models  # noqa: E402
from orchestrator.inputs.scenario.requirements import Occasion, Requirement, Window, read_requirements  # noqa: E402
from orchestrator.inputs.scenario.scenario import Scenario, Slot, Target  # noqa: E402
from orchestrator.inputs.scenario.slot_layout import LayoutKerb, LayoutOrigin, Neighbours, SlotLayout  # noqa: E402
from orchestrator.inputs.text.command_parser import CommandParser  # noqa: E402
from orchestrator.presentation.drawing.chart_svg import chart_svg  # noqa: E402
from orchestrator.studies.live.map_code import map_code  # noqa: E402
from orchestrator.studies.live.page import NAME as LIVE  # noqa: E402
from orchestrator.studies.live.page import write_live  # noqa: E402
from orchestrator.studies.live.situation import page_scenarios  # noqa: E402
from orchestrator.studies.papers.figure_files import gallery_text  # noqa: E402
from orchestrator.studies.papers.paper_figures import FIGURES  # noqa: E402
from orchestrator.studies.parking.parking_world.factors import FACTORS as PARKING_WORLD  # noqa: E402
from orchestrator.studies.parking.world.factors import FACTORS as APA_WORLD  # noqa: E402
from orchestrator.studies.sweep.study.space import Factor  # noqa: E402

MADE = "<!-- Made by docs/generate.py; do not edit. -->\n"


def main() -> None:
    """Write all reference pages."""
    folder = ROOT / "docs" / "reference"
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in pages().items():
        (folder / name).write_text(MADE + text, encoding="utf-8")
        print(folder.relative_to(ROOT) / name)
    if can_build():
        for system in ("", *APART):
            page = folder / (f"live-{system}.html" if system else LIVE)
            scenarios = page_scenarios(system)
            if scenarios:
                write_live(page, scenarios, map_code(scenarios))
                print(page.relative_to(ROOT))


def pages() -> dict[str, str]:
    """Return name -> text of all reference pages."""
    return {
        **{f"{name}.md": model_page(model) for name, model in MODELS.items()},
        **{f"{name}.md": model_page(model) for name, model in apart_models().items()},
        "charts.md": charts_page(),
        "commands.md": commands_page(),
        "scenarios.md": scenarios_page(),
        "files.md": files_page(),
        "equations.md": equations_page(),
        "benchmarks.md": benchmarks_page(),
        "figures.md": figures_page(),
    }


def equations_page() -> str:
    """Return the equations of the papers with the files that implement them, read from the docstrings."""
    rows = [[f"{item.paper} ({item.number})", item.where, item.text] for item in equations(ROOT)]
    head = "# Equations\n\nEquations of the papers and the files that implement them. Misprints: the papers' pages.\n\n"
    return head + table(["equation", "file", "function"], rows)


def figures_page() -> str:
    """Return every figure of the papers with its counterpart, or the reason that there is none."""
    parts = ["# Figures of the papers\n", "Written by `apa reproduce PAPER --figures FOLDER`.\n"]
    for paper in dict.fromkeys(item.paper for item in FIGURES):
        figures = [item for item in FIGURES if item.paper == paper]
        parts.append(f"## {paper}\n\n{gallery_text(figures, '../images/papers/')}")
    return "\n".join(parts)


def benchmarks_page() -> str:
    """Return the latest results of the benchmarks with machine, date and commit."""
    head = "`make bench` measures speed and writes `benchmarks/results.tsv`, which this page shows."
    parts = [f"# Benchmarks\n\n{head}\n"]
    parts.append("On a busy machine it records processor times only.\n")
    rows = read_table()
    for benchmark in sorted({row.benchmark for row in rows}):
        found = [row for row in rows if row.benchmark == benchmark]
        stamps = sorted({f"{row.machine}; {row.date}, commit {row.commit}" for row in found})
        parts.append(f"## {benchmark}\n\n`python -m benchmarks {benchmark}`: {'; '.join(stamps)}\n")
        parts.append(table(["quantity", "value", "unit"], [[row.quantity, row.value, row.unit] for row in found]))
    return "\n".join(parts)


def model_page(model: Model) -> str:
    """Return the page of a model package: inputs, outputs, parameters, modes."""
    parts = [f"# {model.name} FMU\n\n{model.description}\n"]
    parts.append(f"Communication step by default {model.step_size:g} s, stop time {model.stop_time:g} s.\n")
    groups = {"Inputs": model.inputs, "Outputs": model.outputs, "Parameters": model.params}
    for title, cls in groups.items():
        parts.append(f"## {title}\n")
        for head, found in grouped(variables(cls)):
            parts.append((f"### {head}\n\n" if head else "") + signal_table(found, title == "Parameters"))
    enums = {item.signal.states for cls in groups.values() for item in variables(cls) if item.signal.states}
    for enum in sorted(enums, key=lambda item: item.__name__):
        parts.append(f"## {enum.__name__}\n\n{(enum.__doc__ or '').strip()}\n\n{state_table(enum)}")
    return "\n".join(parts)


def grouped(items: list[Variable]) -> Iterator[tuple[str, list[Variable]]]:
    """Return variables by the first part of their name; those of one part come first, under no name."""
    groups: dict[str, list[Variable]] = {"": []}
    for item in items:
        first = re.split(r"[.\[]", item.name)[0]
        groups.setdefault(first if first != item.name else "", []).append(item)
    return ((head, found) for head, found in groups.items() if found)


def signal_table(items: list[Variable], starts: bool) -> str:
    """Return a table of variables; array elements that differ only in their number share a row."""
    head = ["name", "unit", "meaning"] + (["default", "range", "source"] if starts else ["type"])
    rows = []
    for item, count in collapse_arrays(items):
        signal = item.signal
        text = signal.text + (
            f" ([{signal.states.__name__}](#{signal.states.__name__.lower()}))" if signal.states else ""
        )
        name = f"`{item.name}`" + (f" to `[{count}]`" if count > 1 else "")
        more = [start_text(item), range_text(item), signal.source] if starts else [item.kind.__name__]
        rows.append([name, "" if signal.unit == "1" else signal.unit, text, *more])
    return table(head, rows)


def state_table(enum: type[IntEnum]) -> str:
    """Return a table of the states of a mode; of a union of modes, with the origin and meaning of each state."""
    if parts_of(enum) == (enum,):
        return table(["value", "name"], [[str(int(member)), member.name] for member in enum])
    rows = []
    for member in enum:
        for part in parts_of(enum):
            text = texts_of(part).get(member.name)
            if text:
                rows.append([str(int(member)), member.name, part.__module__.split(".")[-2], text])
    return table(["value", "name", "in", "meaning"], rows)


def charts_page() -> str:
    """Return diagrams of all charts, drawn from the tables that the controller runs."""
    parts = ["# Charts\n\nDrawn from the transition tables that the controller runs; earlier rows have priority.\n"]
    for module in chart_modules():
        states, guards = enums_of(module)
        summary = (module.__doc__ or module.__name__).strip().splitlines()[0]
        rows = [[label(states, row[0]), guards(row[1]).name, label(states, row[2])] for row in module.TRANSITIONS]
        arcs = [(source, target, guard.lower().replace("_", " ")) for source, guard, target in rows]
        parts.append(f"## {module.__name__}\n\n{summary}\n\n{chart_svg(arcs, [item.name for item in states])}\n")
        parts.append(table(["from", "when", "to"], rows))
        parts.append(f"As Mermaid source:\n\n{mermaid(module, states, guards)}")
    return "\n".join(parts)


def chart_modules() -> list[ModuleType]:
    """Return the controller's modules that hold a transition table."""
    names = [item.name for item in pkgutil.walk_packages(controller_fmu.__path__, "controller_fmu.")]
    modules = [importlib.import_module(name) for name in sorted(names)]
    return [module for module in modules if hasattr(module, "TRANSITIONS") and hasattr(module, "Guard")]


def enums_of(module: ModuleType) -> tuple[type[IntEnum], type[IntEnum]]:
    """Return (states, guards) of a chart: the states are the enum that has all targets as members."""
    targets = {row[2] for row in module.TRANSITIONS}
    guards: type[IntEnum] = vars(module).get("Guard") or module.Condition
    for value in vars(module).values():
        if isinstance(value, type) and issubclass(value, IntEnum) and value not in (IntEnum, guards):
            if targets <= {int(member) for member in value}:
                return value, guards
    raise LookupError(f"{module.__name__}: no enum has all states of its chart")


def label(states: type[IntEnum], value: int) -> str:
    """Return the name of a state; values that are none mean any."""
    return states(value).name if value in {int(member) for member in states} else "any state"


def mermaid(module: ModuleType, states: type[IntEnum], guards: type[IntEnum]) -> str:
    """Return the chart as a Mermaid diagram; rows from any state start at one node."""
    lines = ["```text", "stateDiagram-v2"]
    for row in module.TRANSITIONS:
        source = label(states, row[0]).replace(" ", "_")
        lines.append(f"    {source} --> {label(states, row[2])}: {guards(row[1]).name.lower().replace('_', ' ')}")
    return "\n".join([*lines, "```", ""])


def commands_page() -> str:
    """Return the help of every command."""
    os.environ["COLUMNS"] = "100"
    top = parser()
    parts = [f"# Commands\n\n```text\n{top.format_help()}```\n"]
    for name, sub in subcommands(top):
        parts.append(f"## apa {name}\n\n```text\n{sub.format_help()}```\n")
    return "\n".join(parts)


def subcommands(top: CommandParser, prefix: str = "") -> Iterator[tuple[str, CommandParser]]:
    """Return (name, parser) of all commands and their sub-commands."""
    for name, sub in top.subcommands():
        yield f"{prefix}{name}", sub
        yield from subcommands(sub, f"{prefix}{name} ")


def scenarios_page() -> str:
    """Return the shipped scenarios, cars, sets of limits, and the factors of the studies that disturb everything."""
    shipped = [load_scenario(name) for name in scenario_names()]
    rows = [[f"`{item.name}`", item.title, item.expected_outcome.replace("_", " "), item.source] for item in shipped]
    parts = ["# Scenarios, cars, limits\n\n## Scenarios\n", table(["name", "title", "expected", "source"], rows)]
    cars = sorted(path.stem for path in (LIBRARY / "cars").glob("*.yaml"))
    parts.append("## Cars\n\n" + "\n".join(f"- `{name}`" for name in cars) + "\n")
    for path in sorted((LIBRARY / "requirements").glob("*.yaml")):
        rows = [[item.id, f"`{item.signal}`", requirement_text(item), item.source] for item in read_requirements(path)]
        parts.append(f"## Limits: {path.stem}\n\n{table(['id', 'signal', 'limit', 'source'], rows)}")
    for name, factors in {"apa-world": APA_WORLD, "parking-world": PARKING_WORLD}.items():
        rows = [factor_row(factor) for factor in factors]
        parts.append(f"## Factors of the study {name}\n\n{table(['factor', 'range', 'nominal', 'meaning'], rows)}")
    return "\n".join(parts)


def factor_row(factor: Factor) -> list[str]:
    """Return name, range or choices, nominal value and meaning of a factor."""
    if factor.choices:
        counts = {word: factor.choices.count(word) for word in factor.choices}
        words = (word if count == 1 else f"{count} x {word}" for word, count in counts.items())
        return [f"`{factor.name}`", ", ".join(words), factor.choices[int(factor.nominal)], factor.text]
    unit = "" if factor.unit == "1" else f" {factor.unit}"
    return [f"`{factor.name}`", f"{factor.low:g} to {factor.high:g}{unit}", f"{factor.nominal:g}", factor.text]


def files_page() -> str:
    """Return the keys of scenarios, requirements and summary.json."""
    parts = ["# Files\n"]
    written: dict[str, type[BaseModel]] = {
        "Scenario (YAML)": Scenario,
        "Target": Target,
        "Slot": Slot,
        "Slot layout": SlotLayout,
        "Slot layout: origin": LayoutOrigin,
        "Slot layout: neighbours": Neighbours,
        "Slot layout: kerb": LayoutKerb,
        "Stop condition": EndCondition,
        "Fault": Fault,
        "Requirement (YAML)": Requirement,
        "Window": Window,
        "Occasion": Occasion,
    }
    for title, model in written.items():
        rows = [[*row[:3], row[3].replace("``", "`")] for row in key_rows(model)]
        parts.append(f"## {title}\n\n{about(model)}\n\n{table(['key', 'type', 'default', 'meaning'], rows)}")
    shown: dict[str, type[BaseModel]] = {
        "summary.json": Summary,
        "final": Final,
        "events": Event,
        "checks": Check,
        "fmus": FmuUsed,
    }
    for title, model in shown.items():
        rows = [[row[0], row[1], row[3].replace("``", "`")] for row in key_rows(model)]
        parts.append(f"## {title}\n\n{about(model)}\n\n{table(['key', 'type', 'meaning'], rows)}")
    return "\n".join(parts)


def about(model: type[BaseModel]) -> str:
    """Return the docstring of a class."""
    return (inspect.getdoc(model) or "").replace("``", "`")


def key_rows(model: type[BaseModel]) -> list[list[str]]:
    """Return (key, type, default, meaning) of the keys of a file."""
    texts, unwritten = texts_of(model), NOT_WRITTEN if model is Scenario else ()
    names = {item.alias: name for name, item in model.model_fields.items() if item.alias}
    rows = []
    for name, item in model.model_json_schema()["properties"].items():
        if name in unwritten:
            continue
        field = names.get(name, name)
        default = item.get("default", "-" if model.model_fields[field].is_required() else "")
        shown = (
            ""
            if default in (None, "", []) or isinstance(default, dict)
            else f"`{default}`"
            if default != "-"
            else "required"
        )
        rows.append([f"`{name.rstrip('_')}`", type_text(item), shown, texts.get(field, "")])
    if model is Scenario:
        meaning = "obstacles that the sensors measure: `boxes` and `kerbs`, with the parameters `vehicle.scene.*`"
        rows.insert([row[0] for row in rows].index("`slot`") + 1, ["`scene`", "object", "", meaning])
        next(row for row in rows if row[0] == "`car`")[1] = "string or object"
    return rows


def type_text(item: dict[str, Any]) -> str:
    """Return the JSON type of a schema entry."""
    if "$ref" in item:
        return str(item["$ref"]).rsplit("/", 1)[-1]
    if "anyOf" in item:
        return " or ".join(dict.fromkeys(type_text(part) for part in item["anyOf"] if part.get("type") != "null"))
    if item.get("type") == "array":
        return f"list of {type_text(item.get('items', {}))}"
    if "enum" in item:
        return " or ".join(str(value) for value in item["enum"])
    return str(item.get("type", "object"))


def table(head: list[str], rows: list[list[str]]) -> str:
    """Return a Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines) + "\n"


if __name__ == "__main__":
    main()
