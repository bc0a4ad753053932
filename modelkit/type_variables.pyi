"""A bare ``Model`` is one of any types: defaults of type variables, which Python has from 3.13 on."""

from typing import Any

from typing_extensions import TypeVar

State = TypeVar("State", bound=tuple[Any, ...], default=Any)
Params = TypeVar("Params", bound=tuple[Any, ...], default=Any)
Input = TypeVar("Input", bound=tuple[Any, ...], default=Any)
Output = TypeVar("Output", bound=tuple[Any, ...], default=Any)
Own = TypeVar("Own", bound=tuple[Any, ...], default=Any)
Clock = TypeVar("Clock", bound=tuple[Any, ...], default=Any)
