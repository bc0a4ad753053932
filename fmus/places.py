"""Where built FMUs, libraries and intermediate code are kept."""

from pathlib import Path

DIST = Path(__file__).parent / "dist"
LIBRARIES = DIST / "lib"
CACHE = DIST / "cache"
