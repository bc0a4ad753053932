"""What an FMU declares or takes without bounds: one line, exit code 2; and what a sandbox keeps from it."""

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from lxml import etree

from orchestrator.cli import main
from orchestrator.inputs.text.console import console, printable_streams
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.printable import CONTROL
from orchestrator.presentation.log.messages import read_messages
from orchestrator.simulation.cosim.model_description import read_description
from orchestrator.simulation.imported import worker
from orchestrator.simulation.imported.remote_instance import answer_of
from orchestrator.simulation.imported.sandbox import PROGRAM, sandbox_program
from orchestrator.simulation.system.signal_matching import _places_to_compare
from tests.fuzz.limits import ask
from tests.fuzz.received import DESCRIPTIONS, ODD
from tests.orchestrator import bad_fmus
from tests.orchestrator.c_fmus import THEIR, c_fmu
from tests.orchestrator.test_bad_fmus import alive, scenario

ROOT = Path(__file__).parents[2]

FMI3 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Bad" instantiationToken="1">
  <CoSimulation modelIdentifier="bad"/>
  <UnitDefinitions><Unit name="u"><BaseUnit m="1" factor="2.0"/></Unit></UnitDefinitions>
  <TypeDefinitions>
    <EnumerationType name="Mode"><Item name="OFF" value="1"/><Item name="ON" value="2"/></EnumerationType>
  </TypeDefinitions>
  <ModelVariables>
    <Float64 name="u" valueReference="0" causality="input" start="0" unit="u"/>
    <Float64 name="y" valueReference="1" causality="output"><Dimension start="3"/></Float64>
    <Enumeration name="mode" valueReference="2" causality="output" declaredType="Mode"/>
  </ModelVariables>
  <ModelStructure><Output valueReference="1"/><Output valueReference="2"/></ModelStructure>
