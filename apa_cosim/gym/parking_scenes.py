"""The scenes of the registered environments: a slot between two parked cars, undisturbed or as in the study apa-world.

The road runs along x, slots on the right have y < 0; corner A of the slot is the origin. All that is drawn, and how far
it may go, is said by factors.
"""

from collections.abc import Mapping

import numpy as np

from apa_cosim.gym.scene_source import SampledScenes, Seeds
from controller_fmu.policy.params import PolicySystem
from orchestrator.inputs.scenario.requirements import library_requirements
from orchestrator.inputs.scenario.scenario import Scenario, Slot, Target
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.cases import BODIES
from orchestrator.studies.parking.cases import KINDS as KIND_NAMES
from orchestrator.studies.parking.study import GBT_SETS
from orchestrator.studies.parking.world.factors import FACTORS, NEIGHBOURS, SLOT
from orchestrator.studies.parking.world.scene import KINDS, parameters
from orchestrator.studies.parking.world.study import limits_beside_neighbours
from orchestrator.studies.parking.world.study import scenario as world_scenario
from orchestrator.studies.sweep.study.space import Factor

PARALLEL, PERPENDICULAR = 0, 1
"""Choices of the factor ``kind``."""
START = (
    Factor("ahead", "m", -1.0, 1.5, 4.0, "rear axle at the start, ahead of the slot's front end"),
    Factor("beside", "m", 0.9, 1.2, 1.6, "distance to the neighbours at the start"),
    Factor("start_heading", "deg", -6.0, 0.0, 6.0, "at the start, positive away from the slot"),
)
DRAWN = ("car", "side", "extra", "behind", "depth", "kerb_height")


def slot_scenes(kind: int, body: str, stop_time: float, pedals: bool = False) -> SampledScenes:
    """Return scenes in which the car stands ahead of a slot of ``kind``, with ideal sensors and odometry."""
    factors = [*(factor for factor in SLOT if factor.name in DRAWN), *NEIGHBOURS, *START]
    fixed = {"kind": float(kind), "body": _choice(body)}
    return SampledScenes(_with_pedals(slot_scenario(kind, stop_time), pedals), factors, fixed, _near_the_slot)


def world_scenes(body: str | None, stop_time: float, pedals: bool = False) -> SampledScenes:
    """Return the scenes of the study apa-world: all is disturbed, the car starts before the row; ``body``: None: drawn.

    Slots are of both kinds, judged by GB/T 41630 for parallel slots as in the study.
    """
    scenario = world_scenario(int(PolicySystem.POLICY)).model_copy(update={"name": "world", "stop_time": stop_time})
    drawn = [factor for factor in FACTORS if body is None or factor.name != "body"]
    fixed = {} if body is None else {"body": _choice(body)}
    return SampledScenes(_with_pedals(scenario, pedals), drawn, fixed, parameters)


def slot_scenario(kind: int, stop_time: float) -> Scenario:
    """Return what all scenes of a kind share."""
    number = KINDS[kind]
    return Scenario(
        name=KIND_NAMES[number],
        stop_time=stop_time,
        vehicle={"odometry.ideal": False},
        controller={"system": int(PolicySystem.POLICY)},
        target=Target(x=0.0, y=0.0),
        slot=Slot(x=0.0, y=0.0, length=1.0, width=1.0),
        requirements=[*limits_beside_neighbours(GBT_SETS[number]), *library_requirements("no-contact")],
    )


def _choice(body: str) -> float:
    """Return the value of the factor ``body`` for equations of motion."""
    return float(BODIES.index(body))


def _with_pedals(scenario: Scenario, pedals: bool) -> Scenario:
    """Return a scenario whose policy requests speeds, or treads the pedals."""
    return scenario.model_copy(update={"controller": {**scenario.controller, "action.pedals": pedals}})


def _near_the_slot(f: Mapping[str, Array], seeds: Seeds) -> dict[str, Array]:
    """Return the columns of scenes whose car starts beside the road's edge ahead of the slot."""
    found = {name: values for name, values in parameters(f, seeds).items() if not name.startswith("faults[")}
    sign = 1.0 - 2.0 * f["side"]
    length = np.where(f["kind"] == PARALLEL, found["slot.length"], found["slot.width"])
    found["vehicle.start.x"] = length + f["ahead"]
    found["vehicle.start.heading"] = sign * np.radians(f["start_heading"])
    return found
