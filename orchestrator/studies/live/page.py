"""The page that runs the models: one HTML file with the module, the scenarios and all scripts inside."""

import base64
import html
import re
import zlib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from fmus.files import write_whole
from fmus.native.web import charts_of, web_module
from modelkit.model import Model
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.drawing import palette
from orchestrator.presentation.report import page as report
from orchestrator.presentation.report.charts import charts_of_models
from orchestrator.presentation.report.payload import Arrays
from orchestrator.studies.live.model_description import models_data
from orchestrator.studies.live.situation import numbers_data, situation

if TYPE_CHECKING:
    from orchestrator.studies.live.map_code import MapCode

ROOM = Path(__file__).parent
FROM_REPORT = report.ROOM / "template"
CORE = ("shapes.js", "data.js", "engine.js", "situation.js", "verdict.js", "history.js", "lab.js")
"""What a worker needs too."""
OWN = (
    *("show.js", "scene.js", "scene_parts.js", "view.js", "tables.js"),
    *("stage.js", "driver.js", "drive.js", "whatif.js", "map.js", "chart.js", "guards.js", "result.js", "main.js"),
)
RUNS_MODULES = " 'wasm-unsafe-eval'; worker-src blob:"
NAME = "live.html"


def write_live(path: Path, scenarios: Sequence[Scenario], own_map: "MapCode | None" = None) -> None:
    """Write the page of ``scenarios``, the first one in hand. Raises ``RuntimeError`` where nothing can be compiled."""
    write_whole(path, live_page(scenarios, own_map))


def live_page(scenarios: Sequence[Scenario], own_map: "MapCode | None" = None) -> str:
    """Return the page. Raises ``BadInput`` for a limit of a signal that no model has, or controllers of two models.

    ``own_map``: code for its maps (see ``map_code``), which takes seconds to make; None: that of the complete models.
    """
    models = scenarios[0].models
    for scenario in scenarios:
        if scenario.models != models:
            raise BadInput(f"has another controller than {scenarios[0].name}: a page has one", file=scenario.name)
    core, own = scripts()
    script = f'(() => {{\n"use strict";\n{own}\n}})();\n'
    title = scenarios[0].title or scenarios[0].name
    parts = {
        "TITLE": html.escape(title),
        "POLICY": report.policy([core, script], RUNS_MODULES),
        "STYLE": report.style(_read("style.css")),
        "DATA": Arrays().pack(
            {
                **_models(tuple(models.items())),
                "scenarios": [situation(item) for item in scenarios],
                "mapped": own_map and own_map.data(),
                "runs": [],
            }
        ),
        "MODULE": _compress(web_module(models).read_bytes()),
        "MAPPED": _compress(b"" if own_map is None else own_map.module.read_bytes()),
        "CORE": core,
        "SCRIPT": script,
    }
    return re.sub(r"@([A-Z]+)@", lambda match: parts[match[1]], _read("page.html"))


@cache
def _models(models: tuple[tuple[str, Model], ...]) -> dict[str, Any]:
    """Return what is the same for all scenarios."""
    pins = yaml.safe_load((ROOM / "pins.yaml").read_text(encoding="utf-8"))
    own = charts_of(model for _, model in models)
    charts = [{**data, "place": own.index(chart)} for chart, data in charts_of_models([model for _, model in models])]
    return {"models": models_data(dict(models)), "numbers": numbers_data(), "charts": charts, "pins": pins}


def _compress(module: bytes) -> str:
    return base64.b64encode(zlib.compress(module)).decode()


def scripts() -> tuple[str, str]:
    """Return what a worker needs too, and the rest of the page's own scripts."""
    core, own = ("\n".join(_read(name) for name in names) for names in (CORE, OWN))
    return f'"use strict";\n{core}', palette.script() + own


def _read(name: str) -> str:
    own = ROOM / "template" / name
    return (own if own.exists() else FROM_REPORT / name).read_text(encoding="utf-8")
