"""Ctrl-C and SIGTERM end a run after the exchange in hand; a second one ends the program at once."""

from contextlib import AbstractContextManager

from orchestrator.inputs.text.ends import stop_on_signal
from orchestrator.simulation.cosim.algorithm import Interrupt


def on_interrupt(interrupt: Interrupt) -> AbstractContextManager[None]:
    """Set ``interrupt.requested`` on the first signal."""

    def request() -> None:
        interrupt.requested = True

    return stop_on_signal(request)
