"""What a piece of C looks at: variables and their members, pointers taken for what they point to."""

import re

from fmus.compiler.target.body import FunctionBody
from fmus.compiler.target.values import Place, Value, place_of

Access = tuple[str, ...]
"""A variable and the members that lead on from it, as far as the first index."""
ACCESS = re.compile(r"(?<![\w.>])([A-Za-z_]\w*)((?:(?:\.|->)\w+)*)")


def accesses(body: FunctionBody, text: str) -> list[Access]:
    """Return what ``text`` mentions, as often as it does."""
    found = []
    for word, members in ACCESS.findall(text):
        steps = re.findall(r"\w+", members)
        found += [(*root, *steps) for root in body.aliases.get(word, ((word,),))]
    return found


def overlap(one: Access, other: Access) -> bool:
    """Return whether one of two is the other, or a part of it."""
    shared = min(len(one), len(other))
    return one[:shared] == other[:shared]


def access_to(body: FunctionBody, place: Place) -> Access:
    """Return what is written to at ``place``."""
    return accesses(body, place.text)[0]


def looks_at_place(body: FunctionBody, text: str, place: Place) -> bool:
    """Return whether ``text`` mentions ``place``, a part of it, or what it is part of."""
    own = access_to(body, place)
    return any(overlap(own, other) for other in accesses(body, text))


def is_at(body: FunctionBody, value: Value, place: Place) -> bool:
    """Return whether ``value`` is what lies at ``place``."""
    if not value.place:
        return False
    text = place_of(value).text
    if text == place.text:
        return True
    whole = ACCESS.fullmatch(text) and ACCESS.fullmatch(place.text)
    return bool(whole) and accesses(body, text) == accesses(body, place.text)
