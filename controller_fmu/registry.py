"""The systems of the controller, one row each, and the controller that is made of them.

Nothing below imports this file, no system another: a system says what its parameters, inputs, outputs and phases are,
and the types of the whole have the fields of all.
"""

import sys
from collections.abc import Callable, Iterator, Mapping
from enum import IntEnum
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeAlias

from controller_fmu import (
    adaptive,
    guo2015,
    hsic,
    preview,
    zhang2022,
)
from controller_fmu.common.clock import Clock, begin, refusal_output, tick
from controller_fmu.interface import RefusedOutput
from controller_fmu.parking.params import ParkingSystem
from controller_fmu.policy.params import PolicySystem
from modelkit.composition import make_named_tuple, merge_records
from modelkit.model import Model, SampledSystem, SampledSystems, Variant
from modelkit.signal import Signal
from modelkit.states import union
from modelkit.terminals import TERMINALS
from modelkit.variables import variables

ROWS: tuple[SampledSystem[Any, Any, Any, Any], ...] = (
    guo2015.SYSTEM,
    zhang2022.SYSTEM,
    hsic.SYSTEM,
    preview.SYSTEM,
    adaptive.SYSTEM,
)
"""The systems of one controller, which choose by ``controller.system``."""


class StandaloneModels(Mapping[IntEnum, Model]):
    """Value of ``controller.system`` -> model, imported when it is first used."""

    def __init__(self, rows: dict[IntEnum, Callable[[], Model]]) -> None:
        self._rows = rows

    def __getitem__(self, choice: IntEnum) -> Model:
        return self._rows[choice]()

    def __iter__(self) -> Iterator[IntEnum]:
        return iter(self._rows)

    def __len__(self) -> int:
        return len(self._rows)


def _parking() -> Model:
    from controller_fmu.parking.standalone import MODEL

    return MODEL


def _parking_large() -> Model:
    from controller_fmu.parking.large_map import MODEL

    return MODEL


def _policy() -> Model:
    from controller_fmu.policy.standalone import MODEL

    return MODEL


APART = StandaloneModels(
    {
        ParkingSystem.APA: _parking,
        PolicySystem.POLICY: _policy,
        ParkingSystem.APA_LARGE: _parking_large,
    }
)
"""Those that are a controller of their own, with work arrays or a map: by their value of ``controller.system``."""

System: Any = union(
    "System",
    __name__,
    "Which paper's system parks the car.",
    *(row.choices for row in ROWS),
    *dict.fromkeys(type(choice) for choice in APART),
)


SYSTEM_CHOICES = union("System", __name__, str(System.__doc__), *(row.choices for row in ROWS))
"""Those of them that are in the one controller."""


class Choosing(NamedTuple):
    """What chooses among them."""

    system: Annotated[int, Signal("1", "controller selection", states=System)] = next(iter(System))


if TYPE_CHECKING:
    ControllerParams: TypeAlias = Any
    ControllerInput: TypeAlias = Any
    ControllerOutput: TypeAlias = Any
    ControllerState: TypeAlias = Any
else:
    ControllerParams = merge_records(
        "ControllerParams",
        __name__,
        "The chosen system, its model of the car, the target and every limit.",
        (Choosing, *(row.params for row in ROWS)),
    )
    ControllerInput = merge_records("ControllerInput", __name__, "From the vehicle.", (row.inputs for row in ROWS))
    ControllerOutput = merge_records(
        "ControllerOutput",
        __name__,
        "To the vehicle, the driver, the log and the judge.",
        (*(row.reported for row in ROWS), RefusedOutput),
    )
    ControllerState = make_named_tuple(
        "ControllerState",
        __name__,
        "Everything the controller remembers: its clock, and the memory of each system.",
        {"clock": (Clock, Clock()), **{row.field: (row.state, row.state()) for row in ROWS}},
    )
Phase: Any = next(item.signal.states for item in variables(ControllerOutput) if item.name == "phase")
"""The phases of all systems."""
SYSTEMS = SampledSystems(
    state=ControllerState,
    parameter="system",
    clock="clock",
    begin=begin,
    tick=tick,
    refused=refusal_output,
    outputs=ControllerOutput,
    systems=ROWS,
)
MODEL = Model(
    name="Controller",
    description="Automated parking: planner, path and point tracking, manoeuvre chart",
    package=sys.modules[__name__.rpartition(".")[0]],
    state=ControllerState,
    params=ControllerParams,
    inputs=ControllerInput,
    outputs=ControllerOutput,
    initialize=SYSTEMS.initialize,
    step=SYSTEMS.step,
    step_size=0.01,
    stop_time=60.0,
    terminals=TERMINALS,
    systems=SYSTEMS,
    sampled=True,
    view=Variant(states=(("system", SYSTEM_CHOICES),)),
)
SYSTEM_MODELS: dict[IntEnum, Model] = {
    choice: MODEL.only(choice, f"Controller_{choice.name.lower()}", description)
    for row in ROWS
    for choice, description in zip(row.choices, row.descriptions, strict=True)
}
"""The controller with one system alone: the same code, with that system's parameters, inputs and outputs only."""
