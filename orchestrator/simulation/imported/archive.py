"""The archive of an FMU, looked at before anything of it is unpacked or read: it may be anybody's."""

import hashlib
import os
import shutil
import stat
import sys
import zipfile
from pathlib import Path, PurePosixPath

from fmus.cache_paths import DIST
from fmus.contents.archive import DATE
from fmus.files import whole
from orchestrator.inputs.text.errors import BadInput, excerpt, format_value

BYTES_PER_GIB = 1 << 30
MOST_PACKED, MOST_UNPACKED, MOST_DESCRIPTION, MOST_FILES = BYTES_PER_GIB, 2 * BYTES_PER_GIB, 1 << 26, 50_000
"""Largest .fmu, all its files, its modelDescription.xml [bytes], and how many files."""
DESCRIPTION = "modelDescription.xml"
FOLDERS2 = {"linux": {"x86_64": "linux64", "aarch64": "aarch64-linux"}, "win32": {"AMD64": "win64"}}
SYSTEMS3 = {"linux": "linux", "win32": "windows", "darwin": "darwin"}
SUFFIXES = {"linux": ".so", "win32": ".dll", "darwin": ".dylib"}


def check_archive(path: Path) -> list[str]:
    """Return the names in an FMU's archive. Raises ``BadInput`` for one that must not be unpacked."""
    if not path.is_file():
        raise BadInput("no such file", file=path)
    if path.stat().st_size > MOST_PACKED:
        raise BadInput(f"is too large: {_size(path.stat().st_size)}, at most {_size(MOST_PACKED)}", file=path)
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
        raise BadInput(f"is not an FMU: {excerpt(error)}", file=path) from None
    total = sum(entry.file_size for entry in entries)
    if total > MOST_UNPACKED or len(entries) > MOST_FILES:
        most = f"at most {_size(MOST_UNPACKED)} in {MOST_FILES} files"
        raise BadInput(f"is too large: unpacked {_size(total)} in {len(entries)} files, {most}", file=path)
    for entry in entries:
        if _leaves(entry):
            raise BadInput(
                f"is not an FMU: {format_value(entry.filename)} would be written outside its folder", file=path
            )
    names = [entry.filename for entry in entries]
    if DESCRIPTION not in names:
        raise BadInput(f"is not an FMU: there is no {DESCRIPTION} in it", file=path)
    if next(entry for entry in entries if entry.filename == DESCRIPTION).file_size > MOST_DESCRIPTION:
        raise BadInput(f"is too large: its {DESCRIPTION}", file=path)
    return names


def pack(folder: Path) -> Path:
    """Return the archive of an FMU that lies there unzipped: the same files give the same archive, made once.

    Raises ``BadInput`` if it is no FMU, too large, or has links.
    """
    if not (folder / DESCRIPTION).is_file():
        raise BadInput(f"is a folder without {DESCRIPTION}, so no FMU", file=folder)
    files = {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*")) if not path.is_dir()}
    for name, path in files.items():
        if path.is_symlink() or not path.is_file():
            raise BadInput(f"is not an FMU: {format_value(name)} is no plain file", file=folder)
    total = sum(path.stat().st_size for path in files.values())
    if total > MOST_UNPACKED or len(files) > MOST_FILES:
        most = f"at most {_size(MOST_UNPACKED)} in {MOST_FILES} files"
        raise BadInput(f"is too large: {_size(total)} in {len(files)} files, {most}", file=folder)
    digest = hashlib.sha256()
    for name, path in files.items():
        digest.update(f"{name}\0{path.stat().st_size}\0".encode(errors="surrogateescape"))
        with path.open("rb") as stream:
            digest.update(hashlib.file_digest(stream, "sha256").digest())
    target = DIST / "unzipped" / digest.hexdigest()[:24] / f"{folder.resolve().name}.fmu"
    if not target.is_file():
        with whole(target) as part, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            for name, path in files.items():
                info = zipfile.ZipInfo(name, DATE)
                info.external_attr = (path.stat().st_mode & 0o777) << 16
                with path.open("rb") as stream, archive.open(info, "w", force_zip64=True) as into:
                    shutil.copyfileobj(stream, into)
    return target


def unpack(path: Path, folder: Path) -> None:
    """Write the files of an archive that was checked."""
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder)


def binary(names: list[str], identifier: str, version: int) -> str:
    """Return the name of the library for this machine in an archive. Raises ``ValueError`` with those there are."""
    machine = os.uname().machine if hasattr(os, "uname") else "AMD64"
    if version == 3:
        system = SYSTEMS3.get(sys.platform, sys.platform)
        folder = f"{machine.replace('AMD64', 'x86_64').replace('arm64', 'aarch64')}-{system}"
    else:
        folder = "darwin64" if sys.platform == "darwin" else FOLDERS2.get(sys.platform, {}).get(machine, machine)
    wanted = f"binaries/{folder}/{identifier}{SUFFIXES.get(sys.platform, '.so')}"
    if wanted in names:
        return wanted
    there = sorted({name.split("/")[1] for name in names if name.startswith("binaries/") and name.count("/") > 1})
    has = f"it has {', '.join(there)}" if there else "it has none"
    raise ValueError(f"has no binary for this machine ({wanted}); {has}")


def _leaves(entry: zipfile.ZipInfo) -> bool:
    """Return whether an entry would be written outside the folder, or is a link, which may point there."""
    name = entry.filename.replace("\\", "/")
    parts = PurePosixPath(name).parts
    is_link = stat.S_ISLNK(entry.external_attr >> 16)
    return is_link or name.startswith("/") or ".." in parts or (len(name) > 1 and name[1] == ":")


def _size(count: int) -> str:
    return f"{count / 1e9:.1f} GB" if count >= 1e8 else f"{count / 1e6:.1f} MB"
