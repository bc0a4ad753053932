"""How the reproductions are driven: by FMUs of each kind."""

import pytest

from orchestrator.cosim.fmu_files import can_compile, fmu_files
from orchestrator.papers.drive import drive
from orchestrator.papers.result import Drive, Driven


@pytest.fixture(scope="session")
def native() -> Drive:
    """Drives a scenario with native FMUs, as ``apa reproduce`` does by default."""
    if not can_compile():
        pytest.skip("needs a C compiler")
    files = fmu_files("native")

    def driven(name: str) -> Driven:
        return drive(name, files, "native")

    return driven