</fmiModelDescription>
"""
DECLARED = {
    "negative dimension": ('start="3"', 'start="-1"'),
    "no dimension": ('start="3"', 'start="0"'),
    "large dimension": ('start="3"', 'start="2000000"'),
    "huge dimension": ('start="3"', 'start="1000000000000"'),
    "dimension in words": ('start="3"', 'start="many"'),
    "many dimensions": ('<Dimension start="3"/>', '<Dimension start="999"/>' * 9),
    "item in words": ('value="2"', 'value="abc"'),
    "large item": ('value="2"', 'value="99999999999"'),
    "infinite unit": ('factor="2.0"', 'factor="INF"'),
    "unit of nothing": ('factor="2.0"', 'factor="0"'),
    "large exponent": ('m="1"', 'm="1000000"'),
    "negative reference": ('valueReference="1"', 'valueReference="-1"'),
    "large reference": ('valueReference="1"', 'valueReference="99999999999"'),
    "reference in words": ('valueReference="1"', 'valueReference="one"'),
    "path as identifier": ('modelIdentifier="bad"', 'modelIdentifier="../../bad"'),
    "long identifier": ('modelIdentifier="bad"', f'modelIdentifier="{"b" * 300}"'),
    "long name": ('name="y"', f'name="{"y" * 100_000}"'),
    "deep name": ('name="y"', f'name="{"y." * 100}y"'),
    "control character in a name": ('name="y"', 'name="y&#x9b;31m"'),
    "direction of writing in a unit": ('unit="u"', 'unit="u&#x202e;"'),
    "long unit": ('unit="u"', f'unit="{"u" * 5000}"'),
    "long version": ('fmiVersion="3.0"', f'fmiVersion="{"3" * 5000}"'),
    "long causality": ('causality="input"', f'causality="{"i" * 5000}"'),
    "long factor": ('factor="2.0"', f'factor="{"f" * 5000}"'),
    "long token": ('instantiationToken="1"', f'instantiationToken="{"1" * 5000}"'),
    "start beyond 32 bits": (
        '<Enumeration name="mode" valueReference="2" causality="output"',
        '<UInt64 name="n" valueReference="9" causality="parameter" variability="fixed" start="5000000000"/>'
        '<Enumeration name="mode" valueReference="2" causality="output"',
    ),
    "start in words": ('causality="input" start="0"', f'causality="input" start="{"nothing" * 1000}"'),
}


def described(folder: Path, old: str, new: str) -> Path:
    assert old in FMI3
    path = folder / "bad.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", FMI3.replace(old, new))
    return path


def test_the_description_is_one_that_is_taken(tmp_path: Path) -> None:
    assert len(read_description(described(tmp_path, "Bad", "Good")).modelVariables) == 3


@pytest.mark.parametrize("kind", DECLARED)
def test_a_declaration_without_bounds_is_refused_in_one_line(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = described(tmp_path, *DECLARED[kind])
    assert main(["fmu", "check", str(path)]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"apa: {path}: ")
    assert said.count("\n") == 1
    assert len(said) < 600
    assert not CONTROL.search(said)


@pytest.mark.parametrize(
    "answer",
    [b"", b"M", b"1", b"{}", b"[1]", b'["a", 1]', b"[1, 2]", b"[true, 1]", b"[" * 60_000, b"\xff", b'[1e400, ""]'],
)
def test_what_is_no_answer_of_a_worker_is_not_taken_for_one(answer: bytes) -> None:
    for letter in (worker.MESSAGE, worker.REFUSED):
        with pytest.raises(worker.ForeignAnswerError):
            answer_of(letter, answer)


def test_a_flood_of_messages_ends_with_a_line_that_says_so(tmp_path: Path) -> None:
    path = scenario(tmp_path, bad_fmus.behaving(tmp_path, "step-flood"))
    assert main(["run", path, "--fmus", "none", "--out", str(tmp_path / "out"), "-q", "--no-page"]) in (0, 1)
    from orchestrator.presentation.log.line import MAX_LINES

    lines = [line for line in read_messages(tmp_path / "out" / "run.mcap") if line.name == "bad"]
    assert len(lines) <= worker.MAX_MESSAGES <= MAX_LINES
    assert lines[0].text == "tick"


@pytest.mark.parametrize(
    ("name", "options", "said"),
    [
        ("step-slow", ["--run-timeout", "2"], "bad took more than 2 s in all "),
        ("step-memory", ["--fmu-memory", "300MB"], "bad failed at 0.05 s: no memory"),
        ("step-escape", [], "x1b[2J"),
    ],
)
def test_a_run_has_limits_and_a_terminal_is_left_alone(
    name: str, options: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if name == "step-memory" and sys.platform != "linux":
        pytest.skip("memory is limited on Linux only")
    path = scenario(tmp_path, bad_fmus.behaving(tmp_path, name))
    assert main(["run", path, "--fmus", "none", "--out", str(tmp_path / "out"), "--no-page", *options]) in (1, 2)
    out, err = capsys.readouterr()
    assert said in out + err
    assert "\x1b" not in out + err


def has_sandbox() -> bool:
    try:
        return sys.platform == "linux" and bool(sandbox_program())
    except BadInput:
        return False


@pytest.mark.skipif(not has_sandbox(), reason="bubblewrap is not here, or may not be used")
@pytest.mark.parametrize("name", ["step-parent", "step-writes"])
def test_a_sandbox_keeps_an_fmu_from_its_parent_and_from_files(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    evil = tmp_path / "evil"
    monkeypatch.setenv("EVIL", str(evil))
    path = scenario(tmp_path, bad_fmus.behaving(tmp_path, name))
    words = ["run", path, "--fmus", "none", "--out", str(tmp_path / "out"), "--no-page", "-q", "--sandbox"]
    ran = subprocess.run([sys.executable, "-m", "orchestrator", *words], timeout=100, check=False)
    assert ran.returncode in (0, 1)
    assert not evil.exists()
    assert not Path("/tmp/apa-evil").exists()


def test_without_bubblewrap_a_sandbox_is_refused_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    sandbox_program.cache_clear()
    monkeypatch.setenv("PATH", str(tmp_path))
    path = scenario(tmp_path, bad_fmus.behaving(tmp_path, "good"))
    assert main(["run", path, "--fmus", "none", "--out", str(tmp_path / "out"), "--sandbox"]) == 2
    sandbox_program.cache_clear()
    said = capsys.readouterr().err
    assert f"needs bubblewrap ({PROGRAM})" in said
    assert said.count("\n") == 1


def test_no_control_character_of_a_text_reaches_a_stream(capsys: pytest.CaptureFixture[str]) -> None:
    from rich.table import Table

    table = Table("a column\x1b]0;title\x07")
    table.add_row("a cell \x9b31m")
    with printable_streams():
        print("a line \x1b[2J\u202e", "of\ttwo\nlines")
        print("an error \x1b[2J", file=sys.stderr)
        console().print(table, "a text \x1b[31m")
        assert main(["run", "no\x1b[2Jsuch"]) == 2
    out, err = capsys.readouterr()
    assert not CONTROL.search(out + err)
    assert "a line \\x1b[2J\\u202e of\ttwo\nlines" in out
    assert "a cell \\x9b31m" in out


def test_an_integer_that_no_log_can_hold_ends_the_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "sensor.c"
    old = "s->quality = s->samples > 10 ? 3 : 2;"
    text = (THEIR / "sensor.c").read_text()
    assert old in text
    source.write_text(text.replace(old, "s->quality = s->samples > 10 ? (int64_t)1 << 40 : 2;"))
    fmu = c_fmu(tmp_path / "gps.fmu", source, (THEIR / "sensor.xml").read_text(), "sensor")
    file = tmp_path / "wide.yaml"
    file.write_text(f"name: wide\nextends: guo2015-case4\nstop_time: 0.3\nsystem:\n  components: {{gps: {fmu}}}\n")
    assert main(["run", str(file), "--fmus", "none", "--out", str(tmp_path / "out"), "--no-page"]) == 1
    assert "gps gives 1099511627776 for quality at 0.11 s, beyond 32-bit integers" in capsys.readouterr().out


def test_an_fmu_of_many_signals_is_compared_in_bounds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Each of 20,000 outputs with each input took over 100 s."""
    path = described(tmp_path, '<Dimension start="3"/>', '<Dimension start="20000"/>')
    assert main(["fmu", "check", str(path), "--no-load"]) == 1
    out = capsys.readouterr().out
    assert "more; --json lists all" in out
    assert out.count("\n") < 5000
    assert len(_places_to_compare("y", {"x": 0, "y": 7}, 3)) == 4
    assert len(_places_to_compare("z", {"x": 0, "y": 7}, 3)) == 3


