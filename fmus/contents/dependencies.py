"""Which parameters an output depends on at the start, found by changing parameters and calling initialize.

From the defaults, and from the defaults with one mode or switch changed, each parameter moves alone: to both ends of
its range, a little up and down, to each of its modes. From points drawn around the defaults, where arrays are in use
that are empty at first, all move at once, and what changed the outputs is searched for by halves.

A parameter may act only in a corner that no point is in, so more is named than was seen: the parts of an array are
taken for alike, and so are the fields of one named group; what changes a mode (a fault, a phase) is taken to act on
every output that anything acts on. Outputs that nothing changes at the start have no dependency. One too few would
matter to a master that solves an algebraic loop at the start; there is none here: no output depends on an input.

The result is the same each time and is kept in ``fmus/dist/cache`` under the hash of the model's sources.
"""

import json
import random
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import modelkit
from fmus.cache_paths import CACHE_FOLDER
from fmus.contents.archive import content_hash
from fmus.locks import cache_file
from modelkit.model import Model
from modelkit.variables import Variable, constructor, flattener, variables

SAMPLED_POINTS = 9000
"""Points drawn around the defaults times parameters moved there."""
MOVES_PER_POINT = 4
"""How often all are moved from each of those."""
MAX_JOINT_FIELDS = 4
"""Fields of a group that act together where one of them decides about a mode: a ratio, an angle, a rate."""
SUFFIX = ".dependencies.json"
LONE_ELEMENTS = 32
"""So many elements at either end of an array move alone; those between are alike and move together with all."""
CACHED_RESULTS = 8
"""Results of older sources that stay in the cache."""
DEFAULT_SAMPLE_FRACTION = 0.9
"""Share of the draws that lie around the default; the others are ends of the range."""
REACH = {"m": 5.0}
"""How far from its default a point is drawn in this unit, at least; in others 0.5."""
UNSEEN = {"clearance": ("ultrasonic.kerb_height",)}
"""Output -> parameters that act on it in a corner too small to be drawn: the outline over a kerb of that height."""
Found = dict[str, list[str]]
Values = list[Any]


def initial_dependencies(model: Model) -> Found:
    """Return output -> the parameters it depends on at the start, in the order of the types.

    They are those of the model with its default parameters, whatever it starts with; in a model that is several, each
    output depends on parameters of its own part.
    """
    if model.assembly is not None:
        return {
            f"{part}.{output}": [f"{part}.{name}" for name in names if model.shows(f"{part}.{name}")]
            for part, own in model.assembly.parts
            for output, names in initial_dependencies(own).items()
            if model.shows(f"{part}.{output}")
        }
    model = model.with_start_values({})
    key = _hash(model)[:32]
    path = cache_file(
        CACHE_FOLDER, model.name, key, SUFFIX, lambda: json.dumps(find_dependencies(model)).encode(), CACHED_RESULTS
    )
    found: Found = json.loads(path.read_bytes())
    return found


def find_dependencies(model: Model) -> Found:
    """Return the same without the cache."""
    known = variables(model.params, model.first_params())
    free = [place for place, item in enumerate(known) if model.shows(item.name)]
    acting = _acting(_as_written(model))
    deciding = {
        parameter
        for parameter, outputs in acting.items()
        if any(_whole_array(item.name) in outputs for item in variables(model.outputs) if item.signal.states)
    }
    sizes = Counter(map(_group, acting))
    found: Found = {}
    for item in variables(model.outputs):
        causes = {parameter for parameter, outputs in acting.items() if _whole_array(item.name) in outputs}
        decide = deciding if causes else set()
        groups = {_group(parameter) for parameter in causes - deciding} | {
            group for group in map(_group, decide) if sizes[group] <= MAX_JOINT_FIELDS
        }
        groups -= {""}
        causes |= decide
        causes |= {parameter for parameter in acting if _group(parameter) in groups}
        causes |= acting.keys() & UNSEEN.get(item.name, ())
        if model.shows(item.name):
            found[item.name] = [known[place].name for place in free if _whole_array(known[place].name) in causes]
    return found


def _as_written(model: Model) -> Model:
    """Return the model with the types that its code names: arrays count as one, however long they are."""
    own = {substitute: cls for cls, substitute in model.substitutes}
    return model._replace(params=own.get(model.params, model.params))


def _acting(model: Model) -> dict[str, set[str]]:
    """Return parameter -> the outputs that it has been seen to change; an array counts as one."""
    known = variables(model.params, model.first_params())
    free = [place for place, item in enumerate(known) if model.shows(item.name)]
    names = [_whole_array(item.name) for item in known]
    outputs = [_whole_array(item.name) for item in variables(model.outputs)]
    acting: dict[str, set[str]] = {name: set() for name in names}
    start = _starter(model)

    def search(point: Values, expected: Values, moved: Mapping[int, Any], places: Sequence[int]) -> None:
        """Note which of ``places`` act when they move; parts that show nothing new are left at once."""
        changed = list(point)
        for place in places:
            changed[place] = moved[place]
        found = start(changed)
        seen = {name for name, value, before in zip(outputs, found, expected, strict=False) if value != before}
        if found and all(seen <= acting[names[place]] for place in places):
            return
        if len(places) == 1:
            acting[names[places[0]]] |= seen
            return
        middle = len(places) // 2
        search(point, expected, moved, places[:middle])
        search(point, expected, moved, places[middle:])

    lone = _lone(known, free)
    for point in _plain_points(known, free):
        expected = start(point)
        for place in lone:
            for value in _alternatives(known[place], point[place]):
                search(point, expected, {place: value}, (place,))
    for point in _sample_points(known, free, model.name):
        expected = start(point)
        alternatives = {place: _alternatives(known[place], point[place]) for place in free}
        for number in range(MOVES_PER_POINT):
            search(
                point, expected, {place: values[number % len(values)] for place, values in alternatives.items()}, free
            )
    return acting


