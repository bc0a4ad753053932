"""One module per command, each with ``EXAMPLES``, ``add_arguments(parser)`` and ``run(arguments) -> exit code``."""

COMMANDS = {
    "build": "build Controller.fmu and Vehicle.fmu",
    "check": "judge a run by requirements",
    "compare": "compare two runs",
    "completion": "print what makes a shell complete apa's words",
    "export": "write other formats",
    "fmu": "check somebody's FMU before it is run",
    "hunt": "search a study's ranges for what breaks a requirement",
    "import": "make scenarios of scenes of others",
    "list": "list what is there: scenarios, parameters, signals, systems, limits",
    "live": "page that runs the models: drive, change, map",
    "new": "begin a controller or a vehicle of your own",
    "recover": "mend the log of a killed run",
    "replay": "repeat a row of a study",
    "report": "replay page of a run",
    "reproduce": "show a paper's numbers beside ours",
    "rerun": "repeat a run from its log alone",
    "run": "run a scenario",
    "sweep": "run a study of many runs",
    "test": "run and judge scenarios",
}
"""Command -> what it does. Its module is imported when it is chosen, so that ``apa --help`` imports none."""
STUDIES = {
    "apa-grid": "orchestrator.grid.study",
    "apa-out": "orchestrator.grid.out_study",
    "apa-world": "orchestrator.grid.world.study",
    "parking-world": "orchestrator.grid.parking_world.study",
    "bakeoff": "orchestrator.bakeoff.study",
    "guo2015-claim": "orchestrator.bakeoff.claim",
    "search-kpis": "orchestrator.grid.search_kpis",
    "valet-rows": "orchestrator.grid.slot_rows",
    "valet-slots": "orchestrator.grid.found_study",
}
"""Study that no file holds -> its module, with ``study(**whole numbers) -> Study`` and ``report(table, folder)``, which
says what the study makes of its table and returns an exit code."""
