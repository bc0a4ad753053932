"""Enumerations of modes that are made of others."""

from enum import EnumType, IntEnum
from typing import cast


class CannotComposeError(ValueError):
    """Two parts of a model contradict each other; one line that says where, and what would do."""


def union(name: str, module: str, text: str, *parts: type[IntEnum]) -> type[IntEnum]:
    """Return the enumeration of all members of ``parts`` by number, for a signal that several charts tell.

    Raises ``CannotComposeError`` if a number has two names in them, or a name two numbers.
    """
    members: dict[str, IntEnum] = {}
    for state in (state for part in parts for state in part):
        clash = next((other for other in members.values() if _contradict(state, other)), None)
        if clash is not None:
            raise CannotComposeError(f"{name}: {_refusal(state, clash, parts)}")
        members.setdefault(state.name, state)
    numbers = {state.name: int(state) for state in sorted(members.values(), key=int)}
    made = cast("type[IntEnum]", EnumType.__call__(IntEnum, name, numbers, module=module))
    made.__doc__ = text
    setattr(made, _PARTS, parts)
    return made


def parts_of(states: type[IntEnum]) -> tuple[type[IntEnum], ...]:
    """Return what a union is made of; any other enumeration is of itself alone."""
    found: tuple[type[IntEnum], ...] = getattr(states, _PARTS, (states,))
    return found


def _contradict(state: IntEnum, other: IntEnum) -> bool:
    return (state.name == other.name) != (int(state) == int(other))


def _refusal(state: IntEnum, other: IntEnum, parts: tuple[type[IntEnum], ...]) -> str:
    """Return where the two members are, and which name or number would do."""
    owner, there = type(state), type(other)
    what = f"{owner.__module__}.{owner.__name__}.{state.name} = {int(state)}"
    clash = f"is {other.name} = {int(other)} of {there.__module__}.{there.__name__}"
    if state.name == other.name:
        return f"{what} {clash}; expected {int(other)}, or another name"
    taken = {int(item) for part in parts for item in part}
    free = [number for number in range(min(taken), max(taken) + 9) if number not in taken][:8]
    return f"{what} {clash}; free numbers: {', '.join(map(str, free))}"


_PARTS = "_parts"
