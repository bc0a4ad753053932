"""Enumerations made of others."""

from enum import IntEnum

import pytest

from modelkit.states import CannotComposeError, parts_of, union


class Lamp(IntEnum):
    OFF = 0
    ON = 2


class Blinker(IntEnum):
    OFF = 0
    LEFT = 1


def test_a_union_has_every_member_once_in_the_order_of_the_numbers() -> None:
    made = union("Light", __name__, "What is lit.", Lamp, Blinker)
    assert [(state.name, int(state)) for state in made] == [("OFF", 0), ("LEFT", 1), ("ON", 2)]
    assert (made.__name__, made.__module__, made.__doc__) == ("Light", __name__, "What is lit.")
    assert (parts_of(made), parts_of(Lamp)) == ((Lamp, Blinker), (Lamp,))


def test_a_number_has_one_name() -> None:
    class Other(IntEnum):
        DIM = 2

    said = r"^Light: .*test_states.Other.DIM = 2 is ON = 2 of .*test_states.Lamp; free numbers: 1, 3, 4"
    with pytest.raises(CannotComposeError, match=said):
        union("Light", __name__, "", Lamp, Other)


def test_a_name_has_one_number() -> None:
    class Other(IntEnum):
        ON = 3

    said = r"^Light: .*Other.ON = 3 is ON = 2 of .*Lamp; expected 2, or another name"
    with pytest.raises(CannotComposeError, match=said):
        union("Light", __name__, "", Lamp, Other)
