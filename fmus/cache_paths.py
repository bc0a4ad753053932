"""Where built FMUs, libraries and caches are kept.

In a checkout that can be written to: ``fmus/dist``. Else, as for a package in a read-only ``site-packages``, in the
user's cache folder. ``APA_DIST`` names another folder.
"""

import os
import tempfile
from pathlib import Path

from platformdirs import user_cache_path

VARIABLE = "APA_DIST"


def can_write(folder: Path) -> bool:
    """Return whether files can be made in ``folder``, or it in the nearest folder above that exists."""
    there = next(path for path in (folder, *folder.parents) if path.exists())
    return there.is_dir() and os.access(there, os.W_OK)


def build_folder() -> Path:
    """Return the folder for everything that is built."""
    named = os.environ.get(VARIABLE)
    if named:
        return Path(named).absolute()
    room = Path(__file__).parent
    if (room.parent / "pyproject.toml").is_file() and can_write(room / "dist") and is_own(room / "dist"):
        return room / "dist"
    own = user_cache_path("apa-cosim", appauthor=False)
    return own if can_write(own) and is_own(own) else _temporary()


def is_own(folder: Path) -> bool:
    """Return whether nobody but this user, or root, can put a library into ``folder``; root may use anybody's."""
    if not hasattr(os, "getuid") or not folder.exists():
        return True
    state = folder.stat()
    return os.getuid() == 0 or (state.st_uid in (os.getuid(), 0) and not state.st_mode & 0o002)


def _temporary() -> Path:
    """Return a folder of this user's alone, for a machine without home folder."""
    user = os.getuid() if hasattr(os, "getuid") else 0
    folder = Path(tempfile.gettempdir()) / f"apa-cosim-{user}"
    folder.mkdir(mode=0o700, exist_ok=True)
    if hasattr(os, "getuid") and (folder.stat().st_uid != user or folder.stat().st_mode & 0o022):
        raise RuntimeError(f"{folder} belongs to another user; name a folder with {VARIABLE}")
    return folder


DIST = build_folder()
LIBRARY_FOLDER = DIST / "lib"
CACHE_FOLDER = DIST / "cache"
