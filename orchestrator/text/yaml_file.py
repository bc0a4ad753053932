"""Reading YAML so that a mistake in the file is one clear sentence."""

from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from orchestrator.text.errors import BadInput, suggestion


class _Loader(yaml.SafeLoader):
    """Safe YAML that refuses a key written twice."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[object] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if key in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"key {key!r} is written twice", key_node.start_mark
                )
            seen.add(key)
        return super().construct_mapping(node, deep)


def read_yaml(path: Path) -> Any:
    """Return the content of a YAML file. Raises ``BadInput`` with the line if it cannot be read."""
    try:
        return yaml.load(path.read_text(encoding="utf-8"), Loader=_Loader)
    except OSError as error:
        raise BadInput(f"cannot be read: {error.strerror}", file=path) from error
    except UnicodeDecodeError as error:
        raise BadInput("is not UTF-8 text", file=path) from error
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        problem = str(getattr(error, "problem", None) or error).replace("\n", " ")
        raise BadInput(f"{line}{problem}", file=path) from error


def read_mapping(path: Path) -> dict[str, Any]:
    """Return the mapping in a YAML file; an empty file is an empty mapping."""
    content = read_yaml(path)
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise BadInput("expected a mapping of keys to values", file=path)
    return {str(key): value for key, value in content.items()}


def explain(error: ValidationError, file: object, known: list[str]) -> BadInput:
    """Return pydantic's first complaint as one sentence with file, key, value and what would be right."""
    first = error.errors()[0]
    key = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in first["loc"]).lstrip(".")
    value = first.get("input")
    if first["type"] == "extra_forbidden":
        word = str(first["loc"][-1])
        names = known if len(first["loc"]) == 1 else []
        hint = suggestion(word, names) or (f"; known are {', '.join(names)}" if names else " here")
        return BadInput(f"unknown{hint}", file=file, key=key)
    if first["type"] == "missing":
        return BadInput("is missing", file=file, key=key)
    cause = first.get("ctx", {}).get("error")
    text = str(cause) if isinstance(cause, BadInput) else f"{value!r}: {first['msg'][0].lower()}{first['msg'][1:]}"
    return BadInput(text, file=file, key=key)
