"""Where shipped scenarios, cars and limits are, and how one is found by its name."""

from pathlib import Path

from orchestrator.inputs.text.errors import MIGRATE, BadInput, suggestion_or_choices
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


def find_file(name: str, folder: str, what: str, beside: Path) -> Path:
    """Return the file of a shipped name, or of a path relative to ``beside``. Raises ``BadInput``."""
    if name.endswith((".yaml", ".yml", ".ssp")) or "/" in name or "\\" in name:
        path = beside / name
        if not path.is_file():
            raise BadInput("is a folder, expected a file" if path.is_dir() else "no such file", file=name)
        return path.resolve()
    file = LIBRARY / folder / f"{name}.yaml"
    if file.is_file():
        return file
    suffix = Path(name).suffix
    if suffix and not suffix[1:].isdigit():
        raise BadInput(
            f"expected a {what}: a file .yaml or .ssp, or a name of `apa list {folder}`{ADVICE.get(suffix, '')}",
            file=name,
        )
    now = SHIPPED_NAMES.get(folder, {}).get(name)
    if now:
        raise BadInput(f"no {what} of this name; it is called {now} now{MIGRATE}", key=name)
    known = library_names(folder)
    hint = suggestion_or_choices(name, known, listing=f"apa list {folder}")
    raise BadInput(f"no {what} of this name{hint}", key=name)
