"""One module per command, each with ``EXAMPLES``, ``add_arguments(parser)`` and ``run(arguments) -> exit code``."""

COMMANDS = {
    "bakeoff": "compare the parking controllers",
    "build": "build Controller.fmu and Vehicle.fmu",
    "check": "judge a run by requirements",
    "compare": "compare two runs",
    "completion": "print what makes a shell complete apa's words",
    "export": "write other formats",
    "list": "list what is there: scenarios, parameters, signals, systems, limits",
    "recover": "mend the log of a killed run",
    "replay": "repeat a row of a study",
    "report": "replay page of a run",
    "reproduce": "show a paper's numbers beside ours",
    "run": "run a scenario",
    "study": "the parking assist over cars, slots, distances, headings and bodies",
    "sweep": "run a study of many runs",
    "test": "run and judge scenarios",
}
"""Command -> what it does. Its module is imported when it is chosen, so that ``apa --help`` imports none."""
