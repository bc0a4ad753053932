"""Writes docs/tables/catalogue.md: which clauses the parking systems meet. ``python docs/catalogue.py``."""

from pathlib import Path
from tempfile import TemporaryDirectory

from marked import put

from orchestrator.session.foreign import ImportedFmus
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.testing.catalogue.run import judge_standards
from orchestrator.testing.catalogue.show import count_text, markdown
from orchestrator.testing.suite.suite import SuiteConfig


def tables(words: list[str]) -> list[str]:
    """Return the tables of the standards that ``words`` mean, after running what tests them."""
    bench = SuiteConfig(fmu_files("native", print), "native", ImportedFmus(), [], Interrupt())
    with TemporaryDirectory() as folder:
        verdicts = judge_standards(words, bench, Path(folder))
    return [f"In all: {count_text(verdicts)}.", "", markdown(verdicts)]


if __name__ == "__main__":
    put(Path(__file__).parent / "tables" / "catalogue.md", "catalogue", tables(["catalogue"]))
