"""Hook of mkdocs: the site asks nothing of any other host, its search included when it is opened from a folder.

The theme's plugin ``offline`` puts the index into a script, but fetches a stand-in for workers from elsewhere; it is
``worker.js`` here.
"""

import re
from typing import Any

ELSEWHERE = re.compile(r'<script src="https://[^"]*iframe-worker[^"]*"></script>')


BOOSTS = {"reference/vehicle.md": 2, "reference/controller.md": 2, "reference/": 0.3, "tables/": 0.3, "adr/": 0.3}
"""Start of a page's path -> its weight in the search: parameters before their uses, explanations before lists."""


def on_page_markdown(markdown: str, page: Any = None, **_: Any) -> str:
    """Return the page as it is, with its weight in the search."""
    path = page.file.src_uri if page is not None else ""
    boost = next((weight for start, weight in BOOSTS.items() if path.startswith(start)), None)
    if boost is not None:
        page.meta.setdefault("search", {"boost": boost})
    return markdown


def on_post_page(output: str, page: Any = None, **_: Any) -> str:
    """Return the page with the stand-in that lies beside it."""
    up = "../" * page.url.count("/") if page is not None else ""
    return ELSEWHERE.sub(f'<script src="{up}worker.js"></script>', output)
