"""Hook of mkdocs: every page of docs/ that mkdocs.yml does not name goes under "Models and laws"."""

from pathlib import Path
from typing import Any

SECTION = "Models and laws"


def on_config(config: Any) -> Any:
    """Return the configuration with the pages that were not named, in alphabetical order."""
    docs = Path(config["docs_dir"])
    named = set(_pages(config["nav"]))
    more = sorted(path.name for path in docs.glob("*.md") if path.name not in named)
    for entry in config["nav"]:
        if SECTION in entry:
            entry[SECTION] = [*entry[SECTION], *more]
    return config


def _pages(nav: Any) -> list[str]:
    if isinstance(nav, str):
        return [nav]
    items = nav.values() if isinstance(nav, dict) else nav
    return [page for item in items for page in _pages(item)]
