"""The example notebook and the snippets of docs/python.md run from top to bottom."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

DOCS = Path(__file__).parents[2] / "docs"
CELLS = json.loads((DOCS / "notebook.ipynb").read_text(encoding="utf-8"))["cells"]
SNIPPETS = re.findall(r"^```python\n(.*?)^```", (DOCS / "python.md").read_text(encoding="utf-8"), re.S | re.M)


def test_the_notebook_runs_and_says_what_it_is_about(capsys: pytest.CaptureFixture[str]) -> None:
    names: dict[str, Any] = {}
    for cell in CELLS:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    said = capsys.readouterr().out
    assert "0.5 m/s: parked" in said
    assert "2.5 m/s: " in said
    assert names["run"]._repr_html_()


def test_the_notebook_is_kept_without_its_outputs() -> None:
    assert [cell for cell in CELLS if cell.get("outputs")] == []


@pytest.mark.parametrize("snippet", SNIPPETS)
def test_a_snippet_runs(
    snippet: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    if "sweep" in snippet:
        pytest.importorskip("pyarrow")
    monkeypatch.chdir(tmp_path)
    exec(snippet, {})
    assert capsys.readouterr().out
