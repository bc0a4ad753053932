"""The types of a model made of several systems: every field that one of them has, under its name, once."""

import typing
from collections.abc import Iterable, Mapping
from enum import IntEnum
from typing import Annotated, Any, NamedTuple, cast

from modelkit.signal import Signal, Subset
from modelkit.states import CannotComposeError, parts_of, union


class MergedField(NamedTuple):
    """A field of a type: what it is, its default, and the class that has it."""

    hint: Any
    default: Any
    owner: type[Any]


def merge_records(name: str, module: str, text: str, parts: Iterable[type[Any]]) -> type[Any]:
    """Return the NamedTuple ``name`` of ``module`` with the fields of all ``parts``, NamedTuples with defaults.

    A field of several parts means the same in all. A mode may have other states in each: it has the union of them,
    an enumeration called as the field. The order is that of the first part that has a field, before what follows
    there. Raises ``CannotComposeError`` where two parts give a field another meaning, type or default.
    """
    fields: dict[str, MergedField] = {}
    states: dict[str, list[type[IntEnum]]] = {}
    for part in parts:
        own = fields_of(part)
        for field, found in own.items():
            if field in fields:
                _check(name, field, found, fields[field])
            modes = states_of(found.hint)
            if modes is not None and modes not in states.setdefault(field, []):
                states[field].append(modes)
        fields = _merge_fields(fields, own)
    hints = {field: _with_states(found.hint, field, states.get(field, ()), module) for field, found in fields.items()}
    return make_named_tuple(name, module, text, {field: (hints[field], fields[field].default) for field in fields})


def make_named_tuple(name: str, module: str, text: str, fields: Mapping[str, tuple[Any, Any]]) -> type[Any]:
    """Return a NamedTuple with ``fields``: name -> (annotation, default)."""
    made: Any = NamedTuple(name, [(field, hint) for field, (hint, _) in fields.items()])  # type: ignore[misc]
    made._field_defaults = {field: default for field, (_, default) in fields.items()}
    made.__new__.__defaults__ = tuple(made._field_defaults.values())
    made.__module__ = module
    made.__doc__ = text
    return cast("type[Any]", made)


def fields_of(part: type[Any]) -> dict[str, MergedField]:
    """Return the fields of a NamedTuple, without what it says of the parts that it has of each."""
    hints = typing.get_type_hints(part, include_extras=True)
    known: Any = part
    missing = [field for field in known._fields if field not in known._field_defaults]
    if missing:
        raise CannotComposeError(f"{part.__module__}.{part.__name__}.{missing[0]} has no default; give it one")
    return {field: MergedField(_whole(hints[field]), known._field_defaults[field], part) for field in known._fields}


def groups_of(part: type[Any]) -> tuple[str, ...]:
    """Return the names of the variables of a type, or of the groups that it has all of: ``car.width``, ``target``.

    Raises ``CannotComposeError`` if it has a part of a group that the group does not have.
    """
    found: list[str] = []
    for field, hint in typing.get_type_hints(part, include_extras=True).items():
        shape = next((mark.shape for mark in getattr(hint, "__metadata__", ()) if isinstance(mark, Subset)), None)
        if shape is None:
            found.append(field)
            continue
        names = [name for cls in reversed(shape.__mro__) for name in vars(cls).get("__annotations__", {})]
        unknown = [name for name in names if name not in hint.__origin__._fields]
        if unknown:
            where = f"{shape.__module__}.{shape.__name__}.{unknown[0]}"
            raise CannotComposeError(f"{where} is no field of {hint.__origin__.__name__}")
        found += [f"{field}.{name}" for name in names]
    return tuple(found)


def states_of(hint: Any) -> type[IntEnum] | None:
    """Return the states of a mode by its annotation; None for anything else."""
    return next((mark.states for mark in getattr(hint, "__metadata__", ()) if isinstance(mark, Signal)), None)


def _whole(hint: Any) -> Any:
    marks = [mark for mark in getattr(hint, "__metadata__", ()) if not isinstance(mark, Subset)]
    if len(marks) == len(getattr(hint, "__metadata__", ())):
        return hint
    return _annotate(hint.__origin__, marks)


def _annotate(kind: Any, marks: Iterable[Any]) -> Any:
    for mark in reversed(list(marks)):
        kind = Annotated[kind, mark]
    return kind


def _without_states(hint: Any) -> Any:
    marks = getattr(hint, "__metadata__", ())
    if not marks:
        return hint
    plain = [mark._replace(states=None) if isinstance(mark, Signal) else mark for mark in marks]
    return _annotate(hint.__origin__, plain)


def _with_states(hint: Any, field: str, states: Iterable[type[IntEnum]], module: str) -> Any:
    """Return the annotation with the states of all systems."""
    found = list(states)
    if not found:
        return hint
    whole = next((item for item in found if set(found) <= {item, *parts_of(item)}), None)
    if whole is None:
        text = f"The states of ``{field}`` in all systems."
        whole = union("".join(word.title() for word in field.split("_")), module, text, *found)
    marks = [mark._replace(states=whole) if isinstance(mark, Signal) else mark for mark in hint.__metadata__]
    return _annotate(hint.__origin__, marks)


def _check(name: str, field: str, found: MergedField, known: MergedField) -> None:
    """Refuse a field that means something else in another part."""
    same = _without_states(found.hint) == _without_states(known.hint)
    if same and found.default == known.default:
        return
    here, there = (f"{item.owner.__module__}.{item.owner.__name__}.{field}" for item in (found, known))
    what = f"default {found.default!r}, {known.default!r}" if same else "type, unit or meaning"
    raise CannotComposeError(f"{name}: {here} and {there} differ ({what}); expected them alike, or another name")


def _merge_fields(fields: dict[str, MergedField], own: dict[str, MergedField]) -> dict[str, MergedField]:
    """Return the fields with those of another part, each new one before the next that both have."""
    order, waiting = list(fields), []
    for field in own:
        if field not in fields:
            waiting.append(field)
            continue
        place = order.index(field)
        order[place:place] = waiting
        waiting = []
    return {field: fields.get(field) or own[field] for field in [*order, *waiting]}
