"""Where shipped scenarios, cars and limits are, and how one is found by its name."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from orchestrator.inputs.text.errors import MIGRATE, BadInput, suggestion_or_choices, why_no_file
from orchestrator.inputs.text.renamed_names import SHIPPED_NAMES

LIBRARY = Path(__file__).parents[2] / "library"
"""Folder of the shipped scenarios, cars, sets of requirements, studies, standards and viewer layouts."""

ADVICE = {
    ".csv": "; a benchmark scene becomes a scenario by: apa import",
    ".json": "; a benchmark scene becomes a scenario by: apa import",
    ".mcap": "; a log is shown by: apa report, and judged by: apa check",
    ".fmu": "; a third-party FMU is tried by: apa fmu check, and used by: --controller or --vehicle",
    ".parquet": "; a row of a study is repeated by: apa replay",
}
"""Suffix of a file that is no scenario -> the command that takes it."""


def library_names(folder: str) -> list[str]:
    """Return the names of the shipped files in ``folder``, sorted."""
    return sorted(path.stem for path in (LIBRARY / folder).glob("*.yaml"))


def car_names() -> list[str]:
    """Return the names of the shipped cars, sorted."""
    return library_names("cars")


def find_file(
    name: str, folder: str, what: str, beside: Path, *, others: Iterable[str] = (), file: object = None, key: str = ""
) -> Path:
    """Return the file of a shipped name, or of a path relative to ``beside``.

    Raises ``BadInput`` with the ``file`` and the ``key`` that contain the name, if it stands in one; it suggests
    shipped names and ``others``.
    """
    place: dict[str, Any] = {"key": name} if file is None else {"file": file, "key": f"{key}: {name}", "at": key}
    if name.endswith((".yaml", ".yml", ".ssp")) or "/" in name or "\\" in name:
        path = beside / name
        if not path.is_file():
            raise BadInput(why_no_file(path), **place)
        return path.resolve()
    shipped = LIBRARY / folder / f"{name}.yaml"
    if shipped.is_file():
        return shipped
    suffix = Path(name).suffix
    if suffix and not suffix[1:].isdigit():
        raise BadInput(
            f"expected a {what}: a file .yaml or .ssp, or a name of `apa list {folder}`{ADVICE.get(suffix, '')}",
            **place,
        )
    now = SHIPPED_NAMES.get(folder, {}).get(name)
    if now:
        raise BadInput(f"no {what} of this name; it is called {now} now{MIGRATE}", **place)
    known = [*library_names(folder), *others]
    hint = suggestion_or_choices(name, known, listing=f"apa list {folder}")
    raise BadInput(f"no {what} of this name{hint}", **place)
