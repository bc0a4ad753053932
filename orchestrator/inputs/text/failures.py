"""What a command says when it cannot go on, in one line, and with which code it ends."""

import errno
import os
import platform
import sys
import tempfile
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

from fmus.installation import missing_package
from modelkit.states import CannotComposeError
from orchestrator.inputs.text.console import say
from orchestrator.inputs.text.errors import (
    BAD_INPUT,
    INTERNAL_ERROR,
    INTERRUPTED,
    SCARCE_RESOURCES,
    BadInput,
    NotRunError,
    RunError,
    excerpt,
    format_value,
)

REPORT = "please file a bug with that file at the apa-cosim repository"
WORDS = {
    errno.ENOSPC: "the disk is full",
    errno.EROFS: "is on a disk that is read-only",
    errno.EACCES: "permission denied",
    errno.EPERM: "permission denied",
    errno.EISDIR: "is a folder, expected a file",
    errno.ENAMETOOLONG: "this name is too long",
    errno.ENOENT: "there is no such file or folder",
    errno.EAGAIN: "no more processes or threads are allowed (ulimit -u shows the limit)",
    errno.ENOMEM: SCARCE_RESOURCES,
    errno.EFBIG: "this file would be larger than is allowed (ulimit -f shows the limit)",
    errno.EMFILE: "too many open files (ulimit -n shows the limit)",
    errno.ELOOP: "too many levels of symbolic links (a cycle)",
}

OWN_PACKAGES = ("modelkit", "vehicle_fmu", "controller_fmu", "fmus", "orchestrator", "apa_cosim")
DISTRIBUTION_NAMES = {"distributed": "dask"}
"""Package of modules -> the requirement that brings it, where the names differ."""
WITHOUT_NAME = {
    errno.ENOSPC: "output: {}",
    errno.EIO: "output: {}",
    errno.EROFS: "a folder for temporary files or shared memory (/tmp, /dev/shm) {}",
    errno.EACCES: "a folder for temporary files or shared memory (/tmp, /dev/shm): {}",
}
"""What a text of ``WORDS`` is about where the system names no file."""


def exit_code_and_message(error: BaseException, words: Sequence[str]) -> tuple[int, str]:
    """Return the exit code for an error and the line that is said of it."""
    if isinstance(error, KeyboardInterrupt):
        return INTERRUPTED, "interrupted"
    if isinstance(error, BrokenPipeError):
        return BAD_INPUT, ""
    if isinstance(error, BadInput | RunError | NotRunError | CannotComposeError):
        return BAD_INPUT, str(error)
    if isinstance(error, OSError):
        return BAD_INPUT, place_of(error)
    if isinstance(error, UnicodeEncodeError):
        return (
            BAD_INPUT,
            f"{format_value(error.object)}: contains characters that cannot be encoded, and cannot be written",
        )
    if isinstance(error, MemoryError):
        return BAD_INPUT, SCARCE_RESOURCES
    if isinstance(error, RuntimeError) and _is_of_compiler(error):
        return BAD_INPUT, excerpt(" ".join(str(error).split()))
    if isinstance(error, ModuleNotFoundError):
        package = (error.name or "").partition(".")[0]
        extra = _extra_of(package)
        if extra:
            return BAD_INPUT, missing_package(package, extra)
        if package not in (*OWN_PACKAGES, *sys.stdlib_module_names):
            return BAD_INPUT, f"the package {package} is not installed: the installation of apa-cosim is incomplete"
    kept = _keep(error, words)
    return INTERNAL_ERROR, f"internal error, no verdict: {one_line(error)}; {kept}"


@contextmanager
def verdict_stands(what: str) -> Iterator[None]:
    """Report an unexpected failure while ``what`` (a page, a figure) is made of a run that was evaluated already.

    The run's verdict and exit code stand. Bad input, a place that cannot be written and Ctrl-C pass through.
    """
    try:
        yield
    except (BadInput, RunError, NotRunError, OSError, MemoryError):
        raise
    except Exception as error:
        kept = _keep(error, sys.argv[1:])
        say(f"apa: warning: {what} was not made, the verdict stands: {one_line(error)}; {kept}")


def reason_of(error: BaseException) -> str:
    """Return why a run could not take place, in one line."""
    if isinstance(error, NotRunError):
        return str(error.args[0]) if error.args else str(error)
    if isinstance(error, OSError):
        return place_of(error)
    return SCARCE_RESOURCES if isinstance(error, MemoryError) else one_line(error)


def place_of(error: OSError) -> str:
    """Return what is in the way of reading or writing a file, with its place."""
    if error.errno == errno.ENOENT and not _has_folder():
        return "the current folder is gone: it was deleted or moved; change to another"
    text = WORDS.get(error.errno or 0, error.strerror or str(error))
    if error.filename is None:
        return WITHOUT_NAME.get(error.errno or 0, "{}").format(text)
    path = Path(os.fsdecode(error.filename))
    if error.errno in (errno.ENOTDIR, errno.EEXIST):
        above = next((item for item in (path, *path.parents) if item.is_file()), None)
        return f"{path}: cannot be made anew" if above is None else f"{above}: is a file, expected a folder"
    place = format_value(str(path)) if error.errno == errno.ENAMETOOLONG else path
    return f"{place}: {text}"


def _has_folder() -> bool:
    """Return whether the current folder is still there."""
    try:
        os.getcwd()
    except OSError:
        return False
    return True


def one_line(error: BaseException) -> str:
    """Return an unexpected error in one line, with the place in our code where it came up."""
    text = " ".join(str(error).split())
    frames = traceback.extract_tb(error.__traceback__)
    ours = [item for item in frames if f"{os.sep}orchestrator{os.sep}" in item.filename] or frames
    place = f" ({Path(ours[-1].filename).name}:{ours[-1].lineno})" if ours else ""
    return f"{type(error).__name__}: {text[:200]}{place}"


def _keep(error: BaseException, words: Sequence[str]) -> str:
    """Write the traceback to a file; return what is said of it."""
    text = "".join(traceback.format_exception(error))
    about = f"apa {' '.join(words)}\nPython {platform.python_version()}, {platform.platform()}\n\n"
    name = f"error-{datetime.now():%Y%m%d-%H%M%S}-{os.getpid()}.txt"
    for folder in _folders():
        file = folder / name
        try:
            folder.mkdir(parents=True, exist_ok=True)
            file.write_text(about + text, encoding="utf-8", errors="backslashreplace")
        except (OSError, RuntimeError):
            continue
        return f"the traceback is in {file}; {REPORT}"
    print(text, file=sys.stderr)
    return "the traceback is above, as it could not be written to a file"


def _folders() -> list[Path]:
    from platformdirs import user_log_path

    return [user_log_path("apa-cosim", appauthor=False), Path(tempfile.gettempdir())]


def _is_of_compiler(error: RuntimeError) -> bool:
    from fmus.native.compilers import CompilerError

    return isinstance(error, CompilerError)


def _extra_of(package: str) -> str:
    """Return the extra of this project that brings a package of modules, empty if none does."""
    from importlib.metadata import PackageNotFoundError, requires
    from re import match

    try:
        needed = requires("apa-cosim") or []
    except PackageNotFoundError:
        return ""
    found = [match(r"([\w-]+).*extra == ['\"](\w+)['\"]", line.replace("_", "-")) for line in needed]
    top = DISTRIBUTION_NAMES.get(package, package).replace("_", "-")
    return next((item[2] for item in found if item and item[1].lower() in (top, f"{top}-sdk")), "")
