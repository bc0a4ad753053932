"""A scenario: what is true (target, slot, scene), what drives, what ends a run, and what it is judged by."""

from collections.abc import Iterable
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from modelkit.model import Model
from orchestrator.scenario.end_condition import EndCondition
from orchestrator.scenario.fault import Fault
from orchestrator.scenario.models import MODELS, models_for
from orchestrator.scenario.pace import DEFAULTS, DURATION, UNLIMITED, stop_times
from orchestrator.scenario.requirements import Requirement, shipped_requirements
from orchestrator.scenario.slot_layout import SlotLayout
from orchestrator.scenario.wiring.system_text import SystemText
from orchestrator.text.errors import BadInput
from orchestrator.text.patterns import NAME
from orchestrator.text.quantities import NS_PER_SECOND, Metres, Radians, Seconds

Outcome = Literal["parked", "not_parked", "finished", "not_finished", "failed", "aborted"]
Task = Literal["park", "drive", "open_loop"]
SUCCESS: dict[Task, Outcome] = {"park": "parked", "drive": "finished", "open_loop": "finished"}
MISSED: dict[Task, Outcome] = {"park": "not_parked", "drive": "not_finished", "open_loop": "not_finished"}
DONE: frozenset[Outcome] = frozenset(SUCCESS.values())
"""The outcomes of a run that has done its task."""


PENETRATION = "penetration"
"""The metric that the rule on contact is about."""
CONTACT_FREE = "contact-free"
"""The shipped set that is asked of every run."""
LEAST_CORNERS = 3
"""Of a polygon."""
LONGEST_STEP = 10.0
"""Nothing that steers a car exchanges less often [s]."""
Parameter = float | int | bool | str
"""Value of a parameter in SI; a text where the FMU has one."""
Name = Annotated[str, Field(pattern=NAME, max_length=100)]
"""A name, not a path."""


