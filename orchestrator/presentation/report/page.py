"""One HTML file from a template and data: style, scripts and numbers inside, nothing fetched."""

import base64
import hashlib
import html
import re
from pathlib import Path

from orchestrator.presentation.drawing import palette

ROOM = Path(__file__).parent
VIEW = ("data.js", "show.js", "shapes.js", "scene.js", "scene_parts.js", "view.js")
"""What draws the top view, here and on the page that is driven."""
CURVES = ("timeline.js", "curves.js", "plot.js", "chooser.js", "plots.js", "sheet.js", "keep.js")
SCRIPTS = (*VIEW, *CURVES, "tables.js", "cards.js", "chart.js", "main.js")
UPLOT_FOLDER = ROOM / "third_party" / "uplot"


def page(title: str, data: str) -> str:
    """Return the page; ``title`` is plain text, ``data`` comes from ``payload.Arrays.pack``."""
    uplot = UPLOT_FOLDER / "uPlot.iife.min.js"
    licence = (UPLOT_FOLDER / "LICENSE").read_text(encoding="utf-8").strip()
    library = (
        f"/*!\nuPlot {(UPLOT_FOLDER / 'VERSION').read_text(encoding='utf-8').strip()}\n{licence}\n*/\n{_read(uplot)}"
    )
    script = f'(() => {{\n"use strict";\n{scripts()}\n}})();\n'
    parts = {
        "TITLE": html.escape(title),
        "POLICY": policy([library, script]),
        "STYLE": f"{_read(UPLOT_FOLDER / 'uPlot.min.css')}\n{style()}",
        "DATA": data,
        "LIBRARY": library,
        "SCRIPT": script,
    }
    return re.sub(r"@([A-Z]+)@", lambda match: parts[match[1]], _read(ROOM / "template" / "page.html"))


def scripts() -> str:
    """Return the page's own scripts."""
    return palette.script() + "\n".join(_read(ROOM / "template" / name) for name in SCRIPTS)


def policy(texts: list[str], more: str = "") -> str:
    """Return a content security policy: these scripts and inline style only, and no network at all.

    ``more``: what else scripts may do.
    """
    hashes = " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(item.encode()).digest()).decode()}'" for item in texts)
    return (
        f"default-src 'none'; script-src {hashes}{more}; style-src 'unsafe-inline'; img-src data:; form-action 'none'"
    )


STILL_PAGE = """<!doctype html>
<html lang="en" data-theme="auto">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>{style}</style>
</head>
<body>
{body}{script}</body>
</html>
"""
STILL_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


def still_page(title: str, body: str, more_style: str = "", script: str = "") -> str:
    """Return a page that loads nothing, with one script at most; ``title`` is plain text, ``body`` HTML."""
    parts = {
        "policy": policy([script]) if script else STILL_POLICY,
        "script": f"<script>{script}</script>" * bool(script),
    }
    return STILL_PAGE.format(title=html.escape(title), style=style() + more_style, body=body, **parts)


def style(more: str = "") -> str:
    """Return the style sheet and ``more``; the dark colours also hold where the system asks for dark."""
    style = _read(ROOM / "template" / "style.css") + more
    for mark, colours in (("@LIGHTCOLORS@", palette.LIGHT), ("@DARKCOLORS@", palette.DARK)):
        style = style.replace(mark, palette.css(colours))
    dark = re.search(r':root\[data-theme="dark"\] \{([^}]*)\}', style)
    assert dark is not None
    small = "".join(
        f':root[data-theme="auto"] {selector} {{{body}}}'
        for selector, body in re.findall(r':root\[data-theme="dark"\] ([^{}]+?) \{([^}]*)\}', style)
    )
    automatic = f'@media (prefers-color-scheme: dark) {{ :root[data-theme="auto"] {{{dark[1]}}} {small} }}'
    return style.replace("@DARK@", automatic)


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8")
