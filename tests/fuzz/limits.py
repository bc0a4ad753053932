"""A command run in this process with an eye on how it ends: its code, its lines, its time, its memory."""

import contextlib
import io
import os
import re
import resource
import signal
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from orchestrator.cli import main
from orchestrator.inputs.text.errors import INTERRUPTED
from tests.fuzz.fair_time import FairTime

LONGEST = 20.0
"""A command that takes longer hangs, the time in which other processes had its core left out [s]."""
LOOK = 0.5
"""So often is looked [s]."""
MOST_MEMORY = 1 << 30
"""What a command may take besides what the process had before [bytes]."""
CODES = (0, 1, 2, 130)
"""Codes that an input may lead to; 3 is a mistake of ours."""

SAID = ("apa", "FAIL  ", "not run  ")
"""Begins what is said of bad input, by a command or of a scenario of a suite."""
PROGRESS = re.compile(r"(\S+) of \S+ (?:runs|s)\b")
"""What a study, a run or a test says while it goes on."""


class Hangs(BaseException):
    """It takes too long."""


class GoesOn(BaseException):
    """It takes long because a million runs, or long ones, were asked for, and says how far it is."""


class Answer(NamedTuple):
    """How a command ended."""

    code: int | None
    """None: it raised."""
    out: str
    err: str
    seconds: float
    mistake: str
    """What must not be: a traceback, a hang; empty if all is well."""


def ask(words: Sequence[str], longest: float = LONGEST) -> Answer:
    """Return how ``apa`` with these words ends."""
    out, err = io.StringIO(), io.StringIO()
    begun, mistake, code = time.monotonic(), "", None
    try:
        watched = alarm(longest, lambda: goes_on(err.getvalue()))
        with watched, contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                code = main(list(words))
            except SystemExit as left:
                code = int(left.code or 0)
    except GoesOn:
        code = INTERRUPTED
    except Hangs:
        mistake = f"hangs: more than {longest:g} s of its own, {time.monotonic() - begun:.0f} s in all"
    except BaseException:
        mistake = traceback.format_exc()
    said = err.getvalue()
    if not mistake and code not in CODES:
        mistake = f"code {code}: {said.strip()}"
    if not mistake and "Traceback" in said:
        mistake = said
    if not mistake and code == 2 and not any(word in said + out.getvalue() for word in SAID):
        mistake = f"code 2 without a word: {said!r}"
    return Answer(code, out.getvalue(), said, time.monotonic() - begun, mistake)


def goes_on(said: str) -> bool:
    """Return whether something was done, and still is when the time is over: two lines, the later one with more."""
    done = [float(at[1]) for at in PROGRESS.finditer(said)]
    return len(done) > 1 and done[-1] > done[-2]


@contextlib.contextmanager
def alarm(seconds: float, goes_on: Callable[[], bool] = lambda: False) -> Iterator[None]:
    """Raise ``Hangs`` once in what takes longer, as ``FairTime`` counts, or ``GoesOn`` where ``goes_on`` is true."""
    taken = FairTime(os.getpid())

    def look(*_: object) -> None:
        if taken.seconds() > seconds:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            raise GoesOn if goes_on() else Hangs

    before = signal.signal(signal.SIGALRM, look)
    signal.setitimer(signal.ITIMER_REAL, LOOK, LOOK)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def limit_memory() -> None:
    """Let this process have no more than ``MOST_MEMORY`` besides what it has: what asks for more fails."""
    with open("/proc/self/statm") as file:
        now = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (now + MOST_MEMORY, resource.RLIM_INFINITY))