def _lone(known: list[Variable], free: list[int]) -> list[int]:
    """Return the places of the parameters that move alone: all, but of long arrays the elements at both ends."""
    elements = {place: _element(known[place].name) for place in free}
    counts: Counter[str] = Counter()
    for array, number in elements.values():
        counts[array] = max(counts[array], number)
    return [
        place
        for place, (array, number) in elements.items()
        if number <= LONE_ELEMENTS or number > counts[array] - LONE_ELEMENTS
    ]


def _element(name: str) -> tuple[str, int]:
    """Return the array that a parameter is in and the number of its element; 0 outside arrays."""
    array, bracket, rest = name.partition("[")
    return (array, int(rest.partition("]")[0])) if bracket else (name, 0)


def _starter(model: Model) -> Callable[[Values], Values]:
    """Return the function from all parameters to all outputs at the start: none if the model has none.

    NaN and infinite are words, so that each is equal to itself.
    """
    make, flat = constructor(model.params), flattener(model.outputs())

    def start(values: Values) -> Values:
        try:
            outputs = flat(model.initialize(make(values))[1])
        except (ArithmeticError, ValueError):
            return []
        return [value if value - value == 0 else str(value) for value in outputs]

    return start


def _plain_points(known: list[Variable], free: list[int]) -> Iterator[Values]:
    """Return the defaults, and them with one mode or switch changed."""
    first = [item.start for item in known]
    yield first
    for place in free:
        for value in _others(known[place]):
            yield [value if place == other else item for other, item in enumerate(first)]


def _sample_points(known: list[Variable], free: list[int], seed: str) -> Iterator[Values]:
    """Return points around the defaults; of the arrays, half are left as they are in each."""
    draw = random.Random(seed)
    arrays = sorted({item.name.split("[")[0] for item in known if "[" in item.name})
    for _ in range(SAMPLED_POINTS // max(1, len(free))):
        left = tuple(f"{array}[" for array in arrays if draw.random() < 0.5)
        point = [item.start for item in known]
        for place in free:
            if not known[place].name.startswith(left):
                point[place] = _sample(known[place], draw)
        yield point


def _others(item: Variable) -> list[Any]:
    """Return the other values of a mode or switch."""
    if item.kind is bool:
        return [not item.start]
    return [int(state) for state in item.signal.states or () if state != item.start]


def _sample(item: Variable, draw: random.Random) -> Any:
    """Return the default, a value near it, or seldom an end of the range."""
    keep, share = draw.random() < 0.4, draw.uniform(-1.0, 1.0)
    others = _others(item)
    if keep or (item.kind is not float and not others):
        return item.start
    if others:
        return others[int((share + 1.0) / 2.0 * len(others)) % len(others)]
    if abs(share) > DEFAULT_SAMPLE_FRACTION:
        return item.signal.low if share < 0.0 else item.signal.high
    width = max(0.5 * abs(item.start), REACH.get(item.signal.unit, 0.5))
    return _within(item, item.start + share * width)


def _alternatives(item: Variable, now: Any) -> list[Any]:
    """Return the values that a parameter moves to from ``now``: of numbers a little more, a little less, and far."""
    if item.kind is bool:
        return [not now]
    if item.signal.states is not None:
        return [int(state) for state in item.signal.states if state != now]
    little = 1e-3 * (1.0 + abs(now)) if item.kind is float else 1
    ends = [end for end in (item.signal.low, item.signal.high) if end - end == 0.0]
    values = (now + little, now - little, *ends)
    return [item.kind(_within(item, value)) for value in values]


def _within(item: Variable, value: float) -> float:
    return min(max(value, item.signal.low), item.signal.high)


def _whole_array(name: str) -> str:
    """Return the name, for a part of an array the array's: ``scene.boxes`` of ``scene.boxes[3].x``."""
    return name.split("[")[0]


def _group(variable: str) -> str:
    return variable.rpartition(".")[0]


def _hash(model: Model) -> str:
    """Return a hash of the model's sources and modelkit's, of this file, and of what the model shows."""
    shown = [item.name for cls in (model.params, model.outputs) for item in variables(cls) if model.shows(item.name)]
    files = {"shown": json.dumps([shown, model.view.starts]).encode(), "search": Path(__file__).read_bytes()}
    for origin in (Path(str(package.__file__)) for package in (modelkit, model.package)):
        sources = sorted(origin.parent.rglob("*.py")) if origin.name == "__init__.py" else [origin]
        files |= {f"{origin.parent.name}/{path.relative_to(origin.parent)}": path.read_bytes() for path in sources}
    return content_hash(files)
