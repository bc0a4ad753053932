"""The command line: exit codes, JSON, plain text where nobody looks, and nothing but one line for a mistake."""

import importlib
import json
import os
import pkgutil
import re
import signal
import subprocess
import sys
import time
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from orchestrator import commands
from orchestrator.cli import main
from orchestrator.commands import COMMANDS
from orchestrator.inputs.text.console import Meter, working
from orchestrator.presentation.log.read_log import read_log

DEMO = str(Path(__file__).with_name("demo.yaml"))
PNG = b"\x89PNG\r\n"


def test_a_parked_run_writes_log_figure_and_summary(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "räum 1"
    assert main(["run", DEMO, "--fmus", "native", "--out", str(out), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert printed["outcome"] == "parked"
    assert printed["events"][-1]["to"] == "PARKED"
    assert (out / "overview.png").read_bytes().startswith(PNG)
    assert read_log(out / "run.mcap").t[-1] == printed["duration"]


def test_not_parked_is_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["run", DEMO, "--fmus", "none", "--out", str(tmp_path), "--no-page"]
    assert main([*arguments, "--set", "stop_time=1"]) == 1
    printed = capsys.readouterr().out
    assert "not_parked: stop time reached in" in printed
    assert "\x1b" not in printed
    assert not (tmp_path / "overview.png").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "guo2015-case44"], "apa: guo2015-case44: no scenario of this name; did you mean"),
        (["run", DEMO, "--fmus", "none", "--set", "vehicle.wheelbas=3"], "apa: --set: vehicle.wheelbas: unknown"),
        (
            ["run", DEMO, "--fmus", "none", "--set", "faults=[{signal: vehicle.spee, kind: stuck_at_last}]"],
            "no signal 'spee'",
        ),
        (
            ["run", DEMO, "--fmus", "none", "--set", "controller.guo2015.k44=3"],
            "apa: --set: controller.guo2015.k44: unknown; did you mean controller.guo2015.k4",
        ),
        (["recover", "nowhere.mcap.part"], "apa: nowhere.mcap.part: no such file"),
    ],
)
def test_bad_input_is_two_and_one_line(
    arguments: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = ["--out", str(tmp_path)] if arguments[0] == "run" else []
    assert main([*arguments, *more]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert message in captured.err
    assert captured.err.count("\n") == 1


def test_every_command_is_in_the_table_and_has_its_parts() -> None:
    found = {item.name for item in pkgutil.iter_modules(commands.__path__)}
    assert found == {*COMMANDS}
    for name in COMMANDS:
        module = importlib.import_module(f"orchestrator.commands.{name}")
        assert module.EXAMPLES.startswith("examples:\n  apa "), name
        assert callable(module.add_arguments)


def test_help_and_version_import_no_command_and_no_library() -> None:
    code = (
        "import sys\nfrom orchestrator.cli import main\n"
        "try:\n    main(sys.argv[1:])\nexcept SystemExit:\n    pass\n"
        "print(sorted({name.partition('.')[0] for name in sys.modules}"
        " & {'numpy', 'scipy', 'matplotlib', 'pydantic', 'rich', 'fmpy', 'controller_fmu'}))"
    )
    for option in ("--help", "--version"):
        done = subprocess.run([sys.executable, "-c", code, option], capture_output=True, text=True, check=True)
        assert done.stdout.splitlines()[-1] == "[]", option


@pytest.mark.parametrize(
    ("arguments", "usage", "message"),
    [
        (["rum"], "usage: apa [-h]", "argument COMMAND: rum: unknown; did you mean run?"),
        (["run", DEMO, "--sett", "a=b"], "usage: apa run ", "apa run: --sett: unknown; did you mean --set"),
        (["run", DEMO, "--sett=b"], "usage: apa run ", "apa run: --sett=b: unknown; did you mean --set"),
        (["run", DEMO, "more"], "usage: apa run ", "apa run: more: unknown"),
        (["export", "csw", "x"], "usage: apa export ", "argument FORMAT: csw: unknown; did you mean csv?"),
        (["export", "csv", "x", "--signal", "y", "--name"], "usage: apa export csv", "x: no such file"),
        (["test", DEMO, "--min-branch-coverage", "200"], "usage: apa test ", "'200' is not a number from 0 to 100"),
        (["run", DEMO, "--fmus", "stone"], "usage: apa run ", "argument --fmus: stone: unknown; "),
    ],
)
def test_a_wrong_word_shows_the_usage_of_its_command(
    arguments: list[str], usage: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    if "no such file" in message:
        assert main(arguments) == 2  # the start of an option will do
        assert message in capsys.readouterr().err
        return
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    error = capsys.readouterr().err
    assert error.startswith(usage)
    assert message in error.splitlines()[-1]


def test_unknown_commands_and_kinds_are_two(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (["rum"], [], ["run", DEMO, "--fmus", "stone"]):
        with pytest.raises(SystemExit) as caught:
            main(arguments)
        assert caught.value.code == 2
    capsys.readouterr()


def test_help_shows_examples(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (["--help"], ["run", "--help"], ["recover", "--help"]):
        with pytest.raises(SystemExit) as caught:
            main(arguments)
        assert caught.value.code == 0
        assert "  apa " in capsys.readouterr().out


def test_list_names_every_scenario(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    names = {item["name"] for item in data["scenarios"]}
    assert {"guo2015-case4", "guo2015-case4-105"} <= names
    assert main(["list"]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in names)


def test_no_colours_in_a_pipe(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "orchestrator", "run", DEMO, "--fmus", "none", "--out", str(tmp_path)]
    environment = {**os.environ, "TERM": "xterm-256color"}
    environment.pop("FORCE_COLOR", None)
    done = subprocess.run(
        [*command, "--no-page", "--set", "stop_time=1"], capture_output=True, text=True, env=environment, check=False
    )
    assert done.returncode == 1, done.stderr
    assert "\x1b" not in done.stdout + done.stderr
    assert "final heading" in done.stdout


def test_an_instance_that_fails_aborts_and_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from orchestrator.inputs.text.errors import RunError
    from orchestrator.simulation.cosim.model_instance import ModelInstance

    def step(self: ModelInstance, t_ns: int, dt_ns: int) -> None:
        if t_ns >= 500_000_000:
            raise RunError(f"{self.name} failed at 0.5 s [mark]")

    monkeypatch.setattr(ModelInstance, "step", step)
    assert main(["run", DEMO, "--fmus", "none", "--out", str(tmp_path), "--no-page"]) == 1
    assert "aborted: error: vehicle failed at 0.5 s [mark]" in capsys.readouterr().out
    found = read_log(tmp_path / "run.mcap")
    assert found.t[-1] == 0.5
    assert json.loads((tmp_path / "summary.json").read_text())["outcome"] == "aborted"


def test_an_instance_that_does_not_start_aborts_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from orchestrator.inputs.text.errors import RunError
    from orchestrator.simulation.cosim.model_instance import ModelInstance

    def initialize(self: ModelInstance, stop_ns: int) -> None:
        raise RunError(f"{self.name} refuses to initialize")

    monkeypatch.setattr(ModelInstance, "initialize", initialize)
    assert main(["run", DEMO, "--fmus", "none", "--out", str(tmp_path)]) == 1
    assert "aborted: error: vehicle refuses to initialize" in capsys.readouterr().out
    assert len(read_log(tmp_path / "run.mcap").t_ns) == 0


@pytest.mark.parametrize(
    "arguments", [["run", DEMO, "--fmus", "native"], ["test", "guo2015-case4", "--fmus", "native"]]
)
@pytest.mark.parametrize("place", ["/proc/x", "FILE/x"])
def test_a_place_that_cannot_be_written_is_one_line(
    arguments: list[str], place: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    place = place.replace("FILE", str(tmp_path / "file"))
    assert main([*arguments, "--out", place]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.startswith(f"apa: {place.removesuffix('/x')}")


def test_an_interrupt_while_a_command_is_imported_is_one_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(name: str) -> None:
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr("orchestrator.inputs.text.command_parser.importlib.import_module", interrupted)
    assert main(["run", DEMO]) == 130
    assert capsys.readouterr().err == "apa: interrupted\n"


def test_quiet_prints_nothing_but_errors_and_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["run", DEMO, "--fmus", "none", "--no-page", "--quiet", "--out"]
    assert main([*arguments, str(tmp_path)]) == 0
    captured = capsys.readouterr()
    assert captured.out + captured.err == ""
    assert main([*arguments, str(tmp_path), "--force", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["outcome"] == "parked"
    assert main([*arguments, "/proc/x"]) == 2
    assert capsys.readouterr().err.startswith("apa: /proc/x")


def test_something_long_says_so_where_there_is_no_terminal(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("orchestrator.inputs.text.console.PERIOD", 0.01)
    with Meter("my study", 300, "runs") as meter:
        time.sleep(0.02)
        meter.at(200, "9/s")
    with working("building"):
        time.sleep(0.1)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "my study: 200 of 300 runs, 9/s"
    assert lines[1].startswith("building: 0 s")


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["run", DEMO, "--no-page"], r"demo: (\S+) of 0.002 s"),
        (["test", DEMO], r"apa test: 0 of 1 scenarios, demo at (\S+) of 0.002 s"),
        (["test", "{open_loop}"], r"apa test: 0 of 1 scenarios, standing at (\S+) of 0.002 s"),
    ],
)
def test_a_long_run_says_how_far_it_is_however_small_its_steps(
    words: list[str],
    expected: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("orchestrator.inputs.text.console.PERIOD", 0.0)
    monkeypatch.setattr("orchestrator.inputs.text.console.LONGEST", 0.0)
    monkeypatch.setattr("orchestrator.session.run_clock.SHOW_PERIOD", 0.0)
    file = tmp_path / "standing.yaml"
    expectations = "[{id: a, signal: speed, always: {max: 1}}]"
    file.write_text(f"model: vehicle\nstep: 0.01 ms\nstop_time: 2 ms\nexpect: {expectations}\n")
    words = [word.format(open_loop=file) for word in words]
    more = ["--set", "step=0.01 ms", "--set", "stop_time=2 ms"] if DEMO in words else []
    main([*words, *more, "--fmus", "none", "--out", str(tmp_path / "out")])
    times = [float(text) for text in re.findall(expected, capsys.readouterr().err)]
    assert len(times) > 100
    assert times == sorted(times)


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (["parameters", "steering.rate"], ["vehicle.car.steering.rate_limit", "controller.car.steering.rate_limit"]),
        (["parameters", "controller.guo2015.k?"], [f"controller.guo2015.k{number}" for number in (1, 2, 3, 4)]),
        (["signals", "vehicle.pose.*"], ["vehicle.pose.x", "vehicle.pose.y", "vehicle.pose.heading"]),
        (["controllers", "fuzzy"], ["preview"]),
        (["scenarios", "case4-l"], ["guo2015-case4-left"]),
        (["cars", "commonroad"], ["commonroad1", "commonroad2", "commonroad3"]),
        (["studies", "guo2015"], ["guo2015-claim", "guo2015-speed-rate", "guo2015-steering", "guo2015-trial"]),
    ],
)
def test_list_of_what_can_be_named(arguments: list[str], names: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", *arguments, "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["name"] for row in rows][: len(names)] == names
    assert main(["list", *arguments]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in names)
    assert all(row["text"] in printed for row in rows if "text" in row)


def test_list_gives_defaults_ranges_limits_and_says_if_nothing_fits(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "parameters", "vehicle.car.steering.rate_limit", "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)
    assert (row["unit"], row["low"], row["high"]) == ("rad/s", 0.01, 100.0)
    assert row["default"] == "9.94838 (570 deg/s)"
    assert main(["list", "requirements", "gbt41630"]) == 0
    assert "\u00b1 0.150 m" in capsys.readouterr().out
    assert main(["list", "parameters", "nothing-of-this-name"]) == 2
    capsys.readouterr()


def test_what_was_changed_stands_in_every_headline(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sets = ["--set", "controller.guo2015.k4=3", "--set", "title=A <b>title</b>"]
    arguments = ["guo2015-case4", "--fmus", "native", *sets, "--out"]
    assert main(["run", *arguments, str(tmp_path / "run")]) == 0
    assert "overrides: controller.guo2015.k4 = 3\n" in capsys.readouterr().out
    summary = json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))
    assert summary["overrides"] == {"controller.guo2015.k4": "3", "title": "A <b>title</b>"}
    page = (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    assert "<title>A &lt;b&gt;title&lt;/b&gt; - with controller.guo2015.k4 = 3</title>" in page
    assert main(["test", *arguments, str(tmp_path / "test")]) == 0
    assert "title&lt;/b&gt; - with controller.guo2015.k4 = 3" in (tmp_path / "test" / "index.html").read_text("utf-8")
    assert main(["report", str(tmp_path / "run" / "run.mcap"), "--out", str(tmp_path / "again.html")]) == 0
    assert "- with controller.guo2015.k4 = 3</title>" in (tmp_path / "again.html").read_text(encoding="utf-8")


def test_a_scenario_file_cannot_say_what_was_changed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text("{extends: guo2015-case4, overrides: {a: b}}")
    assert main(["run", str(file), "--out", str(tmp_path / "out")]) == 2
    assert "overrides: unknown" in capsys.readouterr().err


def test_the_folder_of_a_run_will_do_for_its_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "run"
    assert main(["run", DEMO, "--fmus", "native", "--out", str(folder), "--no-page"]) == 0
    assert not (folder / "report.html").exists()
    assert main(["report", str(folder)]) == 0
    assert (folder / "report.html").is_file()
    assert main(["check", str(folder), "project"]) == 0
    assert main(["compare", str(folder), str(folder)]) == 0
    assert main(["export", "csv", str(folder)]) == 0
    assert (folder / "run.csv").is_file()
    capsys.readouterr()
    assert main(["report", str(folder / "report.html")]) == 2
    assert capsys.readouterr().err == f"apa: {folder / 'report.html'}: is no MCAP log\n"
    (folder / "run.mcap").write_bytes((folder / "run.mcap").read_bytes()[:3000])
    assert main(["report", str(folder)]) == 2
    assert f"try: apa recover {folder / 'run.mcap'}" in capsys.readouterr().err
    assert main(["report", str(tmp_path)]) == 2


def test_a_container_says_that_it_needs_a_compiler(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr("importlib.metadata.version", lambda name: (_ for _ in ()).throw(PackageNotFoundError(name)))
    assert main(["export", "container", "guo2015-case4", "--out", str(tmp_path / "c.fmu")]) == 2
    assert "there is no C compiler; run: " in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_build_prints_what_it_made(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", "--fmus", "python", "--out", str(tmp_path / "built"), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert {Path(row["path"]).name for row in rows} == {"Controller.fmu", "Vehicle.fmu"}
    assert all(Path(row["path"]).stat().st_size == row["size"] for row in rows)
    assert main(["build", "--platform", "win64"]) == 2
    assert main(["build", "--fmus", "native", "--out", str(tmp_path), "--platform", "amiga"]) == 2
    assert "amiga: expected all or" in capsys.readouterr().err
