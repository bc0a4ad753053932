"""Runs in real time: delay, viewers, changes meanwhile, ends."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.reader import make_reader

from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.session import run_scenario
from orchestrator.session.stream.gate import is_welcome
from orchestrator.session.stream.pace import RealTimeClock
from orchestrator.session.stream.realtime import Realtime
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_files import fmu_files

pytest.importorskip("foxglove")
TOKEN = "apa.token"
viewer = pytest.importorskip("tests.stream.viewer", reason="the package websockets is not installed")
K4 = "controller.guo2015.k4"


class Clock:
    """A clock that goes on only during a sleep, or on request."""

    def __init__(self) -> None:
        self.now = 5.0
        self.slept: list[float] = []

    def __call__(self) -> Any:
        return self.now

    def sleep(self, seconds: Any) -> None:
        self.slept.append(seconds)
        self.now += seconds


def test_who_is_early_waits_and_who_is_late_is_counted() -> None:
    clock = Clock()
    pace = RealTimeClock(clock, clock.sleep)
    for step, work in enumerate((0.004, 0.002, 0.025, 0.0, 0.0)):
        pace.on_communication_point(step * 10_000_000)
        clock.now += work
    assert clock.slept == pytest.approx([0.006, 0.008])
    reported = pace.lateness_statistics()
    assert (reported["exchanges"], reported["late"]) == (5, 2)
    assert reported["largest"] == pytest.approx(0.015)
    assert reported["at_end"] == pytest.approx(0.005)


def test_a_run_takes_as_long_as_its_time_and_says_how_late_it_was() -> None:
    scenario = load_scenario("guo2015-case4", ["stop_time=0.5"])
    ran = run_scenario(scenario, realtime=Realtime())
    assert 0.5 <= ran.wall_time < 3.0
    late = summarize(ran.recording, scenario, ran.wall_time).realtime
    assert late is not None
    assert late.exchanges == 51
    assert 0.0 <= late.median <= late.percentile_99 <= late.largest
    plain = run_scenario(scenario).recording
    for name, values in plain.signals.items():
        np.testing.assert_array_equal(ran.recording.signals[name], values, err_msg=name)


@contextlib.contextmanager
def shown(scenario: Any, files: Any = None, **options: Any) -> Iterator[Any]:
    """A run in a thread, and the address it is shown at."""
    addresses: list[str] = []
    found: list[Any] = []
    interrupt = Interrupt()
    realtime = Realtime(0, addresses.append)
    given = {"realtime": realtime, "interrupt": interrupt, **options}
    thread = threading.Thread(target=lambda: found.append(run_scenario(scenario, files, **given)))
    thread.start()
    try:
        end = time.monotonic() + 60
        while not addresses and thread.is_alive() and time.monotonic() < end:
            time.sleep(0.01)
        yield realtime.address, found, realtime
    finally:
        interrupt.requested = True
        thread.join(30)
    assert not thread.is_alive()


@pytest.mark.parametrize("kind", [pytest.param("none", marks=pytest.mark.release), "native"])
def test_a_viewer_sees_what_the_log_has_and_changes_a_parameter(kind: str, tmp_path: Path) -> None:
    scenario, log = load_scenario("guo2015-case4", ["stop_time=60"]), tmp_path / "run.mcap"
    files = fmu_files("native") if kind == "native" else None
    with shown(scenario, files, kind=kind, log=log) as (address, found, realtime):
        look = viewer.Viewer(address)
        look.until(lambda: len(look.channels) > 9)
        look.subscribe()
        look.until(lambda: len(look.messages["/vehicle"]) > 30 and look.messages["/controller/parameters"])
        look.send(op="getParameters", parameterNames=[], id="all")
        look.until(lambda: look.answers("parameterValues"))
        known = {item["name"]: item["value"] for item in look.answers("parameterValues")[0]["parameters"]}
        assert known[K4] == 4.0
        assert "controller.system" not in known
        for name, value in ((K4, 2.0), (TOKEN, "guessed"), (TOKEN, realtime.token)):
            look.send(op="setParameters", parameters=[{"name": name, "value": value}], id=f"{name} {value}")
        look.until(lambda: len(look.answers("status")) == 2)
        assert "set apa.token first" in look.answers("status")[0]["message"]
        for value in (3.25, 1e9):
            look.send(op="setParameters", parameters=[{"name": K4, "value": value}], id=str(value))
        look.until(lambda: len(look.answers("status")) == 3)
        assert f"{K4}: 1000000000.0 is not within" in look.answers("status")[2]["message"]
        look.until(lambda: any(b"k4 = 3.25" in data for _, data in look.messages["/log"]))
        seen = {topic: dict(rows) for topic, rows in look.messages.items()}
        look.close()
    (ran,) = found
    assert ran.end.reason == "interrupted"
    assert [(item["name"], item["value"]) for item in ran.recording.info["realtime"]["tuned"]] == [(K4, 3.25)]
    assert ran.recording.info["realtime"]["tuned"][0]["by"].startswith("viewer ")
    with log.open("rb") as stream:
        reader = make_reader(stream)
        summary = reader.get_summary()
        assert summary is not None
        schemas = {schema.name: schema.data for schema in summary.schemas.values()}
        logged = {(channel.topic, message.log_time): message.data for _, channel, message in reader.iter_messages()}
    for channel in look.channels.values():
        assert channel["encoding"] == "protobuf"
        assert schemas[channel["schemaName"]]
        assert FileDescriptorSet.FromString(schemas[channel["schemaName"]]).file
    for topic in ("/vehicle", "/controller", "/tf", "/scene", "/vehicle/parameters"):
        assert seen[topic], topic
        for t_ns, data in seen[topic].items():
            assert logged[topic, t_ns] == data, (topic, t_ns)


def test_a_changed_parameter_acts_as_the_same_parameter_from_the_start() -> None:
    """Set before the first step, a gain gives the run that has it from the start."""
    scenario = load_scenario("guo2015-case4", ["stop_time=6"])
    early = []

    class Asks:
        def on_communication_point(self, t_ns: Any) -> None:
            pass

        def closed(self, end: Any) -> None:
            pass

    realtime: Any = Realtime(0)
    join = realtime.join

    def joined(*given: Any) -> None:
        join(*given)
        early.append(realtime._tuning.ask(K4, 3.0, "test"))

    realtime.join = joined
    realtime._pace._sleep = lambda seconds: None
    tuned = run_scenario(scenario, realtime=realtime).recording
    assert early == [""]
    other = run_scenario(load_scenario("guo2015-case4", ["stop_time=6", f"{K4}=3"])).recording
    np.testing.assert_array_equal(tuned.signals["vehicle.pose.y"], other.signals["vehicle.pose.y"])
    plain = run_scenario(scenario).recording
    assert (plain.signals["vehicle.pose.y"] != other.signals["vehicle.pose.y"]).any()


def test_a_port_that_is_taken_is_said() -> None:
    scenario = load_scenario("guo2015-case4", ["stop_time=30"])
    with shown(scenario) as (address, _, _):
        port = int(address.rpartition(":")[2])
        with pytest.raises(BadInput, match=f"port {port} cannot be opened"):
            run_scenario(scenario, realtime=Realtime(port))


REQUEST = "GET / HTTP/1.1\r\nHost: {host}\r\n{more}Upgrade: websocket\r\n\r\n"


@pytest.mark.parametrize(
    ("host", "more", "welcome"),
    [
        ("127.0.0.1:8765", "", True),
        ("localhost:8765", "Origin: https://app.foxglove.dev\r\n", True),
        ("[::1]:8765", "Origin: http://localhost:8080\r\n", True),
        ("127.0.0.1:8765", "Origin: file://\r\n", True),
        ("127.0.0.1:8765", "Origin: https://evil.example\r\n", False),
        ("127.0.0.1:8765", "Origin: https://app.foxglove.dev.evil.example\r\n", False),
        ("127.0.0.1:8765", "Origin: http://localhost.evil.example\r\n", False),
        ("127.0.0.1:8765", "Origin: null\r\n", False),
        ("127.0.0.1:8765", "origin: http://localhost\r\nOrigin: https://evil.example\r\n", False),
        ("evil.example:8765", "", False),
        ("127.0.0.1.evil.example", "", False),
        ("[", "", False),
    ],
)
def test_a_page_of_somebody_else_is_not_let_in(host: str, more: str, welcome: bool) -> None:
    assert is_welcome(REQUEST.format(host=host, more=more).encode()) is welcome


def test_the_door_of_a_live_run_looks_at_the_origin() -> None:
    from websockets.exceptions import InvalidStatus

    with shown(load_scenario("guo2015-case4", ["stop_time=30"])) as (address, _, _):
        with pytest.raises(InvalidStatus, match="403"):
            viewer.connect(address, origin="https://evil.example", open_timeout=120)
        with viewer.connect(address, subprotocols=viewer.PROTOCOLS, origin="http://localhost:8080") as socket:
            assert json.loads(socket.recv(timeout=120))["op"] == "serverInfo"


def test_ctrl_c_ends_in_order(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "orchestrator", "run", "guo2015-case4", "--fmus", "none", "--live", "0"]
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    with subprocess.Popen(
        [*command, "--out", str(tmp_path)], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
    ) as process:
        line = ""
        assert process.stderr is not None
        while "ws://" not in line:
            line = process.stderr.readline()
            assert line, "ended before it was shown"
        look = viewer.Viewer(line[line.index("ws://") :].split(":  ")[0].split(": ")[0])
        look.until(lambda: len(look.channels) > 9)
        look.subscribe()
        look.until(lambda: look.messages["/vehicle"])
        process.send_signal(signal.SIGINT)
        look.close()
        out, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in errors
    assert "real time: median" in out
    assert json.loads((tmp_path / "summary.json").read_text())["realtime"]["exchanges"] > 1
    assert (tmp_path / "run.mcap").exists()
