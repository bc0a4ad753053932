"""From a model to the text of its header and its C file, or to all reasons why there is none."""

import typing
from contextlib import AbstractContextManager
from typing import Any, NamedTuple

from fmus.compiler.assembly import AssemblyEntries
from fmus.compiler.constructs import arithmetic, calls, conditions, loops, statements, tuples
from fmus.compiler.entries import NAMES, Entries, roots
from fmus.compiler.files import Files
from fmus.compiler.slicing import Slice, SlicedLibrary, fields_along, slice_program, solve_liveness
from fmus.compiler.source.diagnostics import AlreadySaidError, CannotError, Diagnostic, UnsupportedError
from fmus.compiler.source.reading import Library
from fmus.compiler.source.types import NoKindError, Struct, is_named_tuple, translating
from fmus.compiler.target.program import Program
from modelkit.model import Model
from modelkit.variables import variables

LANGUAGE = (arithmetic, calls, conditions, loops, statements, tuples)
"""The files that know what to make of each part of the language."""


class Translation(NamedTuple):
    """A model in C99."""

    name: str
    header: str
    source: str


def translate(model: Model, live: Slice | None = None) -> Translation:
    """Return the C99 of ``model``, or of the slice ``live`` of it; raises ``UnsupportedError`` with all reasons."""
    with _types_of(model):
        return _translate(model, _interface(model), live)


def live_inputs(model: Model, live: Slice) -> frozenset[str]:
    """Return the names of the inputs that the slice ``live`` of ``model`` reads; errors as :func:`translate`."""
    with _types_of(model):
        fields = frozenset(solve_liveness(*_program(model, _interface(model), live)).fields)
        names = (item.name for item in variables(model.inputs))
        return frozenset(name for name in names if fields.issuperset(fields_along(model.inputs, name)))


def _types_of(model: Model) -> AbstractContextManager[None]:
    models = [model] if model.assembly is None else [model, *(part for _, part in model.assembly.parts)]
    wholes = {own: whole for item in models for own, whole in _wholes(item).items()}
    return translating(wholes, [cls for item in models for cls in _interface(item)])


def _slice(model: Model, interfaces: list[Any], live: Slice) -> SlicedLibrary:
    return slice_program(*_program(model, interfaces, live))


def _program(model: Model, interfaces: list[Any], live: Slice) -> tuple[Library, list[Any], list[Any], Any, list[str]]:
    """Return what a slice is made of."""
    found = select_systems(model, live.choices)
    return Library(), _roots(found), interfaces, model.outputs, sorted(live.outputs)


def _wholes(model: Model) -> dict[Any, Any]:
    """Return what the types of each system, and of what all share, stand for: those of the model."""
    found: dict[Any, Any] = dict(model.substitutes)
    if model.systems is None:
        return found
    for item in model.systems.systems:
        found |= {item.params: model.params, item.inputs: model.inputs, item.reported: model.outputs}
    reported = typing.get_type_hints(model.systems.refused).get("return")
    return found | ({} if reported is None else {reported: model.outputs})


def _translate(model: Model, interfaces: list[Any], live: Slice | None) -> Translation:
    library = None
    if live is not None:
        model, library = select_systems(model, live.choices), _slice(model, interfaces, live)
    parts = () if model.assembly is None else tuple(part.name for _, part in model.assembly.parts)
    program = Program((model.name, *parts), _roots(model), interfaces, NAMES, library)
    entries = Entries(program, model) if model.assembly is None else AssemblyEntries(program, model, model.assembly)
    try:
        for cls in interfaces:
            program.need(Struct(cls))
        functions = entries.texts()
    except (CannotError, NoKindError) as error:
        program.refuse(model.initialize.__module__, getattr(error, "node", None), error.what, error.advice)
    except AlreadySaidError:
        pass
    if program.refusals:
        raise UnsupportedError(program.refusals)
    files = Files(program, entries, model)
    return Translation(model.name, files.header(), files.source(functions))


def select_systems(model: Model, choices: frozenset[int] | None) -> Model:
    """Return the model with those of its systems alone that a value of ``choices`` chooses."""
    if choices is None or model.systems is None:
        return model
    kept = tuple(item for item in model.systems.systems if choices & set(item.values))
    return model._replace(systems=model.systems._replace(systems=kept))


def _roots(model: Model) -> list[Any]:
    try:
        return roots(model)
    except CannotError as error:
        raise UnsupportedError([Diagnostic(model.name, 1, error.what, error.advice)]) from None


def _interface(model: Model) -> list[Any]:
    """Return the NamedTuples of a model: its four, and its store."""
    found = {"state": model.state, "params": model.params, "inputs": model.inputs, "outputs": model.outputs}
    found |= {} if model.store is None else {"store": model.store}
    wrong = [
        Diagnostic(model.name, 1, f"{group} of the model is {cls!r}", "give it a NamedTuple")
        for group, cls in found.items()
        if not is_named_tuple(cls)
    ]
    if wrong:
        raise UnsupportedError(wrong)
    return list(found.values())
