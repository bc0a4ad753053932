"""The step tests of Guo 2015's system hold, for the models in process and for the native FMU."""

import shutil
from pathlib import Path

import pytest

from orchestrator.cli import main
from orchestrator.simulation.cosim.fmu_files import can_compile

TEST = Path(__file__).parent / "test_guo2015_manoeuvre.yaml"


@pytest.mark.parametrize("kind", ["none", "native"])
def test_each_transition_and_each_law(kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    if kind == "native" and not can_compile():
        pytest.skip("needs a C compiler")
    assert main(["test", str(TEST), "--fmus", kind, "--out", str(tmp_path)]) == 0, capsys.readouterr().out


def test_a_gain_that_is_otherwise_is_missed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = TEST.read_text(encoding="utf-8").replace(
        "  system: ntbptcwpt\n", "  system: ntbptcwpt\n  guo2015: {k3: 1.1}\n"
    )
    shutil.copy(TEST.with_name("guo2015_manoeuvre.csv"), tmp_path)
    changed = tmp_path / "changed.yaml"
    changed.write_text(text, encoding="utf-8")
    assert main(["test", str(changed), "--fmus", "none", "--out", str(tmp_path / "out")]) == 1
    assert "to Q2, right of the tangent: wheel" in capsys.readouterr().out
