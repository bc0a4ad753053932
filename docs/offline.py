"""Hook of mkdocs: the site asks nothing of any other host, its search included when it is opened from a folder.

The theme's plugin ``offline`` puts the index into a script, but fetches a stand-in for workers from elsewhere; it is
``worker.js`` here.
"""

import re
from typing import Any

ELSEWHERE = re.compile(r'<script src="https://[^"]*iframe-worker[^"]*"></script>')


REFERENCE = {"boost": 8}
"""Who looks for a name wants what it means before all places where it is used."""


def on_page_markdown(markdown: str, page: Any = None, **_: Any) -> str:
    """Return the page as it is; pages of the reference come first in the search."""
    if page is not None and page.file.src_uri.startswith("reference/"):
        page.meta.setdefault("search", REFERENCE)
    return markdown


def on_post_page(output: str, page: Any = None, **_: Any) -> str:
    """Return the page with the stand-in that lies beside it."""
    up = "../" * page.url.count("/") if page is not None else ""
    return ELSEWHERE.sub(f'<script src="{up}worker.js"></script>', output)
