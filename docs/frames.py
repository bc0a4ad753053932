"""Hook of mkdocs: the page that is driven stands in a page of the site, with the sliders that matter there.

A page has a mark ``<!-- live: SCENARIO PARAMETER... -->``. What is loaded when it is scrolled to is
``reference/live.html``, which ``generate.py`` writes where a compiler is; for ``<!-- live apa: ...`` it is
``reference/live-apa.html``, the page of a controller apart.
"""

import re
from pathlib import Path
from typing import Any

REFERENCE = Path(__file__).parent / "reference"
MARK = re.compile(r"^<!-- live ?(\w*): (\S+) (.+) -->$", re.M)


def on_page_markdown(markdown: str, page: Any = None, **_: Any) -> str:
    """Return the page with its frames; without them where the page that is driven was not made."""
    up = "../" * (page.file.src_uri.count("/") if page is not None else 0)
    return MARK.sub(lambda match: frame(match[1], match[2], match[3].split(), up), markdown)


def frame(system: str, scenario: str, names: list[str], up: str = "") -> str:
    """Return a frame with ``scenario`` and sliders for the parameters ``names``; empty without its page."""
    page = f"live-{system}.html" if system else "live.html"
    if not (REFERENCE / page).exists():
        return ""
    source = f"{up}reference/{page}#s={scenario}&amp;only={','.join(names)}"
    return f'<iframe class="live" loading="lazy" title="Drive {scenario}" src="{source}"></iframe>'
