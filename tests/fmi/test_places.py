"""Where what is built is kept, and that a C compiler works without a home folder."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import pytest

from fmus import cache_paths

ROOT = Path(__file__).parents[2]
SHOW = "from fmus.cache_paths import DIST; print(DIST)"


def shown(folder: Any, **environment: Any) -> Any:
    """Return DIST of the copy of fmus in ``folder``."""
    plain = {name: value for name, value in os.environ.items() if name not in ("APA_DIST", "XDG_CACHE_HOME")}
    found = {name: value for name, value in {**plain, "PYTHONPATH": str(folder), **environment}.items() if value}
    done = subprocess.run([sys.executable, "-c", SHOW], cwd="/", env=found, capture_output=True, text=True, check=True)
    return Path(done.stdout.strip())


@pytest.fixture
def installed(tmp_path: Path) -> Any:
    """A package that is no checkout."""
    folder = tmp_path / "site-packages"
    (folder / "fmus").mkdir(parents=True)
    for name in ("__init__.py", "cache_paths.py"):
        (folder / "fmus" / name).write_bytes((ROOT / "fmus" / name).read_bytes())
    return folder


def test_a_checkout_keeps_it_beside_the_sources() -> None:
    assert shown(ROOT) == ROOT / "fmus" / "dist"


def test_a_package_keeps_it_in_the_users_cache(installed: Any, tmp_path: Path) -> None:
    assert shown(installed, HOME=str(tmp_path), XDG_CACHE_HOME="") == tmp_path / ".cache" / "apa-cosim"
    assert shown(installed, XDG_CACHE_HOME=str(tmp_path / "c")) == tmp_path / "c" / "apa-cosim"
    assert not (installed / "fmus" / "dist").exists()


def test_a_variable_names_another_place(installed: Any, tmp_path: Path) -> None:
    assert shown(installed, APA_DIST=str(tmp_path / "mine")) == tmp_path / "mine"
    assert shown(ROOT, APA_DIST=str(tmp_path / "mine")) == tmp_path / "mine"


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="owners are those of POSIX")
def test_without_any_home_it_is_a_folder_of_ones_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(cache_paths, "__file__", str(tmp_path / "fmus" / "cache_paths.py"))
    monkeypatch.setattr(cache_paths, "user_cache_path", lambda *_, **__: Path("/proc/nothing"))
    monkeypatch.setattr(tempfile, "gettempdir", lambda: str(tmp_path))
    monkeypatch.setattr(cache_paths, "can_write", lambda path: str(path).startswith(str(tmp_path / "apa")))
    monkeypatch.delenv("APA_DIST", raising=False)
    folder = cache_paths.build_folder()
    assert folder == tmp_path / f"apa-cosim-{os.getuid()}"
    assert folder.stat().st_mode & 0o777 == 0o700
    folder.chmod(0o777)
    with pytest.raises(RuntimeError, match="belongs to another user; name a folder with APA_DIST"):
        cache_paths.build_folder()


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="owners are those of POSIX")
def test_a_folder_that_others_can_write_to_is_not_ones_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(os, "getuid", lambda: tmp_path.stat().st_uid or 1)
    tmp_path.chmod(0o755)
    assert cache_paths.is_own(tmp_path)
    tmp_path.chmod(0o777)
    assert not cache_paths.is_own(tmp_path)
    assert cache_paths.is_own(tmp_path / "not there")


def test_can_write_asks_the_nearest_folder_that_exists(tmp_path: Path) -> None:
    assert cache_paths.can_write(tmp_path / "a" / "b")
    assert not cache_paths.can_write(Path("/proc/1/a"))
    (tmp_path / "file").write_text("")
    assert not cache_paths.can_write(tmp_path / "file" / "below")


BUILD = """
import sys, toy_model
from pathlib import Path
from fmus.native.fmu import build
from fmus.native.platforms import host
print(build(toy_model.MODEL, Path(sys.argv[1]), [host()]))
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="HOME is POSIX's")
def test_the_compiler_works_without_a_home(tmp_path: Path) -> None:
    environment = {name: os.environ[name] for name in ("PATH",) if name in os.environ}
    environment |= {"PYTHONPATH": f"{ROOT}:{ROOT / 'tests' / 'fmi'}", "APA_DIST": str(tmp_path / "dist")}
    command = [sys.executable, "-c", BUILD, str(tmp_path)]
    subprocess.run(command, cwd=tmp_path, env=environment, check=True, timeout=300)
    assert (tmp_path / "Toy.fmu").is_file()
    assert (tmp_path / "dist" / "cache" / "zig").is_dir()
