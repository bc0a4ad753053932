"""A scenario: ground truth (target, slot, scene), models, faults, stop condition and requirements of a run."""

from collections.abc import Iterable
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from modelkit.model import Model
from orchestrator.inputs.scenario.end_condition import EndCondition
from orchestrator.inputs.scenario.fault import Fault
from orchestrator.inputs.scenario.models import MODELS, models_for
from orchestrator.inputs.scenario.pace import DEFAULTS, DURATION, UNLIMITED, stop_times
from orchestrator.inputs.scenario.requirements import Requirement, library_requirements
from orchestrator.inputs.scenario.slot_layout import SlotLayout
from orchestrator.inputs.scenario.wiring.system_text import SystemText
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.patterns import NAME
from orchestrator.inputs.text.quantities import NS_PER_SECOND, Metres, Radians, Seconds

Outcome = Literal["parked", "not_parked", "finished", "not_finished", "failed", "aborted"]
Task = Literal["park", "drive", "open_loop"]
SUCCESS: dict[Task, Outcome] = {"park": "parked", "drive": "finished", "open_loop": "finished"}
MISSED: dict[Task, Outcome] = {"park": "not_parked", "drive": "not_finished", "open_loop": "not_finished"}
DONE: frozenset[Outcome] = frozenset(SUCCESS.values())
"""Outcomes of a successful run."""


PENETRATION = "penetration"
"""Metric that the requirement on contact limits."""
CONTACT_FREE = "contact-free"
"""Shipped set that applies to every run."""
LEAST_CORNERS = 2
"""Minimum number of corners of a polygon; a wall has two."""
LONGEST_STEP = 10.0
"""Maximum communication step [s]."""
Parameter = float | int | bool | str
"""Value of a parameter in SI units, or a text."""
Name = Annotated[str, Field(pattern=NAME, max_length=100)]
"""A name, not a path."""


