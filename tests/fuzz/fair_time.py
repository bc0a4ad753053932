"""How long a process took of its own: on a busy machine the time in which it waits for a core is not its fault."""

import contextlib
import time
from pathlib import Path

PROC = Path("/proc")
Threads = dict[str, tuple[float, float]]
"""Thread -> what it has computed and waited for a core [s]."""


class FairTime:
    """Watches a process and its children from now on, also when it is gone; ask some times a second.

    What the thread that was kept waiting longest lost until a question is left out, also if that began before the
    question before: the system reports a wait when it is over. So an idle
    machine, and a system that does not tell, give wall-clock time. Whoever computes has at least its processor time.
    """

    def __init__(self, pid: int) -> None:
        self._family = {pid}
        self._asked = time.monotonic()
        self._began = self._threads()
        self._before = self._began
        self._computed = 0.0
        self._stretches: list[tuple[float, float]] = []
        """From when, and how long of it was its own [s], oldest first: a wait is reported only when it is over."""

    def seconds(self) -> float:
        """Return the time that is its own [s]."""
        asked, threads = time.monotonic(), self._threads()
        starved = 0.0
        for name, (run, waited) in threads.items():
            starved = max(starved, waited - self._before.get(name, (0.0, 0.0))[1])
            self._computed = max(self._computed, run - self._began.get(name, (0.0, 0.0))[0])
        self._stretches.append((self._asked, asked - self._asked))
        self._leave_out(asked - starved)
        self._asked, self._before = asked, threads
        return max(sum(own for _, own in self._stretches), self._computed)

    def _leave_out(self, since: float) -> None:
        """Count nothing as its own from then on."""
        for place in range(len(self._stretches) - 1, -1, -1):
            begin, own = self._stretches[place]
            if begin + own <= since:
                return
            self._stretches[place] = begin, max(0.0, since - begin)

    def _threads(self) -> Threads:
        """Return the threads of all who belong to it, and remember who does: orphans are no longer found."""
        found: Threads = {}
        for pid in list(self._family):
            self._family |= threads_of(pid, found)
        return found


def threads_of(pid: int, found: Threads) -> set[int]:
    """Add the threads of a process and of its children to ``found``; return who they are."""
    family = {pid}
    for task in _listed(PROC / str(pid) / "task"):
        with contextlib.suppress(OSError, ValueError):
            run, waited, _ = (task / "schedstat").read_text().split()
            found[task.name] = (1e-9 * int(run), 1e-9 * int(waited))
            for child in (task / "children").read_text().split():
                family |= threads_of(int(child), found)
    return family


def _listed(folder: Path) -> list[Path]:
    with contextlib.suppress(OSError):
        return list(folder.iterdir())
    return []
