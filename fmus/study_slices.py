"""What a study uses of its models: program slices that leave out what no connection, kept number or state needs."""

import json
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, NamedTuple

from fmus.cache_paths import CACHE_FOLDER
from fmus.locks import cache_file
from fmus.native.source_fingerprint import CACHED_TRANSLATIONS, ROOT, hash_of, own_packages, words_of
from modelkit.connections import Wire, connections, part_of
from modelkit.model import Model
from modelkit.variables import variables

if TYPE_CHECKING:  # the translator takes a tenth of a second to import
    from fmus.compiler.slicing import Slice


class StudyCode(NamedTuple):
    """How the models of a study are compiled: which slice of each, with which options besides the usual."""

    slices: "Mapping[str, Slice]"
    """By the model's name in the study."""
    options: tuple[str, ...] = ()


def study_slices(
    models: Mapping[str, Model], signals: Iterable[str], choices: Mapping[str, frozenset[int]]
) -> "dict[str, Slice]":
    """Return the slice of each model of which a study uses ``signals``, outputs and inputs such as ``vehicle.speed``.

    ``choices``: values of the parameter that chooses a system, of the models that have several. The result is kept in
    the cache for the project's own models. Raises ``Refused`` for a model that the translator refuses.
    """
    from fmus.compiler.slicing import Slice

    used = frozenset(signals)
    packages = [own_packages(model) for model in models.values()]
    if None in packages:
        return _solve(models, used, choices)
    words = [word for name, model in models.items() for word in (name, *words_of(model))]
    words += [*sorted(used), *(f"{name} {sorted(values)}" for name, values in sorted(choices.items()))]
    folders = dict.fromkeys(path for paths in packages for path in paths or ())
    key = hash_of([*folders, ROOT / "modelkit", ROOT / "fmus"], "\0".join(words))

    def make() -> bytes:
        found = _solve(models, used, choices)
        return json.dumps({name: sorted(item.outputs) for name, item in found.items()}).encode()

    kept = json.loads(cache_file(CACHE_FOLDER, "slices", key, ".slices.json", make, CACHED_TRANSLATIONS).read_bytes())
    return {name: Slice(frozenset(outputs), choices.get(name)) for name, outputs in kept.items()}


def outputs_left_out(models: Mapping[str, Model], slices: "Mapping[str, Slice]") -> dict[str, list[str]]:
    """Return, for each model, the names of the outputs that its slice does not compute."""
    return {
        name: [item.name for item in variables(model.outputs) if item.name not in slices[name].outputs]
        for name, model in models.items()
    }


def _solve(
    models: Mapping[str, Model], used: frozenset[str], choices: Mapping[str, frozenset[int]]
) -> "dict[str, Slice]":
    """Return the least slices that are consistent: what a live input receives is a live output."""
    from fmus.compiler import live_inputs
    from fmus.compiler.slicing import Slice

    names = list(models)
    outputs = {name: {item.name for item in variables(models[name].outputs)} for name in names}
    live = {name: frozenset(found) & {item.removeprefix(f"{name}.") for item in used if item.startswith(f"{name}.")}
            for name, found in outputs.items()}  # fmt: skip
    wires = connections([part_of(name, model) for name, model in models.items()])
    done: dict[str, frozenset[str]] = {}
    reads: dict[str, frozenset[str]] = {}
    while done != live:
        for name in names:
            if done.get(name) != live[name]:
                reads[name] = live_inputs(models[name], Slice(live[name], choices.get(name)))
        done = dict(live)
        for wire in wires:
            if _is_live(wire, names, models, used, reads):
                source = names[wire.source]
                live[source] |= {variables(models[source].outputs)[wire.output].name}
    return {name: Slice(live[name], choices.get(name)) for name in names}


def _is_live(
    wire: Wire, names: list[str], models: Mapping[str, Model], used: frozenset[str], reads: Mapping[str, frozenset[str]]
) -> bool:
    target = names[wire.target]
    name = variables(models[target].inputs)[wire.input].name
    return name in reads[target] or f"{target}.{name}" in used
