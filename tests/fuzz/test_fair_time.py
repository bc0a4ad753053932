"""What counts as a hang: not what neighbours take, all else."""

import os
import signal
import subprocess
import sys
import time

import pytest

from tests.fuzz.fair_time import FairTime, Threads, threads_of
from tests.fuzz.limits import GoesOn, Hangs, alarm, goes_on

SPINS = "import os, sys\nos.sched_setaffinity(0, {int(sys.argv[1])})\nprint(flush=True)\nwhile True: pass"
SLEEPS = "import time\nprint(flush=True)\ntime.sleep(60)"
LONG = 1.0
TOLD: Threads = {}
threads_of(os.getpid(), TOLD)


def taken(*words: str) -> tuple[float, float]:
    """Return own time and wall-clock time of a process [s]."""
    with subprocess.Popen([sys.executable, "-c", *words], stdout=subprocess.PIPE) as child:
        try:
            assert child.stdout
            child.stdout.readline()
            watch, begun = FairTime(child.pid), time.monotonic()
            while time.monotonic() - begun < LONG:
                time.sleep(0.1)
                watch.seconds()
            return watch.seconds(), time.monotonic() - begun
        finally:
            child.kill()


needs_waiting_time = pytest.mark.skipif(not TOLD, reason="the system does not say how long a thread waited for a core")


@needs_waiting_time
def test_a_core_shared_with_others_is_half_the_time() -> None:
    core = str(min(os.sched_getaffinity(0)))
    with subprocess.Popen([sys.executable, "-c", SPINS, core], stdout=subprocess.DEVNULL) as neighbour:
        try:
            own, wall = taken(SPINS, core)
        finally:
            neighbour.kill()
    assert own < 0.75 * wall


def test_a_wait_is_left_out_when_it_is_reported_at_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """Linux adds it to ``schedstat`` as the thread runs again."""
    clock = iter(0.1 * tick for tick in range(1000))
    monkeypatch.setattr("tests.fuzz.fair_time.time.monotonic", lambda: next(clock))
    reported: Threads = {"1": (0.0, 0.0)}
    monkeypatch.setattr(FairTime, "_threads", lambda _: dict(reported))
    watch = FairTime(1)
    for _ in range(50):
        watch.seconds()
    reported["1"] = (0.05, 4.0)
    assert watch.seconds() == pytest.approx(1.1)
    reported["1"], reported["2"] = (0.1, 4.0), (0.0, 2.0)
    assert watch.seconds() == pytest.approx(1.1), "two waits at a time are one"
    for _ in range(20):
        assert watch.seconds() > 1.1


def test_who_sleeps_takes_all_of_it() -> None:
    own, wall = taken(SLEEPS)
    assert own > 0.7 * wall


@pytest.mark.parametrize("hang", ["while True: pass", "import time\nwhile True: time.sleep(0.01)"])
def test_what_computes_or_waits_for_ever_hangs(hang: str) -> None:
    with pytest.raises(Hangs), alarm(0.2):
        exec(hang)


def test_what_says_that_it_goes_on_does_not_hang() -> None:
    with pytest.raises(GoesOn), alarm(0.2, lambda: goes_on("x: 20 of 900 runs\nx: 60 of 900 runs, 8/s\n")):
        time.sleep(60.0)
    for said in ("", "x: 20 of 900 runs\n", "x: 20 of 900 runs\nx: 20 of 900 runs\n"):
        with pytest.raises(Hangs), alarm(0.2, lambda said=said: goes_on(said)):  # type: ignore[misc]
            time.sleep(60.0)


@needs_waiting_time
def test_orphans_are_watched_on() -> None:
    family = f"import subprocess, sys, time\nsubprocess.Popen([sys.executable, '-c', {SLEEPS!r}])\ntime.sleep(60)"
    with subprocess.Popen([sys.executable, "-c", family], stdout=subprocess.PIPE) as child:
        assert child.stdout
        child.stdout.readline()
        watch = FairTime(child.pid)
        child.kill()
        child.wait()
        orphans = watch._family - {child.pid}
        try:
            assert watch._threads()
        finally:
            for pid in orphans:
                os.kill(pid, signal.SIGKILL)
