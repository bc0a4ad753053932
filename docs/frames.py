"""Hook of mkdocs: the page that is driven stands in a page of the site, with the sliders that matter there.

A page has a mark ``<!-- live: SCENARIO PARAMETER... -->``. What is loaded when it is scrolled to is
``reference/live.html``, which ``generate.py`` writes where a compiler is.
"""

import re
from pathlib import Path
from typing import Any

PAGE = Path(__file__).parent / "reference" / "live.html"
MARK = re.compile(r"^<!-- live: (\S+) (.+) -->$", re.M)


def on_page_markdown(markdown: str, page: Any = None, **_: Any) -> str:
    """Return the page with its frames; without them where the page that is driven was not made."""
    up = "../" * (page.file.src_uri.count("/") if page is not None else 0)
    return MARK.sub(lambda match: frame(match[1], match[2].split(), up) if PAGE.exists() else "", markdown)


def frame(scenario: str, names: list[str], up: str = "") -> str:
    """Return a frame with ``scenario`` and sliders for the parameters ``names``."""
    source = f"{up}reference/live.html#s={scenario}&amp;only={','.join(names)}"
    return f'<iframe class="live" loading="lazy" title="Drive {scenario}" src="{source}"></iframe>'
