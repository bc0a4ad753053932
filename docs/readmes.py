"""Hook of mkdocs: the page of a controller is the README.md beside its code, ``controller_fmu/NAME/README.md``.

In the site it is NAME.md. Links from and to it are written for the repository and rewritten here for the site.
"""

import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent
FROM_README = re.compile(r"\]\(\.\./\.\./docs/")
BETWEEN_READMES = re.compile(r"\]\(\.\./(\w+)/README\.md")
FROM_DOCS = re.compile(r"\]\((?:\.\./)+controller_fmu/(\w+)/README\.md")


def readmes() -> dict[str, Path]:
    """Return the name of each page in the site -> the README that is its source."""
    return {f"{path.parent.name}.md": path for path in sorted((ROOT / "controller_fmu").glob("*/README.md"))}


def on_files(files: Any, config: Any) -> Any:
    """Return the files of the site with the READMEs of the controllers."""
    from mkdocs.structure.files import File

    for name, path in readmes().items():
        files.append(File.generated(config, name, content=path.read_text(encoding="utf-8")))
    return files


def on_page_markdown(markdown: str, page: Any = None, **_: Any) -> str:
    """Return the page with its links as they are in the site."""
    up = "../" * (page.file.src_uri.count("/") if page is not None else 0)
    text = FROM_README.sub("](", markdown)
    text = BETWEEN_READMES.sub(r"](\1.md", text)
    return FROM_DOCS.sub(rf"]({up}\1.md", text)
