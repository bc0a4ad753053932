"""From types to flat names and back."""

from typing import Annotated, NamedTuple

import pytest

from modelkit.signal import Group, Role, Signal
from modelkit.variables import constructor, flatten, flattener, variables, with_values


class Wheel(NamedTuple):
    angle: Annotated[float, Signal("rad", "angle")] = 0.25
    turns: Annotated[int, Signal("1", "turns", 0, 9)] = 2


class Cart(NamedTuple):
    speed: Annotated[float, Signal("m/s", "speed", -5.0, 5.0)] = 1.0
    moving: Annotated[bool, Signal("1", "moves")] = True
    wheels: Annotated[tuple[Wheel, ...], Group("wheel", (("rad", 3.0),)), Role.TUNABLE] = (Wheel(), Wheel(0.5, 3))
    plate: Annotated[Wheel, Role.FIXED] = Wheel(0.75, 4)


def test_names_are_dotted_and_count_from_one() -> None:
    assert [item.name for item in variables(Cart)] == [
        "speed",
        "moving",
        "wheels[1].angle",
        "wheels[1].turns",
        "wheels[2].angle",
        "wheels[2].turns",
        "plate.angle",
        "plate.turns",
    ]


def test_types_and_starts_are_those_of_the_fields() -> None:
    assert [(item.kind, item.start) for item in variables(Cart)] == [
        (float, 1.0),
        (bool, True),
        (float, 0.25),
        (int, 2),
        (float, 0.5),
        (int, 3),
        (float, 0.75),
        (int, 4),
    ]


def test_a_group_gives_its_text_its_marks_and_limits_to_what_has_none() -> None:
    known = {item.name: item for item in variables(Cart)}
    angle, turns = known["wheels[2].angle"], known["wheels[2].turns"]
    assert (angle.signal.text, angle.signal.low, angle.signal.high) == ("wheel: angle", -3.0, 3.0)
    assert (turns.signal.low, turns.signal.high) == (0, 9)
    assert Role.TUNABLE in angle.roles
    assert Role.TUNABLE not in known["plate.angle"].roles


def test_flat_and_nested_are_the_same() -> None:
    cart = Cart(2.0, False, (Wheel(1.0, 1), Wheel(2.0, 2)), Wheel(3.0, 3))
    assert constructor(Cart)(flatten(cart)) == cart
    assert [type(item) for item in flatten(constructor(Cart)(flatten(cart)))] == [type(item) for item in flatten(cart)]


def test_one_value_changes_and_the_others_stay() -> None:
    assert with_values(Cart, {"wheels[2].turns": 7}) == Cart(wheels=(Wheel(), Wheel(0.5, 7)))
    assert with_values(Cart, {"speed": 2.0}, Cart(moving=False)) == Cart(speed=2.0, moving=False)


def test_an_unknown_name_is_told() -> None:
    with pytest.raises(KeyError, match=r"wheels\[3\].turns"):
        with_values(Cart, {"wheels[3].turns": 1})


@pytest.mark.parametrize("value", [5.5, -5.5, float("nan"), float("inf")])
def test_a_number_out_of_its_range_is_told_with_the_range(value: float) -> None:
    with pytest.raises(ValueError, match=r"speed = .*: expected \[-5.0, 5.0\] m/s"):
        with_values(Cart, {"speed": value})


def test_a_field_of_another_type_is_refused_by_name() -> None:
    class Named(NamedTuple):
        title: str = "cart"

    with pytest.raises(TypeError, match="title"):
        variables(Named)


def test_a_fast_flattener_lists_what_flatten_does_and_a_constructor_reads_it_from_anywhere() -> None:
    cart = Cart(speed=2.5, wheels=(Wheel(0.1, 5), Wheel(0.2, 6)))
    assert flattener(Cart())(cart) == flatten(cart)
    assert constructor(Cart, at=3)([None, None, None, *flatten(cart)]) == cart
