"""Pictures on the disk."""

from pathlib import Path
from typing import Any

from fmus.files import whole
from orchestrator.inputs.text.errors import BadInput

METADATA: dict[str, dict[str, None] | None] = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    ".jpg": None,
}
"""Format -> metadata keys of matplotlib that are left out, so that equal figures give equal files."""
FORMATS = tuple(METADATA)


def check_picture(path: Path) -> None:
    """Raise ``BadInput`` if no picture can have this name."""
    if path.suffix.lower() not in FORMATS:
        raise BadInput(f"the name of a picture ends in one of {', '.join(FORMATS)}", file=path)


def save(figure: Any, path: Path, **how: Any) -> None:
    """Write a matplotlib figure, whole or not at all. Raises ``BadInput`` for a name that is no picture's."""
    check_picture(path)
    how.setdefault("metadata", METADATA[path.suffix.lower()])
    with whole(path) as part:
        figure.savefig(part, **how)
