"""What hunts of the parking assist have found holds now: each run again in the compiled batch."""

from pathlib import Path

import pytest

from orchestrator.studies.falsification.counterexamples import rerun_counterexample

CORPUS = Path(__file__).parent / "regression"


@pytest.mark.parametrize("path", sorted(CORPUS.glob("*.yaml")), ids=lambda path: path.stem)
def test_what_was_found_holds(path: Path) -> None:
    again = rerun_counterexample(path)
    assert not again.breaks, again.words
