"""Drives to identify a vehicle from, scenes of benchmarks, and learned policies: damaged and odd."""

import json
import random
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.benchmark.parkbench_scene import scene
from tests.fuzz.limits import ask
from tests.fuzz.logs import _json as odd_json
from tests.fuzz.logs import damaged
from tests.fuzz.more_texts import SCENE

NUMBER = re.compile(rb"-?\d+(\.\d+)?(e[+-]?\d+)?")
ODD_NUMBERS = (b"", b"nan", b"inf", b"-1e308", b"1e400", b"0", b"-0.5", b"1e-320", b"x", b"9" * 4000, b"1,5", b'"')
DRIVE_COLUMNS = ("pose.*", "speed", "steering_wheel_request", "steering_active", "prompt")


def odd_numbers(data: bytes, draw: random.Random) -> bytes:
    """Return a text with other numbers in some places."""
    for _ in range(draw.choice((1, 2, 8))):
        places = list(NUMBER.finditer(data))
        if not places:
            break
        place = draw.choice(places)
        data = data[: place.start()] + draw.choice(ODD_NUMBERS) + data[place.end() :]
    return data


def fuzz_scenes(folder: Path, log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """Import one odd scene after the other, and load the scenarios that it is taken for."""
    out = folder / "out"
    parkbench = json.dumps(scene())
    while True:
        shutil.rmtree(out, ignore_errors=True)
        name = draw.choice(("tpcap", "parkbench"))
        file = folder / ("odd.csv" if name == "tpcap" else "odd.json")
        plain = SCENE if name == "tpcap" else parkbench
        if name == "parkbench" and draw.random() < 0.5:
            data = odd_json(plain, draw).encode(errors="replace")
        else:
            data = draw.choice((odd_numbers, damaged))(plain.encode(), draw)
        file.write_bytes(data)
        words = ["import", name, str(file), "--out", str(out)]
        answer = ask(words)
        yield words, answer.mistake
        for scenario in out.glob("*.yaml") if answer.code == 0 else ():
            words = ["run", str(scenario), "--fmus", "none", "--no-page", "--set", "stop_time=0.1", "--out", str(out)]
            yield words, ask(words).mistake


def fuzz_drives(folder: Path, log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """Identify a vehicle from one odd drive after the other."""
    whole, file, out = folder / "drive.csv", folder / "odd.csv", folder / "out"
    signals = [word for name in DRIVE_COLUMNS for word in ("--signals", f"vehicle.{name}")]
    made = ask(["export", "csv", str(log), *signals, "--out", str(whole)])
    assert whole.is_file(), made
    lines = whole.read_text().replace("vehicle.", "").splitlines()
    short = "\n".join(lines[:2] + lines[2::5]).encode()
    words = ["identify", str(file), "--fit", "car.steering.ratio", "--no-page", "--out", str(out)]
    while True:
        shutil.rmtree(out, ignore_errors=True)
        file.write_bytes(draw.choice((odd_numbers, odd_numbers, damaged))(short, draw))
        yield words, ask(words, 60.0).mistake


def policy() -> bytes:
    """Return a network of one layer: 24 observations, 2 actions."""
    import numpy as np
    from onnx import TensorProto, helper, numpy_helper

    ports: Any = [
        helper.make_tensor_value_info(name, TensorProto.FLOAT, ["cars", count])
        for name, count in (("observation", 24), ("action", 2))
    ]
    weights = numpy_helper.from_array(np.full((24, 2), 0.1, dtype=np.float32), "weights")
    nodes = [
        helper.make_node("MatMul", ["observation", "weights"], ["product"]),
        helper.make_node("Tanh", ["product"], ["action"]),
    ]
    graph = helper.make_graph(nodes, "policy", ports[:1], ports[1:], [weights])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    data: bytes = model.SerializeToString()
    return data


def fuzz_policies(folder: Path, log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """Make controllers of odd networks."""
    file, out, whole = folder / "odd.onnx", folder / "out", policy()
    words = ["new", "controller", "odd", "--from", str(file), "--out", str(out)]
    while True:
        shutil.rmtree(out, ignore_errors=True)
        file.write_bytes(damaged(whole, draw))
        yield words, ask(words, 60.0).mistake
