"""A falsification prepared: who does the runs, where they are kept, whether it goes on."""

import argparse
import json
import shutil
from collections.abc import Mapping
from functools import partial
from pathlib import Path

from fmus.files import write_whole
from orchestrator.inputs.text.console import say
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.foreign import ImportedFmus, bind_parameters, fmu_of, parameters_of
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files, sources_hash
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.kinds import fastest_kind
from orchestrator.studies.falsification.objective import objective_of
from orchestrator.studies.falsification.subject import Subject
from orchestrator.studies.falsification.written import space_of
from orchestrator.studies.sweep.batch import compile_models, rows_by
from orchestrator.studies.sweep.engine import ChunkTask
from orchestrator.studies.sweep.engines import RECORDED_CHUNK, choose_task, make_engine
from orchestrator.studies.sweep.job import Chunk, Job, chunk_scenario
from orchestrator.studies.sweep.rows import row_of
from orchestrator.studies.sweep.store import different_keys
from orchestrator.studies.sweep.study.study import Study


def begin(study: Study, arguments: argparse.Namespace, out: Path) -> Subject:
    """Return the falsification. Raises ``BadInput``, also for runs of another falsification in the folder."""
    if study.scenario.system is not None:
        text = "a falsification runs our models, or with --controller one FMU in the place of ours; leave out"
        raise BadInput(text, file=study.scenario.file, key="system")
    if arguments.controller is not None:
        study = study._replace(goals=())
    objective, space = objective_of(study, arguments.requirement), space_of(study)
    journal = out / "journal"
    about = {
        "study": {**study.content},
        "objective": objective.name,
        "budget": arguments.budget,
        "seed": arguments.seed,
        "sources": sources_hash(),
        "controller": None if arguments.controller is None else str(arguments.controller.resolve()),
    }
    _open(journal, json.dumps(about, sort_keys=True, default=str), resume=arguments.resume)
    task = _task(study, arguments)
    subject = Subject(study, space, objective, make_engine(task, None, arguments.jobs), journal)
    if task.is_compiled:
        compile_models(tuple(subject.job.measures), study.scenario)
    return subject


def _open(journal: Path, about: str, *, resume: bool) -> None:
    """Make a journal, or go on with one of the same search; one that has not begun begins."""
    file = journal / "about.json"
    if resume and file.is_file():
        try:
            changed = different_keys(json.loads(file.read_bytes()), json.loads(about))
        except (ValueError, AttributeError):
            changed = ["description, which is damaged"]
        if changed:
            text = f"its runs were made with another {' and '.join(changed)}; without --resume the search begins anew"
            raise BadInput(text, file=journal, key="--resume")
        return
    shutil.rmtree(journal, ignore_errors=True)
    journal.mkdir(parents=True)
    write_whole(file, about)


def _task(study: Study, arguments: argparse.Namespace) -> ChunkTask:
    if arguments.controller is None:
        return choose_task(study.scenario, arguments.fmus)
    kind = arguments.fmus or fastest_kind()
    if kind != "none":
        fmu_files(kind, say)
    files = {"controller": str(fmu_of(str(arguments.controller)))}
    return ChunkTask(partial(run_foreign, files=files, kind=kind), "their controller", RECORDED_CHUNK, False)


def run_foreign(job: Job, chunk: Chunk, files: Mapping[str, str], kind: str) -> Array:
    """Return one row of measures per run of ``chunk`` with third-party FMUs; what they do not report is NaN.

    What they do not replace is our FMU of ``kind`` (``none``: our model in process).
    """
    foreign = ImportedFmus({name: Path(path) for name, path in files.items()})
    ours = {} if kind == "none" else fmu_files(kind)
    own = {instance: parameters_of(path, instance) for instance, path in foreign.files.items()}

    def row(number: int) -> Array:
        scenario, _ = bind_parameters(chunk_scenario(job, chunk, number), own)
        ran = run_scenario(scenario, ours, kind=kind, foreign=foreign)
        return row_of(ran.recording, scenario, job.measures)

    return rows_by(row, len(chunk.seeds))
