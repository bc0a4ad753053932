"""The command ``apa``: finds the commands in ``orchestrator.commands`` and turns errors into exit codes."""

import argparse
import importlib
import pkgutil
import sys
from collections.abc import Sequence
from types import ModuleType

from rich.markup import escape

from orchestrator import commands
from orchestrator.session.terminal import BAD_INPUT, INTERRUPTED, NOT_PARKED, console
from orchestrator.text.errors import BadInput, RunError

DESCRIPTION = "Automated parking as a pair of FMI 2.0 co-simulation FMUs."
EPILOG = """examples:
  apa list                                     what can be run
  apa run guo2015-case4                        log, figure and summary in runs/guo2015-case4
  apa run guo2015-case4 --set controller.ntbpt.k4=3 --fmus none
  apa recover runs/guo2015-case4/run.mcap.part

exit codes: 0 parked or done, 1 not parked, 2 bad input, 130 interrupted
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Return the exit code of one command line."""
    parsed = parser().parse_args(arguments)
    try:
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


def parser() -> argparse.ArgumentParser:
    """Return the parser with all commands."""
    top = argparse.ArgumentParser(
        prog="apa", description=DESCRIPTION, epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    subparsers = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for module in command_modules():
        subparser = module.add_parser(subparsers)
        subparser.formatter_class = argparse.RawDescriptionHelpFormatter
        subparser.set_defaults(run=module.run)
    return top


def command_modules() -> list[ModuleType]:
    """Return the modules of all commands, in alphabetical order."""
    names = sorted(module.name for module in pkgutil.iter_modules(commands.__path__))
    return [importlib.import_module(f"{commands.__name__}.{name}") for name in names]


def _complain(text: str) -> None:
    console(sys.stderr).print(f"[bold red]apa:[/] {escape(text)}", soft_wrap=True)


if __name__ == "__main__":
    sys.exit(main())
