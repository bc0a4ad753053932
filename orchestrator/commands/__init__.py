"""One module per command, each with ``EXAMPLES``, ``add_arguments(parser)`` and ``run(arguments) -> exit code``."""

COMMANDS = {
    "bench": "benchmark: plan and drive public scenes, as one table",
    "build": "build Controller.fmu and Vehicle.fmu",
    "check": "evaluate a run by requirements",
    "compare": "compare two runs",
    "export": "write other formats",
    "fmu": "check compatibility of a third-party FMU",
    "falsify": "falsification: search a study's ranges for violations of a requirement",
    "identify": "identify parameters of the vehicle from a log",
    "import": "import benchmark scenes as scenarios",
    "list": "list scenarios, parameters, signals, controllers, cars, requirements, studies, runs",
    "live": "write a page that runs the models in the browser",
    "migrate": "rewrite names of an earlier version in scenarios, studies and tests",
    "new": "create a controller, vehicle, scenario, study or CI workflow",
    "recover": "repair an incomplete log",
    "replay": "repeat a row of a study",
    "report": "replay page of a run",
    "reproduce": "compare the numbers of a paper with the simulation",
    "rerun": "repeat a run from its log alone",
    "run": "run a scenario",
    "sweep": "run a study of many runs",
    "test": "run scenarios and evaluate their requirements",
}
"""Command -> what it does. Its module is imported when it is chosen, so that ``apa --help`` imports none."""
STUDIES = {
    "apa-grid": "orchestrator.studies.parking.study",
    "apa-out": "orchestrator.studies.parking.pull_out_study",
    "apa-world": "orchestrator.studies.parking.world.study",
    "parking-world": "orchestrator.studies.parking.parking_world.study",
    "bakeoff": "orchestrator.studies.bakeoff.study",
    "guo2015-claim": "orchestrator.studies.bakeoff.claim",
    "valet-slots": "orchestrator.studies.parking.detected_slot_study",
}
"""Study that no file holds -> its module, with ``study(**whole numbers) -> Study`` and ``report(table, folder)``, which
says what the study makes of its table and returns an exit code."""
