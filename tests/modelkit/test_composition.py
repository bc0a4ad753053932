"""Types of a model made of several systems."""

from enum import IntEnum
from typing import Annotated, Any, NamedTuple, Protocol

import pytest

from modelkit.composition import groups_of, merge_records
from modelkit.signal import Role, Signal, Subset
from modelkit.states import CannotComposeError, parts_of
from modelkit.variables import variables

Speed = Annotated[float, Signal("m/s", "speed")]


class Car(NamedTuple):
    length: Annotated[float, Signal("m", "length")] = 4.0
    width: Annotated[float, Signal("m", "width")] = 2.0


class Wide(Protocol):
    width: float


class Walk(IntEnum):
    STAND = 0
    GO = 1


class Swim(IntEnum):
    STAND = 0
    DIVE = 2


class Walker(NamedTuple):
    speed: Speed = 1.0
    phase: Annotated[int, Signal("1", "phase", states=Walk)] = 0
    car: Annotated[Car, Role.TUNABLE] = Car()


class Swimmer(NamedTuple):
    depth: Annotated[float, Signal("m", "depth")] = 0.0
    phase: Annotated[int, Signal("1", "phase", states=Swim)] = 0
    car: Annotated[Car, Role.TUNABLE, Subset(Wide)] = Car()
    breath: Annotated[float, Signal("s", "breath")] = 9.0


def test_the_whole_has_each_field_once_in_the_order_of_its_parts() -> None:
    made: Any = merge_records("Both", __name__, "Both.", (Walker, Swimmer))
    assert made._fields == ("speed", "depth", "phase", "car", "breath")
    assert made() == (1.0, 0.0, 0, Car(), 9.0)
    assert (made.__name__, made.__module__, made.__doc__) == ("Both", __name__, "Both.")


def test_the_whole_has_all_of_what_a_part_has_some_of() -> None:
    made = merge_records("Both", __name__, "", (Walker, Swimmer))
    found = {item.name: item for item in variables(made)}
    assert {"car.length", "car.width"} <= set(found)
    assert found["car.width"].roles == {Role.TUNABLE}
    assert groups_of(Swimmer) == ("depth", "phase", "car.width", "breath")
    assert groups_of(Walker) == ("speed", "phase", "car")


def test_a_mode_has_the_states_of_all() -> None:
    phase = next(
        item for item in variables(merge_records("Both", __name__, "", (Walker, Swimmer))) if item.name == "phase"
    )
    assert phase.signal.states is not None
    assert phase.signal.states.__name__ == "Phase"
    assert {item.name: int(item) for item in phase.signal.states} == {"STAND": 0, "GO": 1, "DIVE": 2}
    assert parts_of(phase.signal.states) == (Walk, Swim)


def test_what_differs_is_refused_with_both_places() -> None:
    class Faster(NamedTuple):
        speed: Speed = 2.0

    class InKilometres(NamedTuple):
        speed: Annotated[float, Signal("km/h", "speed")] = 1.0

    here = "tests.modelkit.test_composition"
    with pytest.raises(CannotComposeError) as refusal:
        merge_records("Both", __name__, "", (Walker, Faster))
    assert str(refusal.value) == (
        f"Both: {here}.Faster.speed and {here}.Walker.speed differ (default 2.0, 1.0); "
        "expected them alike, or another name"
    )
    with pytest.raises(CannotComposeError, match="differ \\(type, unit or meaning\\)"):
        merge_records("Both", __name__, "", (Walker, InKilometres))


def test_a_part_of_what_is_not_there_is_refused() -> None:
    class Heavy(Protocol):
        mass: float

    class Lifter(NamedTuple):
        car: Annotated[Car, Subset(Heavy)] = Car()

    with pytest.raises(CannotComposeError, match=r"Heavy.mass is no field of Car"):
        groups_of(Lifter)


def test_a_field_without_a_default_is_refused() -> None:
    class Open(NamedTuple):
        speed: float

    with pytest.raises(CannotComposeError, match=r"Open.speed has no default"):
        merge_records("Both", __name__, "", (Open,))
