"""Enumerations of modes that are made of others."""

from enum import EnumType, IntEnum
from typing import cast


def union(name: str, module: str, text: str, *parts: type[IntEnum]) -> type[IntEnum]:
    """Return the enumeration of all members of ``parts`` by number, for a signal that several charts tell.

    Raises ``ValueError`` if a number has two names in them, or a name two numbers.
    """
    members: dict[str, int] = {}
    for state in sorted((state for part in parts for state in part), key=int):
        named = [other for other, number in members.items() if number == int(state) and other != state.name]
        if named or members.setdefault(state.name, int(state)) != int(state):
            other = named[0] if named else f"{state.name} = {members[state.name]}"
            raise ValueError(f"{name}: {state!r} is also {other}")
    made = cast("type[IntEnum]", EnumType.__call__(IntEnum, name, members, module=module))
    made.__doc__ = text
    setattr(made, _PARTS, parts)
    return made


def parts_of(states: type[IntEnum]) -> tuple[type[IntEnum], ...]:
    """Return what a union is made of; any other enumeration is of itself alone."""
    found: tuple[type[IntEnum], ...] = getattr(states, _PARTS, (states,))
    return found


_PARTS = "_parts"
