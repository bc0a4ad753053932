"""The process that draws one picture: numbers on its standard input, the PNG file on its standard output."""

import gc
import pickle
import sys

gc.disable()  # it ends within a second
from orchestrator.presentation.drawing.figure import picture  # noqa: E402


def main() -> None:
    """Draw what comes, if anything comes."""
    data = sys.stdin.buffer.read()
    if data:
        sys.stdout.buffer.write(picture(pickle.loads(data)))
    gc.freeze()  # nor is anything looked for at its end