@pytest.mark.release
def test_every_kind_of_hostile_fmu_costs_its_own_scenario_alone(tmp_path: Path) -> None:
    """What each does at each place, in one suite: no internal error, no hang, no line that we did not write."""
    names, good = [], bad_fmus.behaving(tmp_path, "good")
    for guid, version in bad_fmus.all_behaviours():
        path = bad_fmus.behaving(tmp_path, guid, version)
        names.append(path.stem)
        scenario(tmp_path, path)
    names.append(good.stem)
    scenario(tmp_path, good)
    assert len(set(names)) == len(names) > 136
    files = [f"{name}.yaml" for name in names]
    words = ["test", *files, "--fmus", "none", "--timeout", "10", "--run-timeout", "60", "-j", "2", "--trust"]
    environment = {**os.environ, "EVIL": str(tmp_path / "evil"), "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "orchestrator", *words, "--out", "out"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, timeout=3000, check=False)
    out, err = done.stdout.decode(), done.stderr.decode()
    assert done.returncode == 2, (out + err)[-3000:]  # some cannot be loaded
    for wrong in ("Traceback", "internal error", "Warning:"):
        assert wrong not in out + err, [line for line in (out + err).splitlines() if wrong in line][:5]
    assert not CONTROL.search((out + err).replace("\r", ""))
    assert max(map(len, out.splitlines())) < 3000
    verdicts = re.findall(r"^(?:pass|FAIL|not run)  (\S+)  \((\d+) of", out, re.MULTILINE)
    assert [name for name, _ in verdicts] == names
    assert f"pass  {good.stem}  " in out
    assert not re.search(r"^pass  another", out, re.MULTILINE)
    assert alive() == []
    assert [path.name for path in tmp_path.iterdir() if "evil" in path.name] in ([], ["evil"])


@pytest.mark.release
@pytest.mark.parametrize("name", bad_fmus.ODD_FILES)
def test_every_odd_archive_is_a_line_or_an_fmu(name: str, tmp_path: Path) -> None:
    inside = tmp_path / "a" / "b"
    inside.mkdir(parents=True)
    path = inside / "odd.fmu"
    bad_fmus.ODD_FILES[name](path)
    for words in (
        ["fmu", "check", str(path), "--no-load"],
        ["run", "guo2015-case4", "--controller", str(path), "--fmus", "none", "--out", str(inside / "out")],
    ):
        answer = ask(words, 60.0)
        assert not answer.mistake, answer.mistake
        assert answer.code in (1, 2)
        said = [line for line in answer.err.splitlines() if not line.startswith(("apa: warning", "apa: note"))]
        assert answer.code == 1 or len(said) == 1, answer.err
        assert len("".join(said)) < 1000
        assert not CONTROL.search(answer.err)
        assert {path.name for path in tmp_path.iterdir()} == {"a"}
        assert not Path("/tmp/apa-evil").exists()


@pytest.mark.release
def test_every_attribute_of_a_description_with_every_odd_value(tmp_path: Path) -> None:
    """One at a time, of FMI 2.0 and 3.0; the fuzzer combines them."""
    path, wrong = tmp_path / "odd.fmu", []
    for text in DESCRIPTIONS:
        root = etree.fromstring(text)
        places = [(item, key) for item in root.iter() for key in sorted(item.attrib)]
        for item, key in places:
            before = item.get(key)
            for value in ODD:
                item.set(key, value)
                with zipfile.ZipFile(path, "w") as archive:
                    archive.writestr("modelDescription.xml", etree.tostring(root))
                answer = ask(["fmu", "check", str(path), "--no-load"])
                long = answer.code == 2 and (answer.err.count("\n") != 1 or len(answer.err) > 1000)
                if answer.mistake or long or CONTROL.search(answer.out + answer.err):
                    wrong.append((item.tag, key, value[:20], answer.mistake[-300:] or answer.err[:300]))
            item.set(key, before or "")
    assert not wrong, "\n".join(map(str, wrong[:40]))
