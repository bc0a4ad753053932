"""What falsification of an earlier parking system has found holds now: each run again in the compiled batch."""

from pathlib import Path

import pytest

from orchestrator.studies.falsification.counterexamples import rerun_counterexample

CORPUS = Path(__file__).parent / "regression"
OPEN = {"apa-world-contact-20261124-1", "apa-world-contact-4711-3"}
"""A pedestrian walks into a vehicle that stands and waits; a neighbour drives out beside one that backs in."""


@pytest.mark.parametrize("path", sorted(CORPUS.glob("*.yaml")), ids=lambda path: path.stem)
def test_what_was_found_holds(path: Path) -> None:
    again = rerun_counterexample(path)
    assert again.breaks == (path.stem in OPEN), again.words
