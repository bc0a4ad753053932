"""The parking system as the studies drive it: its number, and the signals of which they keep something."""

from collections.abc import Mapping

from controller_fmu.parking.chart import ParkingState
from controller_fmu.parking.params import ParkingSystem
from orchestrator.evaluation.verdict.measures import Instants, Measure

APA_SYSTEM = int(ParkingSystem.APA)
"""Value of ``controller.system``."""
PARKING_TIME = "controller.apa.parking_time"
"""Since the driver confirmed [s]."""
SHOWN = Instants("controller.apa.state", (int(ParkingState.CONFIRMING),))
"""The instants at which the vehicle stands and the slot detected is shown."""
SHOWN_SLOT = {
    "a.x": "controller.apa.slot.ax",
    "a.y": "controller.apa.slot.ay",
    "b.x": "controller.apa.slot.bx",
    "b.y": "controller.apa.slot.by",
    "kind": "controller.apa.slot.type",
}
"""Column -> signal of the slot shown: its type, corners A and B in the odometry frame."""
PLAN = {
    "plans": "controller.apa.plans",
    "margin": "controller.apa.margin",
    "layout": "controller.apa.slot.type",
    "depth": "controller.apa.slot.depth",
    "ax": "controller.apa.slot.ax",
    "ay": "controller.apa.slot.ay",
    "target_x": "controller.apa.goal.x",
    "target_y": "controller.apa.goal.y",
}
"""Column -> signal of plan, goal and slot, as they are at the end."""


def plan_measures() -> dict[str, Measure]:
    """Return the columns of plan, goal and slot at the end of a run."""
    return {name: Measure("last", signal) for name, signal in PLAN.items()}


def display_measures(signals: Mapping[str, str]) -> dict[str, Measure]:
    """Return the columns ``shown.*``: ``signals``, and the slot, when the slot is shown first."""
    shown = {f"shown.{name}": signal for name, signal in SHOWN_SLOT.items()}
    return {name: Measure("first", signal, SHOWN) for name, signal in {**signals, **shown}.items()}
