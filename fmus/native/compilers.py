"""The C compiler: that of the package ``ziglang``, which serves all platforms, or this machine's own."""

import hashlib
import os
import re
import shlex
import shutil
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from fmus.cache_paths import CACHE_FOLDER, can_write
from fmus.children import PYTHON, run_child
from fmus.files import folder_for_a_while
from fmus.installation import install_command
from fmus.native.platforms import CompileTarget, host_target

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno")
"""Options of every compiler on which the results depend, or the speed."""
ZIG = ("-fno-sanitize=all", "-mllvm", "-disable-fp-call-folding")
"""Further options of ziglang's: its own library does not work out sin() of a known number, it has other bits."""
LINUX_ALONE = ("-nostdlib", "-lc")
"""Further options of ziglang's for Linux: to leave out its runtime, which nothing here calls; making it takes as long
as the models."""
SHARED = (
    *FLAGS,
    "-DFMI2_OVERRIDE_FUNCTION_PREFIX",
    "-DFMI3_OVERRIDE_FUNCTION_PREFIX",
    "-fvisibility=hidden",
    "-ffunction-sections",
    "-g0",
)
FRAME_REPORT = "-Wframe-larger-than=127"
"""Makes gcc and clang say how large each stack frame is, from 128 bytes on; it changes no byte of the result."""
FRAME = re.compile(r"\bframe size (?:of )?\(?(\d+)\)?")


class CompilerError(RuntimeError):
    """There is no C compiler, or it refuses."""


class CompilerOutput(NamedTuple):
    """What a compiler made."""

    content: bytes
    largest_frame: int
    """Largest stack frame of a function [bytes]; 0 if the compiler does not say, or none has 128 bytes."""


class Compiler(NamedTuple):
    """How a C compiler is called, and what it is, in the words that go into hashes."""

    command: tuple[str, ...]
    words: str
    """Its version, and the flags that it is always called with."""
    is_zig: bool

    def recipe(self, target: CompileTarget) -> str:
        """Return all that a shared library for ``target`` depends on, its files aside."""
        return " ".join((self.words, target.triple, *SHARED, *self._options(target)))

    def can_make(self, target: CompileTarget) -> bool:
        """Return whether it compiles for ``target``: ziglang's for all, others for this machine."""
        return self.is_zig or target.triple == host_target().triple

    def library(self, files: Mapping[str, str], unit: str, name: str, target: CompileTarget) -> bytes:
        """Return the shared library ``name`` made of the file ``unit`` among ``files``. Raises as :meth:`link`."""
        return self.link(files, [unit], name, target).content

    def link(self, files: Mapping[str, str], units: Sequence[str], name: str, target: CompileTarget) -> CompilerOutput:
        """Return what the files ``units`` among ``files`` become together.

        The work is done in a fresh directory with fixed file names, so that no path gets into the bytes.
        ``RuntimeError`` with the compiler's words if it refuses.
        """
        if not self.can_make(target):
            raise CompilerError(f"{self.command[0]} compiles for this machine only; others need --cc zig")
        with folder_for_a_while("c") as here:
            for file, text in files.items():
                (here / file).write_text(text, encoding="utf-8", newline="\n")
            text = self.run([*SHARED, FRAME_REPORT, "-o", name, *units, *self._options(target)], here, target)
            return CompilerOutput((here / name).read_bytes(), max(map(int, FRAME.findall(text)), default=0))

    def options_for_this_machine(self) -> tuple[str, ...]:
        """Return the options for a library that only this machine's processor needs to run; the bits are the same.

        A word for the processor is among them, so that another one does not take the library from a shared cache.
        """
        model = processor()
        if not model:
            return ("-O3",)
        word = hashlib.sha256(model.encode()).hexdigest()[:16]
        return ("-O3", "-mcpu=native" if self.is_zig else "-march=native", f"-DPROCESSOR_{word}")

    def _options(self, target: CompileTarget) -> tuple[str, ...]:
        alone = self.is_zig and "linux" in target.triple and "-shared" in target.options
        return (*target.options, *(LINUX_ALONE if alone else ()))

    def run(self, arguments: list[str], directory: Path, target: CompileTarget | None = None) -> str:
        """Return the warnings of the compiler, called in ``directory`` for ``target`` (default: this machine)."""
        cross = ["-target", (target or host_target()).triple, *ZIG] if self.is_zig else []
        command = [*self.command, *cross, *arguments]
        done = run_child(command, directory, _environment())
        if done.returncode:
            raise CompilerError(f"{shlex.join(command)}: {done.stderr.strip()}")
        return str(done.stderr)


def processor() -> str:
    """Return what this machine's processor is called and can do; empty where the system has no file for that."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return ""
    wanted = ("model name", "flags", "Features", "CPU part")
    return "\n".join(dict.fromkeys(line for line in text.splitlines() if line.startswith(wanted)))


def can_compile() -> bool:
    """Return whether there is a C compiler."""
    return bool(os.environ.get("CC")) or find_spec("ziglang") is not None


def find_compiler(cc: str | None = None) -> Compiler:
    """Return the compiler called ``cc``, else the one named by the variable CC, else ziglang's.

    ``RuntimeError`` says what to install if there is none.
    """
    named = cc or os.environ.get("CC")
    if named and named != "zig":
        try:
            return _system(tuple(shlex.split(named)))
        except ValueError as error:
            raise CompilerError(f"{named}: no command of a C compiler: {error}") from error
    from importlib.metadata import PackageNotFoundError, version

    try:
        words = " ".join(("ziglang", version("ziglang"), *ZIG))
    except PackageNotFoundError:
        raise CompilerError(
            f"there is no C compiler; run: {install_command('native')} (ziglang, compiles for all platforms), "
            "or set the variable CC to a C compiler of this machine"
        ) from None
    return Compiler((PYTHON, "-P", "-m", "ziglang", "cc"), words, True)


def _system(command: tuple[str, ...]) -> Compiler:
    if shutil.which(command[0]) is None:
        raise CompilerError(f"there is no C compiler called {command[0]}")
    done = run_child([*command, "--version"])
    return Compiler(command, (done.stdout or done.stderr).partition("\n")[0].strip(), False)


def _environment() -> dict[str, str]:
    """Return the environment, with a place for zig's cache where it would find none: HOME unset or read-only."""
    found = dict(os.environ)
    if os.name == "posix" and "ZIG_GLOBAL_CACHE_DIR" not in found:
        home = found.get("XDG_CACHE_HOME") or found.get("HOME")
        if not home or not can_write(Path(home)):
            found["ZIG_GLOBAL_CACHE_DIR"] = str(CACHE_FOLDER / "zig")
    return found