class _ScenarioPart(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Target(_ScenarioPart):
    """Where the car shall stand: the midpoint of its rear axle [m], and its heading [rad]."""

    x: Metres
    """Of the midpoint of its rear axle [m]."""
    y: Metres
    """Of the midpoint of its rear axle [m]."""
    heading: Radians = 0.0
    """How it shall stand [rad]."""

    @property
    def pose(self) -> tuple[float, float, float]:
        """Return (x [m], y [m], heading [rad])."""
        return self.x, self.y, self.heading


class Slot(_ScenarioPart):
    """The slot as a rectangle; x and y are its middle, its length lies along its heading."""

    x: Metres
    """Its middle [m]."""
    y: Metres
    """Its middle [m]."""
    heading: Radians = 0.0
    """Direction of its length [rad]."""
    length: Annotated[Metres, Field(gt=0.0)]
    """Along its heading [m]."""
    width: Annotated[Metres, Field(gt=0.0)]
    """Across it [m]."""


class Scenario(_ScenarioPart):
    """A scenario with its base, car and ``--set`` values merged in; parameters by flat name, in SI units."""

    name: Name
    """Name of the run and of its folder; by default that of the file."""
    title: str = ""
    """One line for tables and pages."""
    description: str = ""
    """What happens, in a few sentences."""
    source: str = ""
    """Paper, standard or request it comes from."""
    extends: str | None = None
    """Shipped scenario, or file beside this one, that says all that this one does not."""
    car: str | None = None
    """Shipped car, or file, or what is different of one: told vehicle and controller alike."""
    task: Task = "park"
    """Purpose of the run: `park`; `drive` along a road or out of a slot; `open_loop`: to its stop time."""
    stop_time: Seconds | None = None
    """When the run ends at the latest [s]; if not said, 5 s more than the controller's ``limit.duration``."""
    step: Seconds = 0.01
    """Communication step [s], a whole number of nanoseconds."""
    decimation: dict[str, int] = {}
    """Decimation: the slave is stepped every n-th communication step."""
    seed: int = Field(default=1, ge=0, le=2**31 - 1)
    """Of faults, and of every parameter called seed that the scenario does not set."""
    vehicle: dict[str, float | int | bool] = {}
    """Parameters of the vehicle, nested or by flat name, with or without unit."""
    controller: dict[str, float | int | bool] = {}
    """Parameters of the controller."""
    target: Target | None = None
    """Where the car shall stand. The controller is told it, unless `controller.target` tells it something else."""
    slot: Slot | None = None
    """The slot as it is: the car's outline is judged by it. What stands around it is the key `scene`."""
    slot_layout: SlotLayout | None = None
    """Generates slot, target, neighbours and kerb, so that they move together."""
    system: SystemText | None = None
    """Slaves, connections and roles, where it is not our vehicle and our controller, connected by equal names."""
    obstacles: list[list[tuple[Metres, Metres]]] = []
    """Things that stand there, convex or not, each by its corners [m]. The valet is told them as its map."""
    faults: list[Fault] = []
    """Disturbances of signals."""
    requirements: list[Requirement] = []
    """Requirements, and names of shipped sets of them; by default the set `house`."""
    contact_allowed: bool = False
    """Whether a run counts as parked, or finished, though the car touches something in the scene."""
    stop_condition: EndCondition = EndCondition()
    """What ends the run before its stop time."""
    expected_outcome: Outcome = "parked"
    """The outcome this scenario is meant to have; if it says none, that its task is done."""
    file: str = ""
    """Where it came from."""
    unsupported_parameters: list[str] = []
    """Parameters that somebody else's FMU does not have, so that it is not given them; they stay true all the same."""
    texts: dict[str, dict[str, str]] = {}
    """Parameters of vehicle and controller that are texts, which FMUs of others may have."""
    overrides: dict[str, str] = {}
    """What ``--set`` changed for one run, as it was written."""

    def given(self, slave: str) -> dict[str, Any]:
        """Return the parameters that a slave is given."""
        own = self.parameters_of(slave)
        return {name: value for name, value in own.items() if f"{slave}.{name}" not in self.unsupported_parameters}

    def parameters_of(self, slave: str) -> dict[str, Any]:
        """Return the parameters that the scenario has for a slave."""
        entry = None if self.system is None else self.system.components.get(slave)
        own = {**getattr(self, slave), **self.texts.get(slave, {})} if slave in MODELS else {}
        return {**(entry.parameters if entry else {}), **own}

    def as_written(self) -> dict[str, Any]:
        """Return what a scenario file says that stands on its own, but for the FMUs that a system names."""
        unwritten = {"file", "extends", "car", "overrides", "unsupported_parameters", "texts"}
        content = self.model_dump(mode="python", exclude=unwritten, by_alias=True, exclude_none=True)
        for owner, texts in self.texts.items():
            content[owner] = {**content[owner], **texts}
        return content

    @property
    def places(self) -> list[str]:
        """Names of the slaves in their order."""
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
        """When the run ends at the latest [s]: the stop time, or by the pace of the driver."""
        if self.stop_time is not None:
            return self.stop_time
        given = {name: np.array([float(self.vehicle.get(name, start))]) for name, start in DEFAULTS.items()}
        return float(stop_times(given, np.array([float(self.controller.get(DURATION, UNLIMITED))]))[0])

    @property
    def success(self) -> Outcome:
        """Return the outcome of a run that has done its task."""
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
    def _parked(self) -> "Scenario":
        """Add what counts as parked everywhere, unless the limits say it of the same number themselves."""
        named = {limit.signal for limit in self.requirements}
        missing = [item for item in shipped_requirements("parked") if item.signal not in named]
        if missing:
            self.requirements = [*self.requirements, *missing]
        return self

    @model_validator(mode="after")
    def _contact_free(self) -> "Scenario":
        """Add the rule on contact, whatever the limits are; no limit takes its place."""
        self.requirements = self._and_contact_free(self.requirements)
        return self

    def _and_contact_free(self, limits: list[Requirement]) -> list[Requirement]:
        rule = self.contact_rule
        return [*(limit for limit in limits if limit.id != rule.id), rule]

    def with_requirements(self, limits: Iterable[Requirement]) -> "Scenario":
        """Return the scenario judged by other limits; the rule on contact stays."""
        return self.model_copy(update={"requirements": self._and_contact_free(list(limits))})

    @property
    def contact_rule(self) -> Requirement:
        """Return the requirement that the car touches nothing; not required where the scenario allows it."""
        (rule,) = shipped_requirements(CONTACT_FREE)
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
