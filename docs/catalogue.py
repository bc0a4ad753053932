"""Writes the tables of docs/catalogue.md: what the assist and the valet meet. ``python docs/catalogue.py``."""

import re
from pathlib import Path
from tempfile import TemporaryDirectory

from orchestrator.catalogue.run import judged
from orchestrator.catalogue.show import markdown, said
from orchestrator.cosim.fmu_files import fmu_files
from orchestrator.cosim.master import Interrupt
from orchestrator.session.foreign import Foreign
from orchestrator.suite.suite import Bench

PAGE = Path(__file__).parent / "catalogue.md"
BETWEEN = re.compile(r"(?<=<!-- catalogue -->\n).*?(?=\n<!-- /catalogue -->)", re.S)


def text(words: list[str]) -> str:
    """Return the tables of the standards that ``words`` mean, after running what tests them."""
    bench = Bench(fmu_files("native", print), "native", Foreign(), [], Interrupt())
    with TemporaryDirectory() as folder:
        verdicts = judged(words, bench, Path(folder))
    return f"\nIn all: {said(verdicts)}.\n\n{markdown(verdicts)}\n"


if __name__ == "__main__":
    made = text(["catalogue"])
    PAGE.write_text(BETWEEN.sub(lambda match: made, PAGE.read_text(encoding="utf-8")), encoding="utf-8")
