"""Where shipped scenarios, cars and limits are, and how one is found by its name."""

from pathlib import Path

from orchestrator.text.errors import BadInput, suggestion

ROOM = Path(__file__).parent.parent


def shipped(folder: str) -> list[str]:
    """Return the names of the shipped files in ``folder``, sorted."""
    return sorted(path.stem for path in (ROOM / folder).glob("*.yaml"))


def car_names() -> list[str]:
    """Return the names of the shipped cars, sorted."""
    return shipped("cars")


def find_file(name: str, folder: str, what: str, beside: Path) -> Path:
    """Return the file of a shipped name, or of a path relative to ``beside``. Raises ``BadInput``."""
    if name.endswith((".yaml", ".yml", ".ssp")) or "/" in name or "\\" in name:
        path = beside / name
        if not path.is_file():
            raise BadInput("is a folder, expected a file" if path.is_dir() else "no such file", file=name)
        return path.resolve()
    file = ROOM / folder / f"{name}.yaml"
    if file.is_file():
        return file
    known = shipped(folder)
    hint = suggestion(name, known) or f"; shipped are {', '.join(known) or 'none'}"
    raise BadInput(f"no {what} of this name{hint}", key=name)
