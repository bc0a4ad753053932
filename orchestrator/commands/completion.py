"""``apa completion``: what makes a shell complete the words of ``apa``, made from the parsers themselves."""

import argparse
from typing import NamedTuple

from orchestrator.commands import STUDIES
from orchestrator.inputs.scenario.load_scenario import scenario_names
from orchestrator.inputs.text.command_parser import CommandParser
from orchestrator.studies.sweep.study.study_file import study_names

EXAMPLES = """examples:
  apa completion bash > ~/.local/share/bash-completion/completions/apa
  apa completion zsh > ~/.apa-completion && echo 'source ~/.apa-completion' >> ~/.zshrc
  apa completion fish > ~/.config/fish/completions/apa.fish

The script contains the commands and names of this version: print it again after an update.
"""
SHELLS = ("bash", "zsh", "fish")


def _studies() -> list[str]:
    return sorted([*study_names(), *STUDIES])


NAMES = {"scenario": scenario_names, "scenarios": scenario_names, "study": _studies}
"""What a positional argument can be, besides a file."""


class CommandWords(NamedTuple):
    """What can follow one command."""

    command: str
    options: list[str]
    values: dict[str, list[str]]
    """Option -> its choices."""
    names: list[str]
    """Formats, scenarios, studies."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("shell", choices=SHELLS, metavar="SHELL", help=", ".join(SHELLS))


def run(arguments: argparse.Namespace) -> int:
    """Print the script. Returns 0."""
    known = [words_of(name, sub) for name, sub in arguments.apa.subcommands()]
    if arguments.shell == "fish":
        print(fish(known))
    else:
        print(("autoload -U +X bashcompinit && bashcompinit\n" if arguments.shell == "zsh" else "") + bash(known))
    return 0


def words_of(name: str, parser: CommandParser) -> CommandWords:
    """Return what can follow the command ``name``."""
    parser.fill()
    options: list[str] = []
    values: dict[str, list[str]] = {}
    names: list[str] = []
    for action in parser._actions:
        choices = [str(choice) for choice in action.choices or ()]
        if action.help == argparse.SUPPRESS:
            continue
        if action.option_strings:
            options += action.option_strings
            values.update({option: choices for option in action.option_strings if choices})
        else:
            names += choices or (NAMES[action.dest]() if action.dest in NAMES else [])
    return CommandWords(name, options, values, names)


def bash(known: list[CommandWords]) -> str:
    """Return the script for bash; zsh understands it too, after ``bashcompinit``."""
    values = [
        f'        "{item.command} {option}") words="{" ".join(choices)}" ;;'
        for item in known
        for option, choices in item.values.items()
    ]
    lines = [
        "_apa() {",
        '    local word="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD-1]}" words=""',
        '    case "${COMP_WORDS[1]} $before" in',
        *values,
        '        *) case "${COMP_CWORD}-${COMP_WORDS[1]}" in',
        f'            1-*) words="{" ".join(item.command for item in known)}" ;;',
        *(f'            *-{item.command}) words="{" ".join(item.names + item.options)}" ;;' for item in known),
        "        esac ;;",
        "    esac",
        '    COMPREPLY=($(compgen -W "$words" -- "$word"))',
        "}",
        "complete -o default -F _apa apa",
    ]
    return "\n".join(lines)


def fish(known: list[CommandWords]) -> str:
    """Return the script for fish."""
    commands = " ".join(item.command for item in known)
    lines = [f"complete -c apa -f -n __fish_use_subcommand -a '{commands}'"]
    for item in known:
        start = f"complete -c apa -n '__fish_seen_subcommand_from {item.command}'"
        if item.names:
            lines.append(f"{start} -a '{' '.join(item.names)}'")
        for option in item.options:
            kind = "-l" if option.startswith("--") else "-s"
            more = f" -x -a '{' '.join(item.values[option])}'" if option in item.values else ""
            lines.append(f"{start} {kind} {option.lstrip('-')}{more}")
    return "\n".join(lines)
