"""A Dask cluster of this machine that nobody else can use: temporary certificates, no web server."""

import importlib
import logging
import shutil
from contextlib import suppress
from pathlib import Path
from typing import Any

from fmus.files import new_folder
from fmus.installation import missing_package
from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.sweep.engine import safe_children

distributed: Any = importlib.import_module("distributed")
HOST = "127.0.0.1"
FILES, FILES_PER_WORKER = 32, 12
"""Open files of a study with its scheduler, 22 and 11 measured: with fewer, tornado reports in an endless loop."""


class QuietScheduler(distributed.Scheduler):  # type: ignore[misc]
    """A scheduler without a web server."""

    def start_http_server(self, *_: Any, **__: Any) -> None:
        """Open no socket."""


START_LOG = logging.getLogger("distributed.nanny")


class QuietWorker(distributed.Worker):  # type: ignore[misc]
    """A worker without a web server."""

    def start_http_server(self, *_: Any, **__: Any) -> None:
        """Open no socket."""


def max_open_files() -> int:
    """Return how many files this process may open; many where the system has no limit."""
    try:
        import resource
    except ImportError:
        return 1 << 30
    soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    return 1 << 30 if soft == resource.RLIM_INFINITY else int(soft)


class PrivateCluster:
    """Scheduler and workers, which speak TLS with certificates made for this run and kept in memory.

    Whoever has none of them - another user of the machine, say - is refused. Raises ``BadInput`` without the package
    that makes them.
    """

    def __init__(self, workers: int) -> None:
        needed, limit = FILES + FILES_PER_WORKER * workers, max_open_files()
        if limit < needed:
            text = f"{workers} Dask workers need {needed} open files, and the limit is {limit} (ulimit -n)"
            raise BadInput(text, key="--dask")
        try:
            self.security = distributed.Security.temporary()
        except ImportError as error:
            raise BadInput(missing_package("cryptography", "sweep"), key="--dask") from error
        self._folder: Path = new_folder("dask")
        common = {"host": HOST, "protocol": "tls://", "security": self.security}
        options = {**common, "nthreads": 1, "worker_class": QuietWorker, "local_directory": str(self._folder)}
        options["silence_logs"] = logging.WARNING
        START_LOG.disabled = True  # what fails is raised; Dask prints its tracebacks, besides
        try:
            with safe_children():
                self.cluster = distributed.SpecCluster(
                    scheduler={"cls": QuietScheduler, "options": {**common, "port": 0, "dashboard": False}},
                    workers={number: {"cls": distributed.Nanny, "options": options} for number in range(workers)},
                    security=self.security,
                    silence_logs=logging.WARNING,
                )
        except BaseException:
            shutil.rmtree(self._folder, ignore_errors=True)
            raise
        START_LOG.disabled = False

    def close(self) -> None:
        """End it and remove its folder."""
        with suppress(TimeoutError):
            self.cluster.close()
        shutil.rmtree(self._folder, ignore_errors=True)
