"""An argument parser that imports a command when it is chosen, and names the word that was meant."""

import argparse
import importlib
import sys
from collections.abc import Iterator
from typing import Any, NoReturn

from orchestrator.inputs.text.errors import BAD_INPUT, suggestion, suggestion_or_choices

SYNONYMS = {
    "plot": "report", "figure": "report", "show": "report", "view": "report",
    "simulate": "run", "start": "run", "validate": "fmu check", "inspect": "fmu check",
    "limits": "requirements", "systems": "controllers", "hunt": "falsify",
    "study": "sweep", "bakeoff": "sweep bakeoff", "evaluate": "check",
    "diff": "compare", "convert": "export", "init": "new", "create": "new", "repair": "recover",
}  # fmt: skip
"""What other tools call a command -> the command here."""


class CommandParser(argparse.ArgumentParser):
    """The parser of ``apa``, of a command, or of one of its formats.

    ``module`` holds the command: its ``EXAMPLES`` and what its ``add_arguments`` adds come when they are needed.
    """

    def __init__(self, *, module: str = "", **more: Any) -> None:
        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, **more)
        self._module = module

    def fill(self) -> None:
        """Import the command and add its arguments, once."""
        if not self._module:
            return
        command = importlib.import_module(self._module)
        self._module = ""
        self.epilog = command.EXAMPLES
        command.add_arguments(self)
        if hasattr(command, "run"):
            self.add_argument("-q", "--quiet", action="store_true", help="print only errors and --json")
            self.add_argument("--trust", action="store_true", help="trust this file's folder permanently")
            self.set_defaults(run=command.run)

    def subcommands(self) -> Iterator[tuple[str, "CommandParser"]]:
        """Return name and parser of each command, or format, below this one."""
        self.fill()
        for action in self._actions:
            if isinstance(action, argparse._SubParsersAction):
                yield from action.choices.items()

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Return the arguments found; one that is not known ends the program with the usage of this command."""
        self.fill()
        found, rest = super().parse_known_args(args, namespace)
        if rest:
            word = str(rest[0])
            known = self._option_string_actions if word.startswith("-") else ()
            self.error(f"{word}: unknown{suggestion(word.partition('=')[0], known)}")
        return found, rest

    def format_help(self) -> str:
        """Return the help, examples included."""
        self.fill()
        return super().format_help()

    def error(self, message: str) -> NoReturn:
        """Print usage and message, and leave with the exit code of bad input."""
        self.print_usage(sys.stderr)
        self.exit(BAD_INPUT, f"{self.prog}: {message}\n")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            names = [str(name) for name in action.choices]
            meant = SYNONYMS.get(str(value), "")
            hint = (
                f"; did you mean {meant}?" if meant.split(" ")[0] in names else suggestion_or_choices(str(value), names)
            )
            raise argparse.ArgumentError(action, f"{value}: unknown{hint}")
