"""FMUs that crash, hang, leave or refuse: one verdict each, said in the words of the field, and the others go on."""

import os
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path
from typing import Any

import pytest

from orchestrator.cli import main
from orchestrator.presentation.log.read_log import read_log
from orchestrator.simulation.cosim.fmu_files import ROOT
from tests.orchestrator import bad_fmus, foreign_fmus

EACH_CHANGE = ("step-print", "step-threads", "terminate-crash", "terminate-hang")
"""Those of ``bad_fmus.HARMLESS`` that are tried on each change."""
SCENARIO = """
name: {name}
extends: guo2015-case4
stop_time: 0.3
expected_outcome: not_parked
requirements: []
system:
  components: {{bad: {file}}}
  connections: {{vehicle.advised_speed: bad.y, bad.u: vehicle.speed}}
"""


def scenario(folder: Path, fmu: Path) -> str:
    path = folder / f"{fmu.stem}.yaml"
    path.write_text(SCENARIO.format(name=fmu.stem, file=fmu))
    return str(path)


def alive() -> list[str]:
    """Return the workers that are still there."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes().split(b"\0")
            if b"imported.worker" in b" ".join(words) and (folder / "stat").read_text().split()[3] == str(os.getpid()):
                found.append(folder.name)
        except OSError:
            continue
    return found


def test_a_gallery_of_bad_fmus(tmp_path: Path) -> None:
    """All in one test of a suite, in a process that must outlive them; a good one before and after."""
    found = bad_fmus.gallery(tmp_path)
    assert len(found) >= 15
    good = bad_fmus.behaving(tmp_path, "good")
    other = bad_fmus.behaving(tmp_path, "good too")
    names = [scenario(tmp_path, path) for path in (good, *found, other)]
    command = [sys.executable, "-m", "orchestrator", "test", *names, "--fmus", "none", "--timeout", "3", "-j", "4"]
    done = subprocess.run([*command, "--out", str(tmp_path / "out")], capture_output=True, text=True, check=False)
    assert "Traceback" not in done.stderr
    assert f"2 of {len(found) + 2} scenarios passed" in done.stdout
    root: Any = ElementTree.parse(tmp_path / "out" / "junit.xml").getroot()
    suites = {suite.get("name"): suite for suite in root}
    said = {}
    for path, text in found.items():
        (error,) = suites[path.stem].findall("testcase/error")
        said[path.stem] = (error.get("message"), text)
    assert {name: pair for name, pair in said.items() if pair[1] not in pair[0]} == {}
    assert suites[good.stem].get("errors") == suites[other.stem].get("errors") == "0"
    assert not (tmp_path.parent / "evil.txt").exists()


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in EACH_CHANGE else pytest.mark.release) for name in bad_fmus.HARMLESS]
)
def test_what_an_fmu_prints_or_does_at_its_end_harms_no_run(
    name: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = scenario(tmp_path, bad_fmus.behaving(tmp_path, name))
    out = tmp_path / "out"
    assert main(["test", path, "--fmus", "none", "--timeout", "3", "--out", str(out)]) == 0
    assert "nobody asked for" not in capfd.readouterr().out
    assert read_log(out / name / "run.mcap").t[-1] == pytest.approx(0.3)
    assert alive() == []


def test_after_an_error_the_process_is_gone(tmp_path: Path) -> None:
    for name, code in (("step-hang", 1), ("step-crash", 1), ("load-hang", 2)):
        path = scenario(tmp_path, bad_fmus.behaving(tmp_path, name))
        words = ["run", path, "--fmus", "none", "--timeout", "3", "--out", str(tmp_path / name), "-q", "--no-page"]
        assert main(words) == code
    assert alive() == []


def test_several_at_a_time_give_the_same_verdicts_in_the_same_order(tmp_path: Path) -> None:
    names = ["step-hang", "good", "step-crash", "load-hang", "step-exit", "step-fatal"]
    paths = [scenario(tmp_path, bad_fmus.behaving(tmp_path, name)) for name in names]
    verdicts = []
    for jobs in ("1", "4"):
        out = tmp_path / jobs
        words = ["test", *paths, "--fmus", "none", "--timeout", "2", "--out", str(out), "-j", jobs, "-q"]
        assert main(words) == 2  # one cannot be loaded
        root: Any = ElementTree.parse(out / "junit.xml").getroot()
        verdicts.append([(suite.get("name"), [case.get("message") for case in suite.iter("error")]) for suite in root])
        reported = {item.get("name"): item.get("value") for item in root[1].iter("property")}
        assert reported["bad"].startswith(f"{tmp_path / 'good.fmu'}, SHA-256 ")
        assert reported["vehicle"].startswith(f"{ROOT}, SHA-256 ")
    assert verdicts[0] == verdicts[1]
    assert [name for name, _ in verdicts[0]] == names


def test_a_hang_takes_its_limit_of_time_and_no_more(tmp_path: Path) -> None:
    path = scenario(tmp_path, bad_fmus.behaving(tmp_path, "step-hang"))
    begun = time.monotonic()
    main(["run", path, "--fmus", "none", "--timeout", "0.5", "--out", str(tmp_path / "out"), "-q", "--no-page"])
    assert 0.5 < time.monotonic() - begun < 8.0


def test_the_log_of_a_crash_is_whole(tmp_path: Path) -> None:
    path = scenario(tmp_path, bad_fmus.behaving(tmp_path, "step-crash"))
    main(["run", path, "--fmus", "none", "--out", str(tmp_path / "out"), "-q", "--no-page"])
    log = read_log(tmp_path / "out" / "run.mcap")
    assert log.t[-1] == pytest.approx(0.05)
    assert log.info["end"]["reason"].startswith("error: bad crashed in the step at 0.05 s")


@pytest.mark.parametrize(
    ("line", "advice"),
    [
        ("type type type", "is not for Python 3."),
        ("import absent_package", "imports absent_package: install it in the Python of apa"),
        ("raise ImportError('this FMU needs Python 3.99 or later')", "is not for Python 3."),
    ],
)
def test_a_python_fmu_of_another_python_says_what_it_needs(
    line: str, advice: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    script = foreign_fmus.controller(tmp_path)
    with zipfile.ZipFile(script) as source, zipfile.ZipFile(tmp_path / "other.fmu", "w") as target:
        for name in source.namelist():
            data = source.read(name)
            target.writestr(name, line.encode() + b"\n" + data if name.endswith("theirs.py") else data)
    words = ["run", "guo2015-case4", "--fmus", "none", "--no-page", "--out", str(tmp_path / "run")]
    assert main([*words, "--controller", str(tmp_path / "other.fmu")]) == 2
    said = capsys.readouterr().err
    assert "cannot be instantiated" in said
    assert advice in said
