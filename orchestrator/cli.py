"""The command ``apa``: imports the command that is chosen and turns errors into exit codes."""

import argparse
import gc
import io
import os
import shlex
import stat
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stdout, suppress
from importlib.abc import MetaPathFinder
from os import devnull
from typing import Any

from orchestrator.commands import COMMANDS
from orchestrator.inputs.text.command_parser import CommandParser
from orchestrator.inputs.text.ends import interrupt_within_limit
from orchestrator.inputs.text.errors import SCARCE_RESOURCES, lacks_resources

DESCRIPTION = "Automated parking as a pair of FMI co-simulation FMUs (2.0 and 3.0)."
EPILOG = """examples:
  apa list                                     what can be run
  apa run guo2015-case4                        log, figure and summary in runs/guo2015-case4
  apa run guo2015-case4 --set controller.guo2015.k4=3 --fmus none
  apa list parameters steering                 names, defaults, units and ranges
  apa recover runs/guo2015-case4/run.mcap.part

exit codes: 0 passed or done, 1 evaluated and failed, 2 bad input, or a path that cannot be read or written,
3 internal error (the traceback is kept in a file), 130 interrupted
"""
BAD_INPUT, INTERNAL_ERROR = 2, 3
MIN_ADDRESS_SPACE = 256 << 20
PACKAGES_THAT_HANG = frozenset({"scipy", "pyarrow"})
PACKAGE_ADDRESS_SPACE = 1536 << 20
"""Below it, the native libraries of these packages hang or abort when memory is refused, instead of raising."""
SCARCE_TEXTS = ("Cannot allocate memory", "cannot allocate memory", "failed to map segment", "can't start new thread")
SPARING = {"OPENBLAS_NUM_THREADS": "1", "PYDANTIC_DISABLE_PLUGINS": "__all__"}
"""Set unless they are set: numpy's threads, that nothing here needs, take a tenth of a second to begin; to look for
plugins takes pydantic 20 ms."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Return the exit code of one command line."""
    if arguments is None:
        return _program()
    return _command(list(arguments))


def _program() -> int:
    """Return the exit code of this process. What is imported stays: to look through it for rubbish, again and again and
    once more at the end, takes a fifth of the time of a run.
    """
    gc.set_threshold(20_000, 20, 50)
    try:
        if _address_space() < MIN_ADDRESS_SPACE:
            text = f"the limit of memory (ulimit -v) is below the {MIN_ADDRESS_SPACE >> 20} MiB that apa needs"
            return _last_words(text, BAD_INPUT)
        if _address_space() < PACKAGE_ADDRESS_SPACE:
            sys.meta_path.insert(0, _RefusePackagesThatHang())
        return _command(sys.argv[1:])
    except (Exception, KeyboardInterrupt) as error:
        if _is_scarce(error):
            return _last_words(SCARCE_RESOURCES, BAD_INPUT)
        return _last_words(f"internal error, no verdict: {type(error).__name__}: {error}", INTERNAL_ERROR)
    finally:
        gc.freeze()


class _RefusePackagesThatHang(MetaPathFinder):
    """Raise ``MemoryError`` where a package would be imported that hangs when memory is scarce."""

    def find_spec(self, fullname: str, _path: object, _target: object = None) -> None:
        if fullname in PACKAGES_THAT_HANG:
            raise MemoryError


def _address_space() -> int:
    """Return how many bytes this process may address; many where the system has no limit."""
    try:
        import resource
    except ImportError:
        return 1 << 62
    soft, _ = resource.getrlimit(resource.RLIMIT_AS)
    return 1 << 62 if soft == resource.RLIM_INFINITY else int(soft)


def _is_scarce(error: BaseException | None) -> bool:
    """Return whether an error, or one that led to it, is for want of memory, files or threads."""
    seen: set[int] = set()  # an error raised again while its own consequence is handled leads to itself
    while error is not None and id(error) not in seen:
        seen.add(id(error))
        if lacks_resources(error) or any(text in str(error) for text in SCARCE_TEXTS):
            return True
        error = error.__cause__ or (None if error.__suppress_context__ else error.__context__)
    return False


def _last_words(text: str, code: int) -> int:
    """Write a line with what is imported already, as there may be no memory for more; return the exit code."""
    line = " ".join(text.split())[:500]
    with suppress(OSError):
        os.write(2, f"apa: {line}\n".encode(errors="backslashreplace"))
    return code


