"""The systems that studies of parking can drive: the parameters each has for the same task, and where each reports.

A study is written for one system and says which others can drive it. A scenario keeps its rows: the vehicle, the scene
and the errors are the same for all, so that two systems are compared in pairs.
"""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from controller_fmu.apa.chart import Mode
from controller_fmu.parking.chart import ParkingState
from modelkit.variables import variables
from orchestrator.evaluation.verdict.measures import Instants, Measure
from orchestrator.inputs.scenario.models import models_for
from orchestrator.inputs.scenario.requirements import Requirement
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput

APA_SYSTEM, PARKING_SYSTEM = 5, 8
"""Values of ``controller.system``."""
NO_SIGNALS: Mapping[str, str] = MappingProxyType({})


class StudiedSystem(NamedTuple):
    """What a study must know of a system."""

    searching: Mapping[str, float | bool] = MappingProxyType({})
    """Parameters with which it searches slots as the others do by default."""
    shown: Instants | None = None
    """The instants at which the vehicle stands and the slot detected is shown."""
    shown_slot: Mapping[str, str] = NO_SIGNALS
    """Column -> signal of the slot shown: its type, corners A and B in the odometry frame, and the row's heading if
    there is a signal of it."""
    plan: Mapping[str, str] = NO_SIGNALS
    """Column -> signal of plan, goal and slot, as they are at the end."""
    parking_time: str = ""
    """Signal: since the driver confirmed [s]."""


SYSTEMS: Mapping[int, StudiedSystem] = {
    APA_SYSTEM: StudiedSystem(
        shown=Instants("controller.apa.mode", (int(Mode.PARKING_SPACE_APPEARS),)),
        shown_slot={
            "a.x": "controller.apa.slot.a.x",
            "a.y": "controller.apa.slot.a.y",
            "b.x": "controller.apa.corner_b.x",
            "b.y": "controller.apa.corner_b.y",
            "heading": "controller.apa.slot.a.heading",
            "kind": "controller.apa.slot.kind",
        },
        parking_time="controller.apa.parking_time",
    ),
    PARKING_SYSTEM: StudiedSystem(
        shown=Instants("controller.parking.state", (int(ParkingState.CONFIRMING),)),
        shown_slot={
            "a.x": "controller.parking.slot.ax",
            "a.y": "controller.parking.slot.ay",
            "b.x": "controller.parking.slot.bx",
            "b.y": "controller.parking.slot.by",
            "kind": "controller.parking.slot.type",
        },
        plan={
            "plans": "controller.parking.plans",
            "margin": "controller.parking.margin",
            "layout": "controller.parking.slot.type",
            "depth": "controller.parking.slot.depth",
            "ax": "controller.parking.slot.ax",
            "ay": "controller.parking.slot.ay",
            "target_x": "controller.parking.goal.x",
            "target_y": "controller.parking.goal.y",
        },
        parking_time="controller.parking.parking_time",
    ),
}


def check_system(name: str, system: int, possible: tuple[int, ...]) -> None:
    """Raise ``BadInput`` if ``system`` cannot drive the study ``name``."""
    if system not in possible:
        choices = " or ".join(map(str, possible))
        raise BadInput(f"{system} cannot drive {name}: expected {choices}", file="--set", key="system")


def study_name(name: str, system: int, own: int) -> str:
    """Return the name of a study and of its table, driven by ``system`` instead of its ``own``."""
    return name if system == own else f"{name}-{system}"


def with_system(scenario: Scenario, system: int) -> Scenario:
    """Return a scenario driven by ``system``: parameters that it does not have are left out.

    Raises ``BadInput`` if the map is too large.
    """
    own = scenario.controller
    if own["system"] == system:
        return scenario
    known = {item.name for item in variables(models_for({"system": system})["controller"].params)}
    if any(name.startswith("map[") and name not in known for name in own):
        room = sum(name.startswith("map[") for name in known) // 3
        raise BadInput(f"the map of system {system} holds {room} corners only", file=scenario.file, key="obstacles")
    kept = {name: value for name, value in own.items() if name in known}
    return scenario.model_copy(update={"controller": {**kept, "system": system}})


def system_requirements(requirements: Sequence[Requirement], system: int) -> list[Requirement]:
    """Return requirements of the assist, the parking time among them measured where ``system`` reports it."""
    own, other = SYSTEMS[APA_SYSTEM].parking_time, SYSTEMS[system].parking_time
    return [
        item.model_copy(update={"signal": other}) if item.signal == own and other else item for item in requirements
    ]


def plan_measures(system: int) -> dict[str, Measure]:
    """Return the columns of plan, goal and slot at the end of a run, as far as the system reports them."""
    return {name: Measure("last", signal) for name, signal in SYSTEMS[system].plan.items()}


def display_measures(signals: Mapping[str, str], system: int) -> dict[str, Measure]:
    """Return the columns ``shown.*``: ``signals``, and the slot, when the slot is shown first."""
    shown = {f"shown.{name}": signal for name, signal in SYSTEMS[system].shown_slot.items()}
    return {name: Measure("first", signal, SYSTEMS[system].shown) for name, signal in {**signals, **shown}.items()}
