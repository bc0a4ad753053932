"""A .fmu file whose bytes depend on its content alone: fixed order, fixed dates, GUID from a hash."""

import hashlib
import io
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path

from fmus.files import write_whole

DATE = (1980, 1, 1, 0, 0, 0)
DESCRIPTION = "modelDescription.xml"
LIBRARIES = (".so", ".dll", ".dylib")


def content_hash(files: Mapping[str, bytes]) -> str:
    """Return 64 hexadecimal digits that depend on every name and every byte, not on the order."""
    digest = hashlib.sha256()
    for name in sorted(files):
        for part in (name.encode(), files[name]):
            digest.update(len(part).to_bytes(8, "little"))
            digest.update(part)
    return digest.hexdigest()


def content_guid(files: Mapping[str, bytes]) -> str:
    """Return a GUID made of :func:`content_hash`; give it the description with an empty GUID among ``files``."""
    digits = content_hash(files)[:32]
    return "{" + "-".join((digits[:8], digits[8:12], digits[12:16], digits[16:20], digits[20:])) + "}"


def archive_bytes(files: Mapping[str, bytes]) -> bytes:
    """Return a deflated zip of ``files`` (path with slashes -> content), the description first."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name in sorted(files, key=lambda name: (name != DESCRIPTION, name)):
            info = zipfile.ZipInfo(name, DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.create_system = 3
            info.external_attr = (0o755 if name.endswith(LIBRARIES) else 0o644) << 16
            archive.writestr(info, files[name])
    return buffer.getvalue()


def write_archive(path: Path, files: Mapping[str, bytes]) -> Path:
    """Return ``path``, now the zip of ``files``; no reader ever sees half of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, archive_bytes(files))
    return path


def archive_guid(path: Path) -> str | None:
    """Return the GUID (FMI 3.0: instantiation token) of the FMU at ``path``, None if there is no readable one."""
    try:
        with zipfile.ZipFile(path) as archive:
            found = re.search(rb'(?:guid|instantiationToken)="([^"]*)"', archive.read(DESCRIPTION))
    except (OSError, KeyError, zipfile.BadZipFile):
        return None
    return found[1].decode() if found else None
