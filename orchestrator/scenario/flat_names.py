"""From nested YAML sections to flat names: ``{driver: {profile: [[0, 1.5]]}}`` -> ``driver.profile[1].at``."""

from collections.abc import Iterable, Mapping
from typing import Any

from orchestrator.text.errors import BadInput, shown, suggestion


def flatten_section(
    section: Mapping[str, object], names: Iterable[str], *, file: object, key: str
) -> dict[str, object]:
    """Return flat name -> raw value. A list may stand for a NamedTuple (in field order) or for an array.

    Raises ``BadInput`` for a name the model does not have, with the closest ones.
    """
    known = list(names)
    flat: dict[str, object] = {}
    for name, value in section.items():
        _flatten(str(name), value, known, flat, file, key)
    return flat


def merge_flat(below: dict[str, object], above: Mapping[str, object]) -> dict[str, object]:
    """Return ``below`` overridden by ``above``; an array given above replaces the whole array below."""
    arrays = {name[: name.index("[")] + "[" for name in above if "[1]" in name}
    kept = {name: value for name, value in below.items() if not any(name.startswith(array) for array in arrays)}
    return {**kept, **above}


def merge_nested(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Return ``below`` overridden by ``above``; sections are merged key by key, anything else is replaced whole."""
    result = dict(below)
    for key, value in above.items():
        old = result.get(key)
        result[key] = merge_nested(old, value) if isinstance(old, dict) and isinstance(value, Mapping) else value
    return result


def _flatten(name: str, value: object, known: list[str], flat: dict[str, object], file: object, key: str) -> None:
    if name in known:
        flat[name] = value
        return
    children = _children(name, known)
    if not children:
        close = suggestion(name, known, f"{key}.")
        raise BadInput(f"unknown{close or '; known are ' + _roots(known)}", file=file, key=f"{key}.{name}")
    if isinstance(value, Mapping):
        for child, item in value.items():
            _flatten(f"{name}.{child}", item, known, flat, file, key)
    elif isinstance(value, list):
        if len(value) > len(children):
            raise BadInput(
                f"{len(value)} values given, expected at most {len(children)}", file=file, key=f"{key}.{name}"
            )
        for child, item in zip(children, value, strict=False):
            _flatten(child, item, known, flat, file, key)
    else:
        parts = ", ".join(child.removeprefix(name).lstrip(".") for child in children[:6])
        raise BadInput(
            f"{shown(value)} is one value, expected a mapping or list of {parts}", file=file, key=f"{key}.{name}"
        )


def _children(name: str, known: list[str]) -> list[str]:
    found: dict[str, None] = {}
    for full in known:
        if full.startswith(name) and full[len(name) : len(name) + 1] in (".", "["):
            rest = full[len(name) + 1 :]
            end = min((rest.index(mark) for mark in ".[" if mark in rest), default=len(rest))
            found[full[: len(name) + 1 + end]] = None
    return list(found)


def _roots(known: list[str]) -> str:
    roots = dict.fromkeys(name.split(".")[0].split("[")[0] for name in known)
    return ", ".join(roots)
