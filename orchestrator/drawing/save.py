"""Pictures on the disk."""

from pathlib import Path
from typing import Any

from fmus.files import whole
from orchestrator.text.errors import BadInput

FORMATS = (".png", ".svg", ".pdf", ".jpg")


def check_picture(path: Path) -> None:
    """Raise ``BadInput`` if no picture can have this name."""
    if path.suffix.lower() not in FORMATS:
        raise BadInput(f"the name of a picture ends in one of {', '.join(FORMATS)}", file=path)


def save(figure: Any, path: Path, **how: Any) -> None:
    """Write a matplotlib figure, whole or not at all. Raises ``BadInput`` for a name that is no picture's."""
    check_picture(path)
    with whole(path) as part:
        figure.savefig(part, **how)
