"""Hook of mkdocs: every page that mkdocs.yml does not name goes under "Controllers", the READMEs too."""

import sys
from pathlib import Path
from typing import Any

sys.path[:0] = [str(Path(__file__).parent)]

from readmes import readmes  # noqa: E402

SECTION = "Controllers"


def on_config(config: Any) -> Any:
    """Return the configuration with the pages that are not named, in alphabetical order."""
    docs = Path(config["docs_dir"])
    named = set(_pages(config["nav"]))
    pages = {*(path.name for path in docs.glob("*.md")), *readmes()}
    more = sorted(name for name in pages if name not in named)
    for entry in config["nav"]:
        if SECTION in entry:
            entry[SECTION] = [*entry[SECTION], *more]
    return config


def _pages(nav: Any) -> list[str]:
    if isinstance(nav, str):
        return [nav]
    items = nav.values() if isinstance(nav, dict) else nav
    return [page for item in items for page in _pages(item)]