class _ScenarioPart(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Target(_ScenarioPart):
    """Required final pose of the vehicle, by the midpoint of its rear axle."""

    x: Metres
    """x of the rear-axle midpoint [m]."""
    y: Metres
    """y of the rear-axle midpoint [m]."""
    heading: Radians = 0.0
    """Heading of the vehicle [rad]."""

    @property
    def pose(self) -> tuple[float, float, float]:
        """Return (x [m], y [m], heading [rad])."""
        return self.x, self.y, self.heading


class Slot(_ScenarioPart):
    """The slot: a rectangle with its centre at (x, y) and its length along its heading."""

    x: Metres
    """x of the centre [m]."""
    y: Metres
    """y of the centre [m]."""
    heading: Radians = 0.0
    """Direction of the length [rad]."""
    length: Annotated[Metres, Field(gt=0.0)]
    """Size along the heading [m]."""
    width: Annotated[Metres, Field(gt=0.0)]
    """Size perpendicular to the heading [m]."""


class Scenario(_ScenarioPart):
    """A scenario after its ``extends``, its ``car`` and ``--set`` were merged; parameters by flat name, in SI units."""

    name: Name
    """Name of the run and of its folder; by default the name of the file."""
    title: str = ""
    """Title in tables and on pages, one line."""
    description: str = ""
    """Description of the manoeuvre, a few sentences."""
    source: str = ""
    """Paper or standard that defines the scenario."""
    extends: str | None = None
    """Shipped scenario, or file beside this one, whose keys apply unless this scenario has them."""
    car: str | None = None
    """Shipped car, file, or mapping with `extends` and changes; parameters `car.*` of vehicle and controller."""
    task: Task = "park"
    """Purpose of the run: `park`; `drive` along a road or out of a slot; `open_loop`: run to the stop time."""
    stop_time: Seconds | None = None
    """Latest end of the run [s]; by default 5 s after the time limit of the controller, ``limit.duration``."""
    step: Seconds = 0.01
    """Communication step [s], a whole number of nanoseconds."""
    decimation: dict[str, int] = {}
    """Decimation by component: the component is stepped at every n-th communication step."""
    seed: int = Field(default=1, ge=0, le=2**31 - 1)
    """Random seed of faults, and of every parameter named seed that the scenario does not set."""
    vehicle: dict[str, float | int | bool] = {}
    """Parameters of the vehicle, nested or by flat name, with or without unit."""
    controller: dict[str, float | int | bool] = {}
    """Parameters of the controller, written like those of the vehicle."""
    target: Target | None = None
    """Required final pose of the vehicle. The controller receives it unless `controller.target` gives another pose."""
    slot: Slot | None = None
    """True slot: its boundary limits the vehicle's outline. The key `scene` holds the obstacles around it."""
    slot_layout: SlotLayout | None = None
    """Generates `slot`, `target`, neighbours and kerb from a few dimensions."""
    system: SystemText | None = None
    """Components, connections and roles of a system that contains third-party FMUs."""
    obstacles: list[list[tuple[Metres, Metres]]] = []
    """Polygons, convex or not, as lists of corners [m]: a known map. The sensors do not measure them."""
    faults: list[Fault] = []
    """Disturbances of signals."""
    requirements: list[Requirement] = []
    """Requirements, and names of shipped sets of requirements; by default the set `project`."""
    contact_allowed: bool = False
    """If true, contact with an obstacle does not exclude the outcomes `parked` and `finished`."""
    stop_condition: EndCondition = EndCondition()
    """Condition that ends the run before its stop time."""
    expected_outcome: Outcome = "parked"
    """Outcome with which `apa test` passes; by default `parked`, or `finished` for the other tasks."""
    file: str = ""
    """Path of the scenario file, for messages."""
    unsupported_parameters: list[str] = []
    """Parameters that a third-party FMU lacks. They are not set in the FMU and stay part of the ground truth."""
    texts: dict[str, dict[str, str]] = {}
    """Text parameters of third-party FMUs that replace vehicle or controller."""
    overrides: dict[str, str] = {}
    """Changes by ``--set``, as written on the command line."""

    def parameters_for(self, instance: str) -> dict[str, Any]:
        """Return the parameters that are set in a component."""
        own = self.parameters_of(instance)
        return {name: value for name, value in own.items() if f"{instance}.{name}" not in self.unsupported_parameters}

    def parameters_of(self, instance: str) -> dict[str, Any]:
        """Return the parameters that the scenario has for a component."""
        entry = None if self.system is None else self.system.components.get(instance)
        own = {**getattr(self, instance), **self.texts.get(instance, {})} if instance in MODELS else {}
        return {**(entry.parameters if entry else {}), **own}

    def as_written(self) -> dict[str, Any]:
        """Return the content of an equal scenario file without ``extends`` and ``car``; paths of FMUs remain.

        What ``slot_layout`` generates stands in its place.
        """
        unwritten = {"file", "extends", "car", "slot_layout", "overrides", "unsupported_parameters", "texts"}
        content = self.model_dump(mode="python", exclude=unwritten, by_alias=True, exclude_none=True)
        for owner, texts in self.texts.items():
            content[owner] = {**content[owner], **texts}
        return content

    @property
    def places(self) -> list[str]:
        """Names of the components in the order of the system."""
        return list(MODELS) if self.system is None else self.system.places

    @property
    def models(self) -> dict[str, Model]:
        """Return the models that are run."""
        return models_for(self.controller)

    @property
    def step_ns(self) -> int:
        """Communication step [ns]."""
        return round(self.step * NS_PER_SECOND)

    @property
    def stop_ns(self) -> int:
        """Stop time [ns]; the last step is shorter if it is no whole number of steps."""
        return round(self.longest * NS_PER_SECOND)

    @property
    def longest(self) -> float:
        """Latest end of the run [s]: the stop time, or the controller's time limit at the speed of the driver."""
        if self.stop_time is not None:
            return self.stop_time
        given = {name: np.array([float(self.vehicle.get(name, start))]) for name, start in DEFAULTS.items()}
        return float(stop_times(given, np.array([float(self.controller.get(DURATION, UNLIMITED))]))[0])

    @property
    def success(self) -> Outcome:
        """Return the outcome of a successful run."""
        return SUCCESS[self.task]

    @model_validator(mode="after")
    def _times(self) -> "Scenario":
        exact = self.step * NS_PER_SECOND
        if exact < 1.0 or abs(exact - round(exact)) > 1e-6 * exact:
            raise BadInput(f"{self.step:g} s is not a whole positive number of nanoseconds", key="step")
        if self.step > LONGEST_STEP:
            raise BadInput(f"{self.step:g} s is more than {LONGEST_STEP:g} s", key="step")
        if self.stop_time is not None and not self.step <= self.stop_time <= 1e6:
            raise BadInput(f"{self.stop_time:g} s is not between one step and 1e6 s", key="stop_time")
        for name, decimation in self.decimation.items():
            if name not in self.places:
                raise BadInput(f"unknown; expected one of: {', '.join(self.places)}", key=f"decimation.{name}")
            if not 1 <= decimation <= 1_000_000:
                raise BadInput(f"{decimation} is not a whole number from 1 to 1000000", key=f"decimation.{name}")
            if decimation * self.step > LONGEST_STEP:
                text = f"{decimation} steps of {self.step:g} s are more than the {LONGEST_STEP:g} s of one step at most"
                raise BadInput(text, key=f"decimation.{name}")
        return self

    @model_validator(mode="after")
    def _polygons(self) -> "Scenario":
        for number, corners in enumerate(self.obstacles, start=1):
            if len(corners) < LEAST_CORNERS:
                text = f"{len(corners)} corners: expected {LEAST_CORNERS} or more"
                raise BadInput(text, key=f"obstacles[{number}]")
        return self

    @model_validator(mode="after")
    def _add_parked_requirements(self) -> "Scenario":
        """Add the shipped set `parked`, except requirements on metrics that the scenario limits itself."""
        named = {limit.signal for limit in self.requirements}
        missing = [item for item in library_requirements("parked") if item.signal not in named]
        if missing:
            self.requirements = [*self.requirements, *missing]
        return self

    @model_validator(mode="after")
    def _contact_free(self) -> "Scenario":
        """Add the requirement on contact; no other requirement replaces it."""
        self.requirements = self._and_contact_free(self.requirements)
        return self

    def _and_contact_free(self, limits: list[Requirement]) -> list[Requirement]:
        rule = self.contact_rule
        return [*(limit for limit in limits if limit.id != rule.id), rule]

    def with_requirements(self, limits: Iterable[Requirement]) -> "Scenario":
        """Return the scenario with other requirements; the requirement on contact stays."""
        return self.model_copy(update={"requirements": self._and_contact_free(list(limits))})

    @property
    def contact_rule(self) -> Requirement:
        """Return the requirement that the vehicle has no contact; not required if the scenario allows contact."""
        (rule,) = library_requirements(CONTACT_FREE)
        if not self.contact_allowed:
            return rule
        return rule.model_copy(update={"required": False, "source": "allowed: contact_allowed of the scenario"})

    @model_validator(mode="after")
    def _outcome(self) -> "Scenario":
        if "expected_outcome" not in self.model_fields_set:
            self.expected_outcome = SUCCESS[self.task]
        if self.expected_outcome not in (SUCCESS[self.task], MISSED[self.task], "failed", "aborted"):
            known = f"{SUCCESS[self.task]}, {MISSED[self.task]}, failed or aborted"
            raise BadInput(
                f"{self.expected_outcome!r} is no outcome of task {self.task}, expected {known}", key="expected_outcome"
            )
        return self
