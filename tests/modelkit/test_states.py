"""Enumerations made of others."""

from enum import IntEnum

import pytest

from modelkit.states import parts_of, union


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

    with pytest.raises(ValueError, match=r"Light: <Other.DIM: 2> is also ON|Light: <Lamp.ON: 2> is also DIM"):
        union("Light", __name__, "", Lamp, Other)


def test_a_name_has_one_number() -> None:
    class Other(IntEnum):
        ON = 3

    with pytest.raises(ValueError, match=r"Light: <Other.ON: 3> is also ON = 2"):
        union("Light", __name__, "", Lamp, Other)
