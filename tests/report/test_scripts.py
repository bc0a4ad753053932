"""Scripts of the pages: every name is declared and used, types fit, and what else a linter finds."""

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from orchestrator.presentation.report import page as replay
from orchestrator.studies.live import page as live

BIOME = str(Path(sys.prefix) / "bin" / "biome")
"""The linter of the extra ``test``."""
TSC = Path(sys.prefix) / "scripts" / "node_modules" / "typescript" / "lib" / "tsc.js"
"""Where `make test` puts the TypeScript compiler."""
STRICT = ["--allowJs", "--checkJs", "--noEmit", "--skipLibCheck", "--strict", "--noImplicitAny", "false"]
NOW = ["--target", "es2022", "--lib", "es2023,dom,dom.iterable"]
AROUND = "declare const uPlot: any;\ninterface Window { replay: any; live: any; }\n"
SCRIPTS = {"replay": replay.scripts, "live": lambda: "\n".join(live.scripts())}


@pytest.mark.parametrize("name", SCRIPTS)
def test_the_linter_finds_nothing(name: Any, tmp_path: Path) -> None:
    shutil.copy(Path(__file__).parent / "biome.json", tmp_path)
    (tmp_path / f"{name}.js").write_text(SCRIPTS[name](), encoding="utf-8")
    command = [BIOME, "lint", f"--config-path={tmp_path}", f"{name}.js"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_linter_would_find_a_name_that_nobody_declared(tmp_path: Path) -> None:
    shutil.copy(Path(__file__).parent / "biome.json", tmp_path)
    (tmp_path / "wrong.js").write_text("window.one = nobody;\n", encoding="utf-8")
    done = subprocess.run([BIOME, "lint", f"--config-path={tmp_path}", "wrong.js"], cwd=tmp_path, capture_output=True)
    assert done.returncode != 0


def checked(folder: Any, scripts: dict[str, str]) -> Any:
    """Return what the TypeScript compiler says of scripts of pages, each apart from the others."""
    node = shutil.which("node") or pytest.skip("no node here")
    if not TSC.exists():
        pytest.skip("no TypeScript here")
    (folder / "around.d.ts").write_text(AROUND, encoding="utf-8")
    for name, script in scripts.items():
        (folder / f"{name}.js").write_text(f"(() => {{\n{script}\n}})();\n", encoding="utf-8")
    command = [node, str(TSC), *STRICT, *NOW, "around.d.ts", *(f"{name}.js" for name in scripts)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False).stdout


def test_types_fit(tmp_path: Path) -> None:
    assert checked(tmp_path, {name: script() for name, script in SCRIPTS.items()}) == ""


@pytest.mark.release  # tests the compiler's settings
@pytest.mark.parametrize("wrong", ["plots.hoover(1);", "plots.zoom(1, 2);", "moved(3, 1, 2);"])
def test_a_wrong_name_or_type_would_be_found(wrong: str, tmp_path: Path) -> None:
    bad = f"function bad(plots = new Plots({{}}, $('x'), bad, bad)) {{ {wrong} }}\nbad();"
    reported = checked(tmp_path, {"replay": f"{SCRIPTS['replay']()}\n{bad}"})
    assert "error TS" in reported
    assert reported.count("error TS") == 1
