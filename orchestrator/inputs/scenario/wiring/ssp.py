"""A system made elsewhere, an .ssp, as a part of a scenario, or as a scenario of its own."""

import hashlib
from pathlib import Path
from typing import Any

from fmus.files import write_whole
from fmus.systems.fmu_facts import BASE
from fmus.systems.read_ssp import SspError, SspSystem, as_written, fmu_in, read_ssp
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.text.errors import BadInput, excerpt

SUFFIX = ".ssp"
TARGET = tuple(f"target.{name}" for name in ("x", "y", "heading"))


def ssp_scenario(path: Path) -> dict[str, Any]:
    """Return what a scenario file would say of the .ssp at ``path``. Raises ``BadInput``.

    If its controller receives a target, as ours does, that is the scenario's; else the run has no task of ours.
    """
    system, content = _read(path), {"system": {"ssp": str(path)}}
    reported = system.parameters.get("controller", {})
    times = {"stop_time": system.stop, "step": system.step}
    made: dict[str, Any] = {**content, **{key: value for key, value in times.items() if value is not None}}
    if all(name in reported for name in TARGET) and "vehicle" in system.components:
        return {**made, "target": {name.partition(".")[2]: reported[name] for name in TARGET}}
    return {**made, "task": "open_loop", "requirements": []}


def ssp_system(path: Path) -> dict[str, Any]:
    """Return instances and connections of the .ssp at ``path``, its FMUs unpacked. Raises ``BadInput``."""
    from fmus.cache_paths import DIST

    system = _read(path)
    folder = DIST / "ssp" / hashlib.sha256(path.read_bytes()).hexdigest()[:24]
    instances: dict[str, Any] = {name: "none" for name in MODELS if name not in system.components}
    for name, source in system.components.items():
        file = folder / f"{name}.fmu"
        if not file.is_file():
            write_whole(file, _fmu(path, source))
        instances[name] = {
            "file": str(file),
            "parameters": system.parameters.get(name, {}),
            "units": system.units.get(name, {}),
        }
    values = {
        f"{owner}.{name}": {"value": text} for owner, given in system.inputs.items() for name, text in given.items()
    }
    return {
        "components": instances,
        "connections": {**as_written(system), **values},
        "by_name": False,
        "units": {
            name: {**dict(zip(BASE, scale.exponents, strict=True)), "factor": scale.factor, "offset": scale.offset}
            for name, scale in system.scales.items()
        },
        "ignored": system.ignored,
    }


def _read(path: Path) -> SspSystem:
    try:
        return read_ssp(path)
    except (SspError, ValueError) as error:
        raise BadInput(excerpt(error), file=path) from None


def _fmu(path: Path, source: str) -> bytes:
    try:
        return fmu_in(path, source)
    except SspError as error:
        raise BadInput(excerpt(error), file=path) from None
