"""A study from its file: scenario, design, measures and limits, all checked."""

from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

from modelkit.signal import Signal
from modelkit.variables import Variable, variables
from orchestrator.evaluation.verdict.measures import Measure
from orchestrator.inputs.scenario.load_scenario import requirements_of
from orchestrator.inputs.scenario.requirements import Requirement
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.quantities import scalar
from orchestrator.session.foreign import ImportedFmus, load_bound_scenario
from orchestrator.studies.sweep.fields import SCENARIO_FIELDS
from orchestrator.studies.sweep.study.design import Design
from orchestrator.studies.sweep.study.sampling import make_design
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.study.study_file import MOST_RUNS, Runs, StudyFile, load_study

PROBE_SEED = 1_000_003
"""A seed that no scenario has, to find out what follows the seed."""


def read_study(name: str, sets: Mapping[str, str], others: Iterable[str] = ()) -> Study:
    """Return the study called ``name`` or written in the file ``name``, changed by ``sets``. Raises ``BadInput``.

    ``seed`` and ``runs`` (how many samples) are the study's own, every other key the scenario's; ``others`` are names
    of studies without a file.
    """
    file, path = load_study(name, others)
    further = {key: value for key, value in sets.items() if key not in ("seed", "runs")}
    seed = scalar(sets.get("seed", file.seed), SCENARIO_FIELDS["seed"], file="--set")
    runs = _with_samples(file.runs, scalar(sets["runs"], RUNS, file="--set")) if "runs" in sets else file.runs
    changed = file.model_copy(update={"seed": seed, "runs": runs, "set": {**file.set, **further}})
    return bind(changed, path, own=file.set.keys() - further.keys())


RUNS = Variable("runs", int, Signal("1", "samples of a study", 1, MOST_RUNS), 1)


def _with_samples(runs: Runs, n: Any) -> Runs:
    """Return a study's runs with ``n`` samples in the place of its own number. Raises ``BadInput`` if it has none."""
    drawn = {
        kind: samples.model_copy(update={"n": n})
        for kind, samples in (("monte_carlo", runs.monte_carlo), ("latin_hypercube", runs.latin_hypercube))
        if samples is not None
    }
    if not drawn:
        raise BadInput("the study has a grid alone: nothing is drawn", key="--runs")
    return runs.model_copy(update=drawn)


def bind(file: StudyFile, path: Path | None = None, own: Collection[str] = ()) -> Study:
    """Return the study that a file means; ``own``: keys of its ``set`` that it contains itself. Raises ``BadInput``."""
    sets = [f"{key}={value}" for key, value in file.set.items()]
    try:
        scenario = load_bound_scenario(file.scenario, sets, ImportedFmus()).scenario
    except BadInput as error:
        text = str(error).removeprefix("--set: ")
        if text != str(error) and text.partition(":")[0] in own:
            raise BadInput(text, file=path, at=f"set.{text.partition(':')[0]}") from None
        raise
    design = make_design(file, scenario, path)
    content = file.model_dump(mode="json", by_alias=True)
    measures = {
        name: Measure(how, signal)  # type: ignore[arg-type]
        for name, item in file.measures.items()
        for how, signal in item.model_dump(exclude_none=True).items()
    }
    within = {
        name: [Requirement(**item) for item in requirements_of(given, Path.cwd(), path, f"within.{name}")]
        for name, given in file.within.items()
    }
    return Study(scenario, design, content, _seed_parameters(file.scenario, sets, design), measures, within)


def _seed_parameters(scenario: str, sets: list[str], design: Design) -> list[tuple[str, str, int]]:
    """Return the parameters that take the run's seed: those that follow the scenario's."""
    probed = load_bound_scenario(scenario, [*sets, f"seed={PROBE_SEED}"], ImportedFmus()).scenario
    varied = {field.key for field in design.fields}
    return [
        (owner, variable.name, place)
        for owner, model in probed.models.items()
        for place, variable in enumerate(variables(model.params))
        if getattr(probed, owner).get(variable.name) == PROBE_SEED and f"{owner}.{variable.name}" not in varied
    ]
