"""A model that cannot be described is refused with the name of the field and what is wrong."""

from typing import Annotated, Any, NamedTuple

import pytest
import toy_model

from fmus.contents.variables import describe, fmi_variables, limits
from modelkit.signal import Signal


def with_params(**fields: Any) -> Any:
    """Return the toy model with the parameters ``name=(annotation, default)``."""
    cls: Any = NamedTuple("Params", [(name, hint) for name, (hint, _) in fields.items()])  # type: ignore[misc]
    cls.__new__.__defaults__ = tuple(default for _, default in fields.values())
    return toy_model.MODEL._replace(params=cls)


def number(low: Any = float("-inf"), high: Any = float("inf")) -> Any:
    return Annotated[float, Signal("m", "a length", low, high)]


@pytest.mark.parametrize(
    ("field", "message"),
    [
        ({"angle": (number(), 0.0)}, "angle: this name is used twice"),
        ({"time": (number(), 0.0)}, "time: this name is used twice"),
        ({"length": (float, 0.0)}, "length: give the field a unit and a meaning"),
        ({"length": (number(1.0, 2.0), 3.0)}, "length: start 3.0 is outside"),
        ({"length": (number(), float("inf"))}, "length: start inf cannot be written"),
        ({"length": (number(), float("nan"))}, "length: start nan cannot be written"),
        ({"size": (Annotated[int, Signal("1", "a count")], 2**31)}, "size: start 2147483648 cannot be written"),
    ],
)
def test_refused(field: Any, message: Any) -> None:
    with pytest.raises(ValueError, match=message):
        fmi_variables(with_params(**field))


def test_modes_name_their_states_and_take_their_limits_from_them() -> None:
    mode = next(item for item in fmi_variables(toy_model.MODEL) if item.name == "wish")
    assert describe(mode) == "mode wished: 0 SLEEPING, 1 SWINGING, 2 TIRED"
    assert limits(mode) == (0, 2)
    assert mode.fmi_type == "Integer"


def test_a_source_is_named_with_the_default() -> None:
    stiffness = fmi_variables(toy_model.MODEL)[0]
    assert stiffness.name == "stiffness"
    assert describe(stiffness) == "spring (default: chosen)"
    assert limits(stiffness) == (0.0, 1e4)


def test_names_of_nested_fields() -> None:
    names = [item.name for item in fmi_variables(toy_model.MODEL)]
    assert "start[2].velocity" in names
    assert "force[2]" in names
