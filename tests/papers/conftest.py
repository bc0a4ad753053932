"""How the reproductions are driven: by FMUs of each kind."""

import pytest

from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from orchestrator.studies.papers.drive import drive
from orchestrator.studies.papers.result import Drive, Driven


@pytest.fixture(scope="session")
def by_default() -> Drive:
    """Drives as ``apa reproduce`` does: natively, in process where nothing can compile. tests/twin compares both."""
    if not can_compile():
        return drive
    files = fmu_files("native")

    def driven(name: str) -> Driven:
        return drive(name, files, "native")

    return driven
