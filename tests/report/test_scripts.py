"""Scripts of the pages: every name is declared and used, and what else a linter finds."""

import shutil
import subprocess
from pathlib import Path

import pytest

from orchestrator.live import page as live
from orchestrator.report import page as replay

SCRIPTS = {"replay": replay.scripts, "live": lambda: "\n".join(live.scripts())}


@pytest.mark.parametrize("name", SCRIPTS)
def test_the_linter_finds_nothing(name, tmp_path):
    biome = shutil.which("biome") or pytest.skip("no biome here")
    shutil.copy(Path(__file__).parent / "biome.json", tmp_path)
    (tmp_path / f"{name}.js").write_text(SCRIPTS[name](), encoding="utf-8")
    command = [biome, "lint", f"--config-path={tmp_path}", f"{name}.js"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_linter_would_find_a_name_that_nobody_declared(tmp_path):
    biome = shutil.which("biome") or pytest.skip("no biome here")
    shutil.copy(Path(__file__).parent / "biome.json", tmp_path)
    (tmp_path / "wrong.js").write_text("window.one = nobody;\n", encoding="utf-8")
    done = subprocess.run([biome, "lint", f"--config-path={tmp_path}", "wrong.js"], cwd=tmp_path, capture_output=True)
    assert done.returncode != 0
