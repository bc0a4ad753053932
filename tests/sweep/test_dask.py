"""A study on a Dask cluster of separate processes on this machine, one of them killed on the way."""

import gc
import os
import signal
import socket
import subprocess
import sys
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from orchestrator.cli import main

STUDY = """
name: trial
scenario: guo2015-case4
runs:
  grid: {controller.system: [ntbpt, ntbptcwpt]}
  latin_hypercube:
    n: 1500
    "vehicle.driver.profile[1].speed": {uniform: [2 km/h, 2.0]}
"""
CHUNK = 25


def started(*arguments: Any) -> Any:
    return subprocess.Popen([sys.executable, "-m", *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.fixture
def cluster() -> Iterator[Any]:
    """Address of a scheduler with two workers of one thread, and the processes."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    scheduler = started(
        "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard", "--no-show"
    )
    common = ("--no-dashboard", "--no-nanny", "--nthreads", "1", "--host", "127.0.0.1")
    workers = [started("distributed.cli.dask_worker", address, *common) for _ in range(2)]
    yield address, workers
    for process in (*workers, scheduler):
        process.kill()
        process.wait()


@pytest.mark.release
def test_nothing_is_lost_when_a_worker_is_killed(cluster: Any, tmp_path: Path) -> None:
    address, workers = cluster
    study = tmp_path / "trial.yaml"
    study.write_text(STUDY)
    common = ["sweep", str(study), "--chunk", str(CHUNK), "--no-page", "--out"]
    assert main([*common, str(tmp_path / "here")]) == 0
    there = subprocess.Popen(
        [sys.executable, "-m", "orchestrator", *common, str(tmp_path / "there"), "--dask", address],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    parts = tmp_path / "there" / "parts"
    while len(list(parts.glob("*.parquet"))) < 10:
        assert there.poll() is None, there.communicate()
        time.sleep(0.01)
    workers[0].send_signal(signal.SIGKILL)
    assert len(list(parts.glob("*.parquet"))) < 100
    out, error = there.communicate()
    assert there.returncode == 0, error
    assert "on Dask at tcp://127.0.0.1" in out
    assert workers[1].poll() is None
    tables = [(tmp_path / place / "trial.parquet").read_bytes() for place in ("here", "there")]
    assert tables[0] == tables[1]


def test_a_scheduler_that_does_not_answer(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from orchestrator.studies.sweep import dask_engine

    monkeypatch.setattr(dask_engine, "CONNECT_TIMEOUT", 0.3)
    code = main(["sweep", "guo2015-trial", "--out", str(tmp_path), "--no-page", "--dask", "tcp://127.0.0.1:9"])
    assert code == 2
    assert "no scheduler answers" in capsys.readouterr().err


@pytest.mark.release
def test_a_cluster_of_this_machine_refuses_who_has_none_of_its_certificates() -> None:
    distributed = pytest.importorskip("distributed")
    pytest.importorskip("cryptography")
    import psutil  # type: ignore[import-untyped]

    from orchestrator.studies.sweep.dask_cluster import PrivateCluster

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the connection that is refused
        own = PrivateCluster(1)
        try:
            with distributed.Client(own.cluster, set_as_default=False) as client:
                assert client.submit(len, [1, 2, 3]).result() == 3
            here = psutil.Process()
            processes = [here, *here.children(recursive=True)]
            sockets = [item for one in processes for item in one.net_connections() if item.status == "LISTEN"]
            assert len({item.laddr for item in sockets}) == 3  # scheduler, nanny, worker; no web server
            address = own.cluster.scheduler_address
            for security in (None, distributed.Security.temporary()):
                with pytest.raises((TypeError, OSError)):
                    distributed.Client(address, timeout=5, security=security, set_as_default=False)
                gc.collect()  # here, not in the thread that the next client starts: its close waits for that client
        finally:
            own.close()
    assert not own._folder.exists()


@pytest.mark.release
@pytest.mark.skipif(os.name != "posix", reason="ulimit")
@pytest.mark.parametrize(("files", "code"), [(16, 2), (32, 2), (80, 0)])
def test_too_few_descriptors_are_said_in_a_line(files: int, code: int, tmp_path: Path) -> None:
    """Dask and tornado wrote 72 lines with 32 of them, and 600,000 with 16."""
    words = [sys.executable, "-m", "orchestrator", "sweep", "guo2015-trial", "--stride", "200", "--no-page", "--dask"]
    command = ["sh", "-c", f'ulimit -n {files}; exec "$@"', "sh", *words, "-j", "2", "--out", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == code, done.stderr
    said = [line for line in done.stderr.splitlines() if "runs" not in line]
    assert len(said) == (code == 2), said
    assert code == 0 or "2 Dask workers need 56 open files" in said[0]
