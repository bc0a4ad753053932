"""The process that draws one picture: numbers on its standard input, the PNG file on its standard output."""

import gc
import pickle
import sys

gc.disable()  # it ends within a second
from matplotlib.artist import ArtistInspector  # noqa: E402

# matplotlib collects the properties of its classes for their documentation: a quarter of the time of its import.
ArtistInspector.get_setters = lambda self: []  # type: ignore[method-assign]
ArtistInspector.get_aliases = lambda self: {}  # type: ignore[method-assign]
from orchestrator.presentation.drawing.figure import picture  # noqa: E402


def main() -> None:
    """Draw what comes, if anything comes."""
    data = sys.stdin.buffer.read()
    if data:
        sys.stdout.buffer.write(picture(pickle.loads(data)))
    gc.freeze()  # nor is anything looked for at its end