def _command(words: list[str]) -> int:
    for name, value in SPARING.items():
        os.environ.setdefault(name, value)
    os.environ["MPLBACKEND"] = "agg"  # a notebook's backend may be absent here, and nothing here opens a window
    _tolerant_streams()
    from orchestrator.inputs.text.console import printable_streams

    with printable_streams(), interrupt_within_limit() as interrupted:
        try:
            try:
                return _run(words)
            finally:
                sys.stdout.flush()
        except (Exception, KeyboardInterrupt) as error:
            if _is_scarce(error) and not interrupted.is_set():
                error = MemoryError() if not isinstance(error, OSError) else error
            from orchestrator.inputs.text.failures import exit_code_and_message

            code, line = exit_code_and_message(KeyboardInterrupt() if interrupted.is_set() else error, words)
            _complain(line)
            _let_go()
            return code


def _run(words: list[str]) -> int:
    parsed = parser().parse_args(words, argparse.Namespace(words=words))
    with _as_asked(parsed):
        try:
            return int(parsed.run(parsed))
        except SystemExit as error:
            from orchestrator.inputs.text.errors import BadInput

            raise BadInput(f"code of a model, or of a study, ended the program (SystemExit: {error.code})") from error


def _tolerant_streams() -> None:
    """Let the command finish whatever becomes of its output: an undisplayable character is replaced, a closed stream or
    a pipe whose reader has ended discards the rest, and so does an error stream on a full disk.
    """
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, io.TextIOWrapper(io.FileIO(devnull, "w"), encoding="utf-8"))
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
            is_file = stream is sys.__stderr__ and not stream.isatty()
            if is_file or _is_pipe(stream):
                kind = _DiscardingFile if is_file else _DiscardingPipe
                raw = io.BufferedWriter(kind(stream.fileno(), "w", closefd=False))
                encoding = stream.encoding
                stream.flush()
                setattr(sys, name, io.TextIOWrapper(raw, encoding, "replace", line_buffering=name == "stderr"))


def _is_pipe(stream: io.TextIOWrapper) -> bool:
    """Return whether a stream of this process is a pipe or a socket, and not yet tolerant."""
    try:
        mode = os.fstat(stream.fileno()).st_mode
    except (OSError, ValueError):
        return False
    tolerant = isinstance(getattr(stream.buffer, "raw", None), _DiscardingPipe)
    return (stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode)) and not tolerant


class _DiscardingPipe(io.FileIO):
    """A pipe that discards what is written after its reader has ended, as ``| head`` does."""

    discards: type[OSError] = BrokenPipeError

    def write(self, data: Any) -> int:
        """Return the number of bytes taken, whether they are read or discarded."""
        try:
            return super().write(data)
        except self.discards:
            return memoryview(data).nbytes


class _DiscardingFile(_DiscardingPipe):
    """Standard error: progress and warnings that cannot be written do not end a study."""

    discards = OSError


def _let_go() -> None:
    """Give up what could not be written to standard output, so that the interpreter does not try again at its end."""
    try:
        sys.stdout.flush()
    except OSError:
        nowhere = os.open(devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


def parser() -> CommandParser:
    """Return the parser with the names of all commands; none is imported yet."""
    top = CommandParser(prog="apa", description=DESCRIPTION, epilog=EPILOG)
    top.add_argument("--version", action=_Version, nargs=0, help="print the version")
    top.set_defaults(apa=top)
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name, text in COMMANDS.items():
        commands.add_parser(name, help=text, description=text, module=f"orchestrator.commands.{name}")
    return top


class _Version(argparse.Action):
    """Prints the version and leaves; it is looked up only then, for that takes as long as all the rest."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from importlib.metadata import PackageNotFoundError, version

        try:
            print(f"apa-cosim {version('apa-cosim')}")
        except PackageNotFoundError:
            print("apa-cosim, not installed")
        parser.exit()


@contextmanager
def _as_asked(parsed: argparse.Namespace) -> Iterator[None]:
    """With ``--quiet`` nothing is printed but errors, and JSON if requested."""
    from orchestrator.inputs.text.console import COMMAND, QUIET
    from orchestrator.session.trust import trusting

    token = QUIET.set(parsed.quiet)
    COMMAND.set(shlex.join(["apa", *parsed.words]))
    try:
        with trusting("remember" if getattr(parsed, "trust", False) else "ask"):
            if parsed.quiet and not getattr(parsed, "json", False):
                with open(devnull, "w", encoding="utf-8") as nowhere, redirect_stdout(nowhere):
                    yield
            else:
                yield
    finally:
        QUIET.reset(token)


def _complain(text: str) -> None:
    if not text:
        return
    try:
        from rich.markup import escape
    except ImportError:
        _last_words(text, BAD_INPUT)
        return

    from orchestrator.inputs.text.console import console

    with suppress(OSError):
        console(sys.stderr).print(f"[bold red]apa:[/] {escape(text)}", soft_wrap=True)


if __name__ == "__main__":
    sys.exit(main())
