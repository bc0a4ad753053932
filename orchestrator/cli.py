"""The command ``apa``: imports the command that is chosen and turns errors into exit codes."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stdout
from os import devnull
from typing import Any

from orchestrator.commands import COMMANDS
from orchestrator.commands.parser import CommandParser
from orchestrator.text.errors import BAD_INPUT, INTERRUPTED, NOT_PARKED, BadInput, RunError

DESCRIPTION = "Automated parking as a pair of FMI 2.0 co-simulation FMUs."
EPILOG = """examples:
  apa list                                     what can be run
  apa run guo2015-case4                        log, figure and summary in runs/guo2015-case4
  apa run guo2015-case4 --set controller.guo2015.k4=3 --fmus none
  apa list parameters steering                 names, defaults, units and ranges
  apa recover runs/guo2015-case4/run.mcap.part

exit codes: 0 parked or done, 1 not parked, 2 bad input or a place that cannot be read or written, 130 interrupted
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Return the exit code of one command line."""
    try:
        words = sys.argv[1:] if arguments is None else list(arguments)
        parsed = parser().parse_args(words, argparse.Namespace(words=words))
        with _as_asked(parsed):
            return int(parsed.run(parsed))
    except BadInput as error:
        _complain(str(error))
        return BAD_INPUT
    except RunError as error:
        _complain(str(error))
        return NOT_PARKED
    except KeyboardInterrupt:
        _complain("interrupted")
        return INTERRUPTED
    except BrokenPipeError:
        sys.stderr.close()
        return NOT_PARKED
    except ModuleNotFoundError as error:
        extra = _extra_of(error.name or "")
        if not extra:
            raise
        _complain(f"{error.name} is not installed; run: pip install 'apa-cosim[{extra}]'")
        return BAD_INPUT
    except OSError as error:
        place = f"{error.filename}: " if error.filename is not None else ""
        _complain(f"{place}{error.strerror or error}")
        return BAD_INPUT


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
    """With ``--quiet`` nothing is printed but errors, and JSON if that was asked for."""
    from orchestrator.text.console import QUIET

    token = QUIET.set(parsed.quiet)
    try:
        if parsed.quiet and not getattr(parsed, "json", False):
            with open(devnull, "w", encoding="utf-8") as nowhere, redirect_stdout(nowhere):
                yield
        else:
            yield
    finally:
        QUIET.reset(token)


def _extra_of(module: str) -> str:
    """Return the extra of this project that brings a package, empty if none does."""
    from importlib.metadata import PackageNotFoundError, requires
    from re import match

    try:
        needed = requires("apa-cosim") or []
    except PackageNotFoundError:
        return ""
    found = [match(r"([\w-]+).*extra == ['\"](\w+)['\"]", line.replace("_", "-")) for line in needed]
    top = module.partition(".")[0].replace("_", "-")
    return next((item[2] for item in found if item and item[1].lower() in (top, f"{top}-sdk")), "")


def _complain(text: str) -> None:
    from rich.markup import escape

    from orchestrator.text.console import console

    console(sys.stderr).print(f"[bold red]apa:[/] {escape(text)}", soft_wrap=True)


if __name__ == "__main__":
    sys.exit(main())
