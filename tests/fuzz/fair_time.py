"""How long a process took of its own: on a busy machine the time in which it waits for a core is not its fault."""

import contextlib
import time
from pathlib import Path

PROC = Path("/proc")


class FairTime:
    """Watches a process and its children from now on; ask at least each second, children that end are forgotten.

    Of a stretch between two questions what the thread that was kept waiting longest lost is left out; so an idle
    machine, and a system that does not tell, give wall-clock time. Whoever computes has at least its processor time.
    """

    def __init__(self, pid: int) -> None:
        self._pid = pid
        self._asked = time.monotonic()
        self._began = threads_of(pid)
        self._before = self._began
        self._computed = 0.0
        self._own = 0.0

    def seconds(self) -> float:
        """Return the time that is its own [s]."""
        asked, threads = time.monotonic(), threads_of(self._pid)
        starved = 0.0
        for name, (run, waited) in threads.items():
            starved = max(starved, waited - self._before.get(name, (0.0, 0.0))[1])
            self._computed = max(self._computed, run - self._began.get(name, (0.0, 0.0))[0])
        self._own += max(0.0, asked - self._asked - starved)
        self._asked, self._before = asked, threads
        return max(self._own, self._computed)


def threads_of(pid: int) -> dict[str, tuple[float, float]]:
    """Return what each thread of a process and of its children has computed and waited for a core [s]."""
    found = {}
    for task in _listed(PROC / str(pid) / "task"):
        with contextlib.suppress(OSError, ValueError):
            run, waited, _ = (task / "schedstat").read_text().split()
            found[task.name] = (1e-9 * int(run), 1e-9 * int(waited))
            for child in (task / "children").read_text().split():
                found |= threads_of(int(child))
    return found


def _listed(folder: Path) -> list[Path]:
    with contextlib.suppress(OSError):
        return list(folder.iterdir())
    return []
