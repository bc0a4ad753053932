"""The log: any MCAP reader and any protobuf reader find in it what the run was."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foxglove_schemas_protobuf.Log_pb2 import Log
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.reader import make_reader
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory

from modelkit.signal import Signal
from modelkit.variables import Variable
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.mcap_file import CHUNK_SIZE, McapFile
from orchestrator.presentation.log.mcap_log import McapLog
from orchestrator.presentation.log.protobuf_rows import Encoder
from orchestrator.presentation.log.read_log import read_log
from orchestrator.presentation.log.signal_channels import add_channel
from orchestrator.session.session import Messages, run_instances, run_scenario
from orchestrator.simulation.cosim.algorithm import Termination
from orchestrator.simulation.cosim.model_instance import ModelInstance
from orchestrator.simulation.cosim.recording import Recording
from tests.orchestrator.toy_models import BRAIN, PLANT, Mode

DEMO = str(Path(__file__).with_name("demo.yaml"))


@pytest.fixture(scope="module")
def toy_run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Recording]:
    path = tmp_path_factory.mktemp("log") / "run.mcap"
    scenario = load_scenario(DEMO, ["stop_time=3"])
    instances = [ModelInstance("plant", PLANT, {"gain": 3.0}), ModelInstance("brain", BRAIN, {})]
    return path, run_instances(scenario, list(instances), Messages(), log=path).recording


@pytest.fixture(scope="module")
def demo_run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Recording]:
    path = tmp_path_factory.mktemp("log") / "run.mcap"
    return path, run_scenario(load_scenario(DEMO), log=path).recording


def decoded(path: Path, topic: str) -> list[tuple[int, Any]]:
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        return [(raw.log_time, message) for _, _, raw, message in reader.iter_decoded_messages([topic])]


def test_a_protobuf_reader_sees_every_value(toy_run: tuple[Path, Recording]) -> None:
    path, found = toy_run
    messages = decoded(path, "/plant")
    assert [t for t, _ in messages] == found.t_ns.tolist()
    signals = found.signals
    for row, (_, message) in enumerate(messages):
        assert message.pose.x == signals["plant.pose.x"][row]
        assert message.left == signals["plant.left"][row]
        assert message.moving == bool(signals["plant.moving"][row])
        assert list(message.rays) == [signals[f"plant.rays[{n}]"][row] for n in (1, 2, 3)]
        assert [cell.charge for cell in message.cells] == [signals[f"plant.cells[{n}].charge"][row] for n in (1, 2)]
        assert [cell.mode for cell in message.cells] == [signals[f"plant.cells[{n}].mode"][row] for n in (1, 2)]
        assert message.command == signals["plant.command"][row]
    assert {cell.mode for cell in messages[-1][1].cells} == {int(Mode.BUSY), int(Mode.DONE)}
    assert decoded(path, "/plant/parameters")[0][1].gain == 3.0


def test_read_log_gives_the_recording_bit_for_bit(toy_run: tuple[Path, Recording]) -> None:
    path, found = toy_run
    read = read_log(path)
    assert read.t_ns.tolist() == found.t_ns.tolist()
    assert read.signals.keys() == found.signals.keys()
    for name, values in found.signals.items():
        assert read.signals[name].tobytes() == np.ascontiguousarray(values).tobytes(), name
        assert read.variables[name].signal.unit == found.variables[name].signal.unit
        assert read.states(name) == found.states(name)
    assert read.parameters == found.parameters
    assert read.info["end"] == found.info["end"]
    assert read.info["seed"] == found.info["seed"]
    assert read.info["fmus"] == found.info["fmus"]


def test_large_structures_are_written_on_change_and_read_at_each_exchange(demo_run: tuple[Path, Recording]) -> None:
    path, found = demo_run
    read = read_log(path)
    assert read.signals.keys() == found.signals.keys()
    for name, values in found.signals.items():
        assert read.signals[name].tobytes() == np.ascontiguousarray(values).tobytes(), name
    points = decoded(path, "/controller/guo2015")
    assert len(points) < found.count / 20
    assert {t_ns: message.q1.x for t_ns, message in points}.items() <= dict(
        zip(found.t_ns.tolist(), found.signals["controller.guo2015.q1.x"].tolist(), strict=True)
    ).items()
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    begins = [index.message_start_time for index in summary.chunk_indexes if index.message_end_time]
    assert set(begins[1:-1]) <= {t_ns for t_ns, _ in points}


def variables_of(*names: str) -> list[Variable]:
    return [Variable(name, float, Signal("1", "a signal"), 0.0) for name in names]


@pytest.mark.parametrize(
    ("order", "expected"),
    [
        ([("state", 0), ("", 0), ("", 1), ("state", 2), ("", 2)], [5.0, 5.0, 7.0]),
        ([("", 0), ("", 1), ("state", 1)], r"lacks values of plant\.state\.a"),
        ([("state", 1), ("", 0), ("", 1)], r"lacks values of plant\.state\.a"),
        ([("state", 0), ("", 0), ("", 1), ("state", 1)], "its times do not rise"),
        ([("state", 0), ("", 0), ("other", 0), ("", 1)], r"has two channels /plant"),
    ],
)
def test_messages_on_change_hold_until_the_next(tmp_path: Path, order: Any, expected: Any) -> None:
    path = tmp_path / "run.mcap"
    file = McapFile(path)
    channels = {"state": add_channel(file, "/plant/state", "PlantState", variables_of("a"), ["local"])}
    channels[""] = add_channel(file, "/plant", "Plant", variables_of("x"), ["output"])
    if "other" in dict(order):
        channels["other"] = add_channel(file, "/plant", "Plant", variables_of("x"), ["output"])
    for place, t_ns in order:
        file.write(channels[place], t_ns, Encoder(variables_of("x")).encode(np.array([5.0 + t_ns])))
    file.close()
    if isinstance(expected, str):
        with pytest.raises(BadInput, match=expected):
            read_log(path)
    else:
        assert read_log(path).signals["plant.state.a"].tolist() == expected


def test_units_and_states_stand_in_the_schema(toy_run: tuple[Path, Recording]) -> None:
    with toy_run[0].open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    channel = next(item for item in summary.channels.values() if item.topic == "/plant")
    file = FileDescriptorSet.FromString(summary.schemas[channel.schema_id].data).file[0]
    comments = [location.leading_comments for location in file.source_code_info.location]
    assert any("[m/s] requested speed; input" in comment for comment in comments)
    enum = next(message for message in file.message_type if message.name == "Mode").enum_type[0]
    assert {value.name: value.number for value in enum.value} == {"IDLE": 0, "BUSY": 1, "DONE": 200}
    described = {row["name"]: row for row in json.loads(channel.metadata["variables"])}
    assert described["pose.heading"]["unit"] == "rad"
    assert described["command"]["causality"] == "input"


def test_every_record_and_checksum_is_right(demo_run: tuple[Path, Recording]) -> None:
    with demo_run[0].open("rb") as stream:
        records = list(StreamReader(stream, emit_chunks=True, validate_crcs=True).records)
    chunks = [record for record in records if isinstance(record, Chunk)]
    assert len(chunks) > 3
    assert max(chunk.uncompressed_size for chunk in chunks[1:]) < 1.1 * CHUNK_SIZE
    with demo_run[0].open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert sum(1 for _ in reader.iter_messages()) == summary.statistics.message_count
        rows = [message for _, _, message in reader.iter_messages(["/vehicle"])]
        assert [message.log_time for message in rows] == [k * 10_000_000 for k in range(len(rows))]
        assert [message.sequence for message in rows] == list(range(len(rows)))


def test_viewers_find_frames_scene_path_trail_and_words(demo_run: tuple[Path, Recording]) -> None:
    path, found = demo_run
    frames = decoded(path, "/tf")
    assert len(frames) == pytest.approx(found.t[-1] * 20, abs=2)
    t_ns, last = frames[-1]
    row = found.t_ns.tolist().index(t_ns)
    car = next(item for item in last.transforms if item.child_frame_id == "car")
    assert car.translation.x == found.signals["vehicle.pose.x"][row]
    assert 2 * np.arctan2(car.rotation.z, car.rotation.w) == pytest.approx(found.signals["vehicle.pose.heading"][row])
    entities = {entity.id: entity for entity in decoded(path, "/scene")[0][1].entities}
    assert {"car", "slot", "target", "odometry", "front_left_wheel", "front_right_wheel"} <= entities.keys()
    known_frames = {"world", *(item.child_frame_id for item in last.transforms)}
    assert {entity.frame_id for entity in entities.values()} <= known_frames
    assert any(len(update.entities[0].lines[0].points) > 20 for _, update in decoded(path, "/path") if update.entities)
    assert decoded(path, "/trail")[-1][1].poses[0].position.x == found.signals["vehicle.pose.x"][0]
    words = [(line.name, line.message) for _, line in decoded(path, "/log")]
    assert ("controller.phase", "PRE_STEER -> PATH_TRACKING") in words
    assert words[-1][0] == "run"


def test_the_same_run_gives_the_same_bytes(tmp_path: Path) -> None:
    scenario = load_scenario(DEMO, ["stop_time=2"])
    for name in ("a", "b"):
        run_scenario(scenario, log=tmp_path / name)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_an_odd_value_comes_back(tmp_path: Path) -> None:
    scenario = load_scenario(DEMO, ["stop_time=0.1"])
    instances = [ModelInstance("plant", PLANT, {}), ModelInstance("brain", BRAIN, {})]
    odd = {"command": float("nan"), "mode": -3.0, "right": -(2.0**31), "active": 1.0}
    for name, value in odd.items():
        instances[0].inputs.values[instances[0].inputs.index[name]] = value
    log = McapLog(tmp_path / "x.mcap", list(instances), scenario, {})
    log.on_communication_point(0)
    log.on_terminate(Termination("done", 0))
    read = read_log(tmp_path / "x.mcap").signals
    assert np.isnan(read["plant.command"][0])
    assert [read[f"plant.{name}"][0] for name in ("mode", "right", "active")] == [-3.0, -(2.0**31), 1.0]


def test_a_part_file_gets_its_name_only_when_complete(tmp_path: Path) -> None:
    file = McapFile(tmp_path / "x.mcap")
    assert not (tmp_path / "x.mcap").exists()
    assert (tmp_path / "x.mcap.part").exists()
    file.close()
    file.close()
    assert (tmp_path / "x.mcap").exists()
    assert not (tmp_path / "x.mcap.part").exists()


def _write_chunks(path: Path) -> bytes:
    file = McapFile(path)
    channel = file.add_channel("/log", Log)
    for number in range(5):
        file.write(channel, number, bytes([number]) * 1000)
        file.flush()
    file.close()
    return path.read_bytes()


def test_a_log_has_the_same_bytes_where_no_thread_can_start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usual = _write_chunks(tmp_path / "usual.mcap")

    def refuse(*_: object) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr("threading.Thread.start", refuse)
    assert _write_chunks(tmp_path / "alone.mcap") == usual


def test_an_error_of_the_thread_that_writes_ends_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fill_disk(self: McapFile, *_: object) -> None:
        self._file.close()
        raise OSError(28, "No space left on device", str(self.part))

    monkeypatch.setattr(McapFile, "_compress_and_write", fill_disk)
    with pytest.raises(OSError, match="No space left"):
        _write_chunks(tmp_path / "x.mcap")
    assert not (tmp_path / "x.mcap").exists()


def test_no_log_is_explained(tmp_path: Path) -> None:
    path = tmp_path / "x.mcap"
    path.write_text("not a log at all, but long enough to be looked at")
    with pytest.raises(BadInput, match=r"x\.mcap: is no MCAP log"):
        read_log(path)
    with pytest.raises(BadInput, match="no such file"):
        read_log(tmp_path / "none.mcap")


@pytest.mark.parametrize("rows", [0, 1, 2, 3])
def test_any_number_of_rows_about_a_chunk(tmp_path: Path, rows: int) -> None:
    instances = [ModelInstance("plant", PLANT, {}), ModelInstance("brain", BRAIN, {})]
    for instance in instances:
        instance.initialize(0)
        instance.fetch_outputs()
    log = McapLog(tmp_path / "x.mcap", list(instances), Scenario(name="none"), {})
    count = 0 if rows == 0 else log.rows_per_chunk + rows - 2
    for row in range(count):
        log.on_communication_point(row)
    log.on_terminate(Termination("done", count))
    assert read_log(tmp_path / "x.mcap").t_ns.tolist() == list(range(count))
