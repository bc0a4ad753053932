"""The page of an FMU, documentation/index.html, made from the types of its model."""

from html import escape

from fmus.contents.arrays import FmiArray, alone, visible_arrays
from fmus.contents.description import project_version
from fmus.contents.units import unit
from fmus.contents.variables import describe, limits, visible_variables
from modelkit.model import Model

STYLE = """
body { font: 15px/1.5 sans-serif; max-width: 72em; margin: 2em auto; padding: 0 1em; color: #222 }
table { border-collapse: collapse; margin: 1em 0 } td, th { border: 1px solid #ccc; text-align: left }
td, th { padding: .2em .6em }
th { background: #f2f2ef } td.n { text-align: right; font-family: monospace } td.v { font-family: monospace }
"""
COLUMNS = ("name", "reference", "type", "variability", "unit", "shown in", "start", "min", "max", "meaning")
USE = """
<h2>Time</h2>
<p>The default communication step is {step:g} s. Any step is allowed, also a changing one; times are rounded to whole
nanoseconds. Inputs are held over a step. If the model is sampled, it keeps its own sample time whatever the
communication step. No output depends on an input of the same instant.</p>
<h2>Connecting</h2>
<p>Connect every output to the input of the same name. {types}</p>
<ol>
<li>Instantiate; set parameters. Once Initialization Mode is left, those are fixed that are not marked tunable; a
tunable one may be set between two steps and holds from the next step on.</li>
<li>Enter Initialization Mode; read all outputs, which are valid here, and write them to the inputs.</li>
<li>Leave Initialization Mode. For each step k: all doStep at k h; then read all outputs, then write all inputs.</li>
</ol>
<h2>When something is wrong</h2>
<p>A bad input shows as a status in the outputs. A wrong call and an exception are logged (switch logging on).
FMU state can be saved, restored and serialized; a restored instance continues to the same bits.</p>
"""


TYPES = {
    2: "All connected signals are Real, Integer or Boolean, in SI units; tuples are written out as "
    "<code>name[1]</code>, <code>name[2]</code>.",
    3: "All connected signals are Float64, Int32, Boolean or an Enumeration, in SI units; tuples are arrays. "
    "Terminals of the same name belong together.",
}


def index_page(model: Model, needs: str, fmi: int = 2) -> bytes:
    """Return the page; ``needs`` is HTML that says what the host must have."""
    known = visible_arrays(model) if fmi == 3 else [alone(item) for item in visible_variables(model)]
    parts = [
        f"<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><title>{escape(model.name)}</title>",
        f"<style>{STYLE}</style></head><body>",
        f"<h1>{escape(model.name)}</h1>\n<p>{escape(model.description)}. FMI {fmi}.0 for Co-Simulation, from apa-cosim "
        f"{project_version()}, MIT licence.</p>",
        f"<h2>What it needs</h2>{needs}",
        USE.format(step=model.step_size, types=TYPES[fmi]),
        *(_table(title, [item for item in known if item.first.causality == kind], fmi) for title, kind in TABLES),
        "</body></html>\n",
    ]
    return "\n".join(parts).encode()


TABLES = (
    ("Inputs", "input"),
    ("Outputs", "output"),
    ("Parameters", "parameter"),
    ("Local variables, for logs and judges", "local"),
)


def _table(title: str, items: list[FmiArray], fmi: int) -> str:
    if not items:
        return ""
    head = "".join(f"<th>{column}</th>" for column in COLUMNS)
    rows = "\n".join(_row(item, fmi) for item in items)
    return f"<h2>{title}</h2>\n<table>\n<tr>{head}</tr>\n{rows}\n</table>"


def _row(item: FmiArray, fmi: int) -> str:
    first = item.first
    real = first.kind is float
    shown = (unit(first.signal.unit).display or "") if real else ""
    kind = item.fmi_type if fmi == 3 else first.fmi_type
    size = "".join(f"[{count}]" for count in item.shape)
    cells = [
        f"<td class='v'>{escape(item.name)}{size}</td><td class='n'>{item.vr}</td><td>{kind}</td>",
        f"<td>{first.variability}</td>",
        f"<td>{escape(first.signal.unit) if real else ''}</td><td>{escape(shown)}</td>",
        f"<td class='n'>{', '.join(map(_number, item.starts))}</td>",
        *(f"<td class='n'>{'' if number is None else _number(number)}</td>" for number in limits(first)),
        f"<td>{escape(describe(first))}</td>",
    ]
    return f"<tr>{''.join(cells)}</tr>"


def _number(value: float | int | bool) -> str:
    return str(value).lower() if isinstance(value, bool) else f"{value:.10g}"
