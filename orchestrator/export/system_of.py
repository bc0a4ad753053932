"""A scenario as a system for other tools: what can be told them, and what cannot."""

from collections.abc import Callable, Iterable
from pathlib import Path

from fmus.systems.system import Part, System
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.scenario import Scenario
from orchestrator.text.errors import BadInput


def system_of(scenario: Scenario, files: dict[str, Path]) -> System:
    """Return the system of ``scenario`` with the FMUs in ``files``.

    Raises ``BadInput`` if the scenario has what no such file can say: decimation or faults.
    """
    if any(every != 1 for every in scenario.every.values()):
        raise BadInput("a system file has one communication step for all; leave out", file=scenario.file, key="every")
    if scenario.system is not None:
        raise BadInput("exports are of our vehicle and controller; leave out", file=scenario.file, key="system")
    if scenario.faults:
        raise BadInput("faults live in apa's own master; leave them out to export", file=scenario.file, key="faults")
    parts = tuple(Part(name, model, files[name], getattr(scenario, name)) for name, model in MODELS.items())
    return System(parts, scenario.step, scenario.stop_time)


def fmus_for(kind: str, platforms: Iterable[str], say: Callable[[str], None]) -> dict[str, Path]:
    """Return the FMUs to pack: those of ``apa run``, or native ones built for other ``platforms``."""
    from orchestrator.cosim.fmu_files import build_into, fmu_files

    names = list(platforms)
    if kind != "native" or not names:
        return fmu_files(kind, say)
    from fmus.places import DIST

    say(f"building native FMUs for {', '.join(names)}")
    paths = {item.name: item.path for item in build_into(DIST / "platforms", kind, names)}
    return {name: paths[model.name] for name, model in MODELS.items()}
