"""``apa reproduce`` with FMUs of any kind: the same signals to the bit, so the same rows."""

import numpy as np
import pytest

from orchestrator.simulation.cosim.fmu_files import default_kind, fmu_files
from orchestrator.studies.papers.drive import drive
from orchestrator.studies.papers.result import Drive

SHORT = ("zhang2022", "zhang2022-refused")


@pytest.mark.parametrize("name", [pytest.param(SHORT[0], marks=pytest.mark.release), SHORT[1]])
def test_python_fmus_record_the_same_bits(name: str) -> None:
    ours, theirs = drive(name), drive(name, fmu_files("python"), "python")
    assert ours.recording.t.tolist() == theirs.recording.t.tolist()
    assert set(ours.recording.signals) <= set(theirs.recording.signals)
    for signal, values in ours.recording.signals.items():
        assert np.array_equal(values, theirs.recording.signals[signal], equal_nan=True), signal


def test_the_default_is_the_fast_kind(by_default: Drive) -> None:
    assert default_kind() == "native"
    assert by_default(SHORT[1]).summary.reason == "no_path"
